#include "drivers/sick/sick_scan.hpp"

#include <numbers>

namespace crspf {
namespace {

constexpr SickName kDistances = {'D', 'I', 'S', 'T', '1'};
constexpr std::uint16_t kFirstRange = 16;  // smaller raw values are codes
constexpr double kRadPer1e4deg = std::numbers::pi / 180.0 * 1e-4;
constexpr double kForward_rad = std::numbers::pi / 2.0;
constexpr std::uint16_t kHalfCounter = 0x8000;

}  // namespace

SickSequence::Key SickSequence::key_of(const LmdScandata& data) {
    const SickChannel* distance = data.find(kDistances);
    return {data.serial,
            data.telegram_counter,
            data.scan_counter,
            data.start_us,
            data.scan_frequency_centihertz,
            data.version,
            data.device,
            data.channels16,
            data.channels8,
            distance != nullptr ? *distance : SickChannel{}};
}

bool SickSequence::follows(const Key& before, const Key& now) {
    if (before.serial != now.serial || before.version != now.version || before.device != now.device ||
        before.channels16 != now.channels16 || before.channels8 != now.channels8 || before.distance != now.distance ||
        before.scan_frequency_centihertz != now.scan_frequency_centihertz) {
        return false;
    }
    const auto telegrams = static_cast<std::uint16_t>(now.telegram_counter - before.telegram_counter);
    const auto scans = static_cast<std::uint16_t>(now.scan_counter - before.scan_counter);
    if (telegrams == 0 || telegrams >= kHalfCounter || scans < telegrams || scans >= kHalfCounter ||
        now.scan_frequency_centihertz == 0) {
        return false;
    }
    // The frequency is the nominal one, so a tenth is granted, and half a scan for the first step.
    const auto elapsed_us = static_cast<double>(now.start_us - before.start_us);
    const double period_us = 1e8 / static_cast<double>(now.scan_frequency_centihertz);
    const double late_us = elapsed_us - period_us * scans;
    const double grant_us = period_us * (0.4 + 0.1 * scans);
    return late_us < grant_us && late_us > -grant_us;
}

std::optional<SickTiming> SickSequence::accept(const LmdScandata& data, Stamp received) {
    const Key now = key_of(data);
    const bool goes_on = last_ && follows(*last_, now);
    const bool begins = !goes_on && withheld_ && follows(*withheld_, now);
    if (!goes_on && !begins) {
        ++counters_.withheld;
        withheld_ = now;
        return std::nullopt;
    }
    const Key& before = goes_on ? *last_ : *withheld_;
    SickTiming timing;
    timing.received = received;
    if (goes_on) {
        last_start_us_ += now.start_us - before.start_us;  // modulo 2^32: right across the wrap
        timing.lost_before = static_cast<std::uint16_t>(now.telegram_counter - before.telegram_counter - 1);
    } else {
        ++epoch_;
        last_start_us_ = now.start_us;
    }
    const auto scans = static_cast<std::uint16_t>(now.scan_counter - before.scan_counter);
    const auto telegrams = static_cast<std::uint16_t>(now.telegram_counter - before.telegram_counter);
    period_s_ = 100.0 / static_cast<double>(now.scan_frequency_centihertz) * scans / telegrams;
    timing.start_us = last_start_us_;
    timing.transmit_us = last_start_us_ + (data.transmit_us - data.start_us);
    timing.clock_epoch = epoch_;
    counters_.lost += timing.lost_before;
    ++counters_.delivered;
    last_ = now;
    withheld_.reset();
    return timing;
}

void SickSequence::reset() {
    last_.reset();
    withheld_.reset();
    period_s_ = 0.0;
}

Stamp SickClock::beam0(const SickTiming& timing) {
    if (timing.clock_epoch != epoch_) {
        epoch_ = timing.clock_epoch;
        clock_.reset();
    }
    const auto on_line = [](std::uint64_t us) { return Stamp{static_cast<std::int64_t>(us * 1000U)}; };
    clock_.add(on_line(timing.transmit_us), timing.received);
    return clock_.to_host(on_line(timing.start_us));
}

SickScanResult fill_scan(const LmdScandata& data, const LidarParams& lidar, Stamp beam0, Scan& scan) {
    const SickChannel* distance = data.find(kDistances);
    if (distance == nullptr || distance->count == 0 || distance->step_1e4deg == 0) {
        return SickScanResult::kNoDistances;
    }
    const std::span<const std::uint16_t> raw = data.of(*distance);
    if (raw.size() > scan.range_m.size()) {
        return SickScanResult::kTooMany;
    }
    const double side = lidar.mount_inverted ? -1.0 : 1.0;
    const double first_rad = side * (static_cast<double>(distance->start_1e4deg) * kRadPer1e4deg - kForward_rad);
    const double step_rad = side * static_cast<double>(distance->step_1e4deg) * kRadPer1e4deg;
    const bool turned = step_rad < 0.0;
    const auto steps = static_cast<double>(raw.size() - 1);
    const double step_turns = (turned ? -step_rad : step_rad) / (2.0 * std::numbers::pi);
    const double frequency_hz = static_cast<double>(data.scan_frequency_centihertz) * 0.01;
    const double beam_s = frequency_hz > 0.0 ? step_turns / frequency_hz : lidar.time_per_beam_s;

    scan.count = static_cast<std::uint32_t>(raw.size());
    scan.angle_min_rad = turned ? first_rad + steps * step_rad : first_rad;
    scan.angle_increment_rad = turned ? -step_rad : step_rad;
    scan.time_per_beam_s = turned ? -beam_s : beam_s;
    scan.stamp = beam0 + Duration::from_seconds(lidar.stamp_offset_s + (turned ? steps * beam_s : 0.0));

    const double scale_m = static_cast<double>(distance->scale) * 0.001;
    const auto offset_m = static_cast<double>(distance->offset);
    for (std::size_t i = 0; i < raw.size(); ++i) {
        const std::size_t to = turned ? raw.size() - 1 - i : i;
        const auto range_m = static_cast<float>(raw[i] * scale_m + offset_m);
        scan.range_m[to] = range_m;
        if (raw[i] >= kFirstRange) {
            scan.beam[to] = classify(range_m, lidar);
        } else {
            scan.beam[to] = raw[i] == 0 ? Beam::kNoReturn : Beam::kInvalid;
        }
    }
    return SickScanResult::kFilled;
}

}  // namespace crspf
