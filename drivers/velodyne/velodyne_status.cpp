#include "drivers/velodyne/velodyne_status.hpp"

#include <algorithm>
#include <cstddef>

#include "core/base/trig.hpp"
#include "drivers/common/byte_reader.hpp"
#include "drivers/common/byte_writer.hpp"

namespace crspf {
namespace {

constexpr std::array<std::uint8_t, kVelodyneStatusCycle> kTypes = {'H', 'M', 'S', 'D', 'N', 'Y', 'G', 'T',
                                                                   'V', '1', '2', '3', '4', '5', '6', '7'};
constexpr std::uint32_t kFirstByteStep = 9;
// Units of the stream.
constexpr double kAngle_deg = 0.01;
constexpr double kLength_m = 0.001;
constexpr double kSlope = 0.1;

std::int16_t in_units(double value, double unit) {
    const double n = value / unit;
    return static_cast<std::int16_t>(n < 0.0 ? n - 0.5 : n + 0.5);
}

}  // namespace

std::optional<VelodyneCalibration> VelodyneStatusListener::on_packet(VelodyneStatus status) {
    if (status.type != kTypes[step_]) {
        const bool was_running = cycles_ != std::array<std::uint32_t, kPlaces>{};
        restarts_ += was_running ? 1 : 0;
        cycles_.fill(0);
        step_ = status.type == kTypes[0] ? 1 : 0;
        return std::nullopt;
    }
    if (step_ >= kFirstByteStep) {
        cycle_[step_ - kFirstByteStep] = status.value;
    }
    step_ = (step_ + 1) % kVelodyneStatusCycle;
    if (step_ != 0) {
        return std::nullopt;
    }
    return on_cycle();
}

std::optional<VelodyneCalibration> VelodyneStatusListener::on_cycle() {
    const std::uint32_t now = place_;
    place_ = (place_ + 1) % kPlaces;
    for (std::uint32_t p = 0; p < kPlaces; ++p) {
        const std::uint32_t part = (now + kPlaces - p) % kPlaces;
        std::uint32_t& held = cycles_[p];
        if (part == 0) {
            // A laser begins here, if this is its number.
            if (held % kPlaces != 0 || cycle_[0] != held / kPlaces) {
                held = 0;
            }
            if (cycle_[0] != held / kPlaces) {
                continue;
            }
        } else if (held % kPlaces != part) {
            continue;
        }
        if (part * kCycleBytes < kLaserBytes) {
            std::copy(cycle_.begin(), cycle_.end(), bytes_[p].begin() + std::ptrdiff_t{kCycleBytes} * part);
        }
        ++held;
        if (held % kPlaces == 0) {
            lasers_[p][held / kPlaces - 1] = laser_of(bytes_[p]);
        }
        if (held == kVelodyneLasers * kPlaces) {
            held = 0;
            return lasers_[p];
        }
    }
    return std::nullopt;
}

VelodyneLaser VelodyneStatusListener::laser_of(const LaserBytes& bytes) {
    ByteReader in(bytes);
    in.skip(1);  // its number
    VelodyneLaser laser;
    laser.vertical_rad = radians(in.little<std::int16_t>() * kAngle_deg);
    laser.rotation_rad = radians(in.little<std::int16_t>() * kAngle_deg);
    laser.distance_m = in.little<std::int16_t>() * kLength_m;
    laser.distance_x_m = in.little<std::int16_t>() * kLength_m;
    laser.distance_y_m = in.little<std::int16_t>() * kLength_m;
    laser.vertical_offset_m = in.little<std::int16_t>() * kLength_m;
    laser.horizontal_offset_m = in.little<std::int16_t>() * kLength_m;
    laser.focal_distance_m = in.little<std::int16_t>() * kLength_m;
    laser.focal_slope = in.little<std::int16_t>() * kSlope;
    laser.min_intensity = in.byte();
    laser.max_intensity = in.byte();
    return laser;
}

VelodyneStatus status_of(const VelodyneCalibration& calibration, std::uint32_t index) {
    const std::uint32_t step = index % kVelodyneStatusCycle;
    const std::uint32_t cycle = index % kVelodyneStatusPackets / kVelodyneStatusCycle;
    const std::uint32_t laser = cycle / 4;
    const std::uint32_t at = cycle % 4 * 7 + step - kFirstByteStep;
    std::array<std::uint8_t, 28> bytes{};
    if (step >= kFirstByteStep && laser < kVelodyneLasers) {
        const VelodyneLaser& l = calibration[laser];
        ByteWriter out(bytes);
        out.byte(static_cast<std::uint8_t>(laser));
        out.little(in_units(degrees(l.vertical_rad), kAngle_deg));
        out.little(in_units(degrees(l.rotation_rad), kAngle_deg));
        out.little(in_units(l.distance_m, kLength_m));
        out.little(in_units(l.distance_x_m, kLength_m));
        out.little(in_units(l.distance_y_m, kLength_m));
        out.little(in_units(l.vertical_offset_m, kLength_m));
        out.little(in_units(l.horizontal_offset_m, kLength_m));
        out.little(in_units(l.focal_distance_m, kLength_m));
        out.little(in_units(l.focal_slope, kSlope));
        out.byte(l.min_intensity);
        out.byte(l.max_intensity);
        return {kTypes[step], bytes[at]};
    }
    return {kTypes[step], 0};
}

}  // namespace crspf
