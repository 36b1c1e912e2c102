#include "drivers/sick/lms2xx_listener.hpp"

#include "drivers/sick/lms2xx_scan.hpp"

namespace crspf {

bool Lms2xxListener::on_message(const Lms2xxMessage& message) {
    const bool from_sensor =
        message.kind == Lms2xxMessage::Kind::kTelegram && (message.address & kLms2xxFromSensor) != 0;
    if (!from_sensor || message.payload[0] != kLms2xxScanReply) {
        return false;
    }
    Lms2xxVariant variant;
    if (!decode_lms2xx_scan(message.payload, scan_) || !variant_of_count(scan_.count, variant)) {
        ++undecodable_;
        return false;
    }
    return true;
}

Stamp Lms2xxListener::beam0(Stamp received) const {
    constexpr double kBitsPerByte = 10.0;
    Lms2xxVariant variant;
    static_cast<void>(variant_of_count(scan_.count, variant));
    const double bytes = 2.0 * scan_.count + 4.0 + scan_.indices + static_cast<double>(kLms2xxFrame);
    const double line_s = bytes * kBitsPerByte / static_cast<double>(params_.baud);
    return received - Duration::from_seconds(line_s + lms2xx_sweep_s(variant));
}

}  // namespace crspf
