#include "drivers/sick/lms2xx_device.hpp"

#include "drivers/common/byte_reader.hpp"

namespace crspf {
namespace {

constexpr std::uint8_t kStatus = 0x10;
constexpr std::size_t kStatusBytes = 152;
constexpr std::int64_t kTurn_ns = 13'333'333;

}  // namespace

void Lms2xxDevice::clear_output() {
    out_size_ = 0;
    baud_ = next_baud_;
}

void Lms2xxDevice::byte(std::uint8_t value) {
    if (out_size_ < out_.size()) {
        out_[out_size_++] = value;
    }
}

void Lms2xxDevice::reply(std::span<const std::uint8_t> payload) {
    out_size_ += encode_lms2xx(kLms2xxFromSensor, payload, std::span(out_).subspan(out_size_));
}

void Lms2xxDevice::on_bytes(std::span<const std::uint8_t> bytes, Stamp now) {
    parser_.feed(bytes, now, [this](const Lms2xxMessage& message, Stamp stamp) {
        if (message.kind == Lms2xxMessage::Kind::kTelegram && (message.address & kLms2xxFromSensor) == 0) {
            on_command(message.payload, stamp);
        }
    });
}

void Lms2xxDevice::on_command(std::span<const std::uint8_t> payload, Stamp now) {
    ByteReader in(payload);
    const std::uint8_t command = in.byte();
    if (command == 0x31) {
        byte(kLms2xxAck);
        std::array<std::uint8_t, kStatusBytes> status{0xB1};
        status.back() = kStatus;
        return reply(status);
    }
    if (command == 0x3B) {
        const Lms2xxVariant wanted{in.little<std::uint16_t>(), in.little<std::uint16_t>()};
        const bool known = in.ok() &&
                           (wanted.resolution_cdeg == 100 || wanted.resolution_cdeg == 50 ||
                            (wanted.resolution_cdeg == 25 && wanted.angle_deg == 100)) &&
                           (wanted.angle_deg == 100 || wanted.angle_deg == 180);
        variant_ = known ? wanted : variant_;
        byte(kLms2xxAck);
        return reply(std::array<std::uint8_t, 7>{0xBB, static_cast<std::uint8_t>(known ? 1 : 0),
                                                 static_cast<std::uint8_t>(variant_.angle_deg), 0,
                                                 static_cast<std::uint8_t>(variant_.resolution_cdeg), 0, kStatus});
    }
    if (command != 0x20) {
        return byte(kLms2xxNack);
    }
    switch (static_cast<Lms2xxMode>(in.byte())) {
        case Lms2xxMode::kStreamAll:
            streams_ = true;
            next_scan_ = now;
            break;
        case Lms2xxMode::kOnRequest: streams_ = false; break;
        case Lms2xxMode::kBaud9600: next_baud_ = 9600; break;
        case Lms2xxMode::kBaud19200: next_baud_ = 19200; break;
        case Lms2xxMode::kBaud38400: next_baud_ = 38400; break;
        case Lms2xxMode::kBaud500000: next_baud_ = 500000; break;
        case Lms2xxMode::kInstallation: break;
        default: return byte(kLms2xxNack);
    }
    byte(kLms2xxAck);
    reply(std::array<std::uint8_t, 3>{0xA0, 0, kStatus});
}

void Lms2xxDevice::on_time(Stamp now) {
    if (!streams_ || now < next_scan_) {
        return;
    }
    scan_.count = static_cast<std::uint16_t>(variant_.angle_deg * 100U / variant_.resolution_cdeg + 1U);
    scan_.index[0] = static_cast<std::uint8_t>(scan_.index[0] + 1);
    scan_.status = kStatus;
    std::array<std::uint8_t, kLargestLms2xxPayload> payload{};
    const std::size_t size = encode_lms2xx_scan(scan_, payload);
    reply(std::span(payload).first(size));
    // The line may be slower than the mirror; then scans are left out.
    const std::int64_t line_ns = static_cast<std::int64_t>(size + kLms2xxFrame) * 10'000'000'000 / baud_;
    const std::int64_t period_ns = kTurn_ns * 100 / variant_.resolution_cdeg;
    next_scan_ = now + Duration{line_ns > period_ns ? line_ns : period_ns};
}

}  // namespace crspf
