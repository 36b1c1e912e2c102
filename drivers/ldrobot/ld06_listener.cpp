#include "drivers/ldrobot/ld06_listener.hpp"

#include <algorithm>
#include <cmath>  // floor

#include "core/base/trig.hpp"

namespace crspf {
namespace {

// Angles between two readings of a packet are exact in this unit.
constexpr int kPerDegree = 100 * (kLd06Readings - 1);
constexpr int kHalfTurn = 180 * kPerDegree;
constexpr int kPassage = 10 * kPerDegree;  // less back is a sensor that trembles
constexpr int kWhole = 330 * kPerDegree;
constexpr Duration kLongSilence{10'000'000'000};  // the sensor's clock may have gone round meanwhile
// A packet is whole when its last byte has come; its last reading was measured just before it was sent.
constexpr double kBitsPerByte = 10.0;
constexpr double kLine_s = kLd06Bytes * kBitsPerByte / kLd06Baud;

}  // namespace

void Ld06Listener::on_open() {
    parser_.clear();
    heard_ = false;
    begun_ = false;
}

Stamp Ld06Listener::when_sent(const Ld06Packet& packet, Stamp received) {
    heard_ = heard_ && received - received_ < kLongSilence;
    unsigned passed_ms = 0;
    if (heard_) {
        passed_ms = (unsigned{packet.time_ms} + kLd06TimeWrap_ms - time_ms_) % kLd06TimeWrap_ms;
    } else {
        clock_.reset();
    }
    // What half a turn was lost of would be put together out of two.
    if (begun_ && (!heard_ || passed_ms * packet.speed_degps > 180'000)) {
        begun_ = false;
        ++counters_.bad_scans;
    }
    device_ = device_ + Duration{std::int64_t{passed_ms} * 1'000'000};
    time_ms_ = static_cast<std::uint16_t>(packet.time_ms % kLd06TimeWrap_ms);
    received_ = received;
    clock_.add(device_, received - Duration::from_seconds(kLine_s));
    return clock_.to_host(device_);
}

bool Ld06Listener::on_packet(const Ld06Packet& packet, Stamp received) {
    const Stamp sent = when_sent(packet, received);
    const auto step = static_cast<int>(ld06_span_cdeg(packet));
    const double reading_s = static_cast<double>(step) / kPerDegree / packet.speed_degps;
    bool finished = false;
    for (std::size_t i = 0; i < kLd06Readings; ++i) {
        int angle = packet.first_cdeg * static_cast<int>(kLd06Readings - 1) + static_cast<int>(i) * step;
        angle -= angle >= kHalfTurn ? 2 * kHalfTurn : 0;
        if (heard_ && angle < angle_ - kPassage) {
            finished = (begun_ && finish()) || finished;
            begun_ = true;
            count_ = 0;
            steps_ = 0.0;
            speeds_degps_ = 0.0;
        } else if (heard_ && angle <= angle_) {
            ++counters_.ran_back;
            continue;
        }
        heard_ = true;
        angle_ = angle;
        if (begun_ && count_ < readings_.size()) {  // finish() refuses a turn that does not fit
            readings_[count_++] = {.angle = angle, .range_mm = packet.readings[i].range_mm};
            newest_ = sent - Duration::from_seconds(static_cast<double>(kLd06Readings - 1 - i) * reading_s);
            steps_ += step;
            speeds_degps_ += packet.speed_degps;
        }
    }
    return finished;
}

bool Ld06Listener::finish() {
    const double step = steps_ / static_cast<double>(count_);
    const int first = readings_[0].angle;
    const auto beam_of = [&](const Reading& reading) {
        return static_cast<std::size_t>(std::floor((reading.angle - first) / step + 0.5));
    };
    const std::size_t last = beam_of(readings_[count_ - 1]);
    if (readings_[count_ - 1].angle - first < kWhole || last >= capacity::kBeams) {
        ++counters_.bad_scans;
        return false;
    }
    scan_.count = static_cast<std::uint32_t>(last + 1);
    std::fill_n(scan_.beam.begin(), scan_.count, Beam::kInvalid);
    // It was measured clockwise: its last reading becomes beam 0.
    scan_.angle_min_rad = -radians((first + static_cast<double>(last) * step) / kPerDegree);
    scan_.angle_increment_rad = radians(step / kPerDegree);
    scan_.time_per_beam_s = -steps_ / kPerDegree / speeds_degps_;
    scan_.stamp = newest_;
    std::uint32_t filled = 0;
    for (std::size_t i = 0; i < count_; ++i) {
        const std::size_t beam = last - beam_of(readings_[i]);
        filled += scan_.beam[beam] == Beam::kInvalid ? 1U : 0U;
        scan_.range_m[beam] = static_cast<float>(readings_[i].range_mm * 0.001);
        scan_.beam[beam] = readings_[i].range_mm == 0 ? Beam::kNoReturn : Beam::kHit;
    }
    counters_.lost_readings += scan_.count - filled;
    ++counters_.scans;
    return true;
}

}  // namespace crspf
