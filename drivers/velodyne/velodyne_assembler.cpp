#include "drivers/velodyne/velodyne_assembler.hpp"

#include <algorithm>
#include <cmath>  // floor

#include "core/base/real.hpp"
#include "core/base/trig.hpp"

namespace crspf {
namespace {

constexpr double kTurn_cdeg = kVelodyneTurn_cdeg;
constexpr double kPerCdeg_rad = kPi / 18000.0;
// Packets overtake each other by a few places only; an older stamp is a clock that was set.
constexpr double kLatest_packets = 10.0;
// Stamps are whole microseconds; the packet's period of an HDL-64E is known from its data rate alone.
constexpr double kStampTolerance_packets = 0.25;
// Packets do not begin at the same angle to the last bit, and a head that starts up turns faster each time.
constexpr double kAngleTolerance_packets = 0.3;
constexpr double kSpeedTolerance = 0.03;

constexpr double in_turn(double cdeg) {
    return cdeg < 0.0 ? cdeg + kTurn_cdeg : cdeg >= kTurn_cdeg ? cdeg - kTurn_cdeg : cdeg;
}

/// From `from` to `to`, both in [0, a turn), by the shorter way. In [-half a turn, half a turn).
constexpr double step_between(double from_cdeg, double to_cdeg) {
    const double on_cdeg = in_turn(to_cdeg - from_cdeg);
    return on_cdeg < kTurn_cdeg / 2.0 ? on_cdeg : on_cdeg - kTurn_cdeg;
}

constexpr Duration from_us(double us) {
    return Duration::from_seconds(us * 1e-6);
}

/// From stamp to stamp of a counter that starts anew each hour, by the shorter way.
constexpr double elapsed_us(std::uint32_t from_us, std::uint32_t to_us) {
    constexpr std::int64_t kHour = kVelodyneHour_us;
    const std::int64_t on = (static_cast<std::int64_t>(to_us) - static_cast<std::int64_t>(from_us) + kHour) % kHour;
    return static_cast<double>(on < kHour / 2 ? on : on - kHour);
}

}  // namespace

VelodyneAssembler::VelodyneAssembler(const VelodyneParams& params,
                                     const std::optional<VelodyneCalibration>& calibration)
    : params_(params),
      cut_cdeg_(in_turn(wrap_angle(params.cut_rad) / kPerCdeg_rad)),
      calibration_(calibration ? calibration : nominal_calibration(params.model)) {
    if (calibration_) {
        know(*calibration_);
    }
    cloud_.cut_rad = params_.cut_rad;
    cloud_.model = params_.model;
    cloud_.lasers = traits_of(params_.model).lasers;
}

void VelodyneAssembler::count(VelodyneFault fault) {
    switch (fault) {
        case VelodyneFault::kNone: break;
        case VelodyneFault::kLength: ++counters_.bad_length; break;
        case VelodyneFault::kFlag: ++counters_.bad_flag; break;
        case VelodyneFault::kAzimuth: ++counters_.bad_azimuth; break;
        case VelodyneFault::kStamp: ++counters_.bad_stamp; break;
        case VelodyneFault::kMode: ++counters_.bad_mode; break;
        case VelodyneFault::kModel: ++counters_.bad_model; break;
        case VelodyneFault::kPps:
        case VelodyneFault::kSentence: ++counters_.bad_position; break;
    }
}

std::optional<VelodynePosition> VelodyneAssembler::on_position(std::span<const std::uint8_t> payload,
                                                               std::uint32_t source) {
    if (source != params_.source_address) {
        ++counters_.foreign;
        return std::nullopt;
    }
    VelodynePosition position;
    const VelodyneFault fault = decode(payload, position);
    if (fault != VelodyneFault::kNone) {
        count(fault);
        return std::nullopt;
    }
    ++counters_.positions;
    return position;
}

void VelodyneAssembler::know(const VelodyneCalibration& calibration) {
    geometry_.emplace(params_.model, calibration);
    cloud_.upward = lasers_upward(params_.model, calibration);
}

bool VelodyneAssembler::learn(const VelodynePacket& packet) {
    if (!geometry_) {
        calibration_ = status_.on_packet({packet.mode, packet.product});
        if (calibration_) {
            know(*calibration_);
        }
        ++counters_.without_calibration;
        return false;
    }
    return true;
}

void VelodyneAssembler::handle(std::span<const std::uint8_t> payload, std::uint32_t source, Stamp received,
                               Visitor visitor) {
    if (source != params_.source_address) {
        ++counters_.foreign;
        return;
    }
    VelodyneColumns columns;
    VelodyneFault fault = decode(payload, params_.model, packet_);
    if (fault == VelodyneFault::kNone && !split(packet_, params_.model, columns)) {
        fault = VelodyneFault::kAzimuth;
    }
    if (fault != VelodyneFault::kNone) {
        count(fault);
        return;
    }
    if (!learn(packet_)) {
        return;
    }
    if (before_) {
        const double since_us = elapsed_us(before_->stamp_us, packet_.stamp_us);
        if (since_us <= 0.0 && since_us > -kLatest_packets * traits_of(params_.model).packet_us) {
            ++counters_.late;
            return;
        }
    }
    const std::uint32_t steps = clock_.steps();
    clock_.observe(packet_.stamp_us, from_us(columns.last_firing_us), received);
    const bool clock_was_set = clock_.steps() != steps;  // what its stamps say of a gap is then worth nothing
    if (before_ && (clock_was_set || !bridge(packet_, columns, visitor))) {
        ++counters_.breaks;
        before_.reset();
        end_revolution(false, visitor);
    }
    add_packet(packet_, columns, visitor);
    ++counters_.packets;
}

bool VelodyneAssembler::bridge(const VelodynePacket& packet, const VelodyneColumns& columns, Visitor visitor) {
    if (columns.returns != before_->returns) {
        return false;
    }
    const double period_us = traits_of(params_.model).packet_us / static_cast<double>(columns.returns);
    const double periods = elapsed_us(before_->stamp_us, packet.stamp_us) / period_us;
    const double steps = std::floor(periods + 0.5);
    if (steps < 1.0 || absolute(periods - steps) > kStampTolerance_packets) {
        return false;
    }
    const auto lost = static_cast<std::uint64_t>(steps) - 1;
    counters_.lost += lost;
    const double turn_cdeg = before_->turn_cdeg;
    const double on_cdeg = in_turn(columns.column[0].azimuth_cdeg - before_->azimuth_cdeg);
    if (turn_cdeg == 0.0) {
        // The first pair of packets: how far the head turns meanwhile is known from now on.
        before_->turn_cdeg = on_cdeg;
        return lost == 0 && on_cdeg > 0.0 && on_cdeg < kTurn_cdeg / 8.0;
    }
    const double expected_cdeg = turn_cdeg * steps;
    const double tolerance_cdeg = turn_cdeg * kAngleTolerance_packets + expected_cdeg * kSpeedTolerance;
    if (expected_cdeg > kTurn_cdeg / 2.0 || absolute(on_cdeg - expected_cdeg) > tolerance_cdeg) {
        return false;
    }
    before_->turn_cdeg = on_cdeg / steps;
    if (lost > 0) {
        fill_gap(static_cast<std::uint32_t>(lost), columns, visitor);
    }
    return true;
}

void VelodyneAssembler::fill_gap(std::uint32_t lost, const VelodyneColumns& columns, Visitor visitor) {
    const double period_us = traits_of(params_.model).packet_us / static_cast<double>(columns.returns);
    const double gap_cdeg = in_turn(columns.column[0].azimuth_cdeg - before_->last_azimuth_cdeg);
    const auto pieces = static_cast<double>(lost * columns.count + 1);
    for (std::uint32_t i = 0; i < lost * columns.count; ++i) {
        const std::uint32_t packet = i / columns.count + 1;
        const double after_us =
            static_cast<double>(packet) * period_us + columns.column[i % columns.count].after_stamp_us;
        const double azimuth_cdeg =
            in_turn(before_->last_azimuth_cdeg + gap_cdeg * static_cast<double>(i + 1) / pieces);
        static_cast<void>(add_column(azimuth_cdeg, {before_->stamp_us, after_us}, false, visitor));
    }
}

void VelodyneAssembler::add_packet(const VelodynePacket& packet, const VelodyneColumns& columns, Visitor visitor) {
    if (cloud_.returns != columns.returns) {
        end_revolution(false, visitor);
        cloud_.returns = columns.returns;
    }
    for (std::uint32_t c = 0; c < columns.count; ++c) {
        const VelodyneColumn& column = columns.column[c];
        const auto at = add_column(column.azimuth_cdeg, {packet.stamp_us, column.after_stamp_us}, true, visitor);
        if (at) {
            fill_column(*at, packet, columns, c);
        }
    }
    const double turn_cdeg = before_ ? before_->turn_cdeg : 0.0;
    before_ = {.stamp_us = packet.stamp_us,
               .azimuth_cdeg = columns.column[0].azimuth_cdeg,
               .turn_cdeg = turn_cdeg,
               .last_azimuth_cdeg = columns.column[columns.count - 1].azimuth_cdeg,
               .returns = columns.returns};
}

std::optional<std::uint32_t> VelodyneAssembler::add_column(double azimuth_cdeg, SensorTime time, bool measured,
                                                           Visitor visitor) {
    if (cloud_.columns == 0 && !began_at_cut_) {
        turned_cdeg_ = in_turn(azimuth_cdeg - cut_cdeg_);
    } else {
        // Counted on, not compared with the cut: a head that trembles at the cut must not end two revolutions.
        turned_cdeg_ += step_between(previous_cdeg_, azimuth_cdeg);
    }
    previous_cdeg_ = azimuth_cdeg;
    if (turned_cdeg_ >= kTurn_cdeg) {
        end_revolution(began_at_cut_ && !skipping_, visitor);
        turned_cdeg_ -= kTurn_cdeg;
        began_at_cut_ = true;
    }
    const std::uint32_t at = cloud_.columns;
    if (at >= capacity::kCloudColumns || cloud_.at(at + 1, 0) > capacity::kCloudPoints) {
        counters_.full += skipping_ ? 0 : 1;
        skipping_ = true;
        return std::nullopt;
    }
    cloud_.stamp[at] = clock_.at(time.stamp_us) + from_us(time.after_us);
    cloud_.azimuth_rad[at] = azimuth_cdeg * kPerCdeg_rad;
    cloud_.measured[at] = measured;
    if (!measured) {
        ++cloud_.missing_columns;
        const auto first = static_cast<std::ptrdiff_t>(cloud_.at(at, 0));
        const auto last = static_cast<std::ptrdiff_t>(cloud_.at(at + 1, 0));
        std::fill(cloud_.beam.begin() + first, cloud_.beam.begin() + last, Beam::kInvalid);
    }
    ++cloud_.columns;
    return at;
}

void VelodyneAssembler::fill_column(std::uint32_t at, const VelodynePacket& packet, const VelodyneColumns& columns,
                                    std::uint32_t c) {
    const SinCos direction = sin_cos(cloud_.azimuth_rad[at]);
    geometry_->aim(columns.turn_cdeg_per_us[c] * kPerCdeg_rad);
    for (std::uint32_t r = 0; r < columns.returns; ++r) {
        for (std::uint32_t first = 0; first < cloud_.lasers; first += kVelodyneReturns) {
            const VelodyneReturns returns =
                returns_of(packet, params_.model, columns.returns, c, first / kVelodyneReturns, r);
            const std::size_t begin = cloud_.at(at, first, r);
            const std::size_t count = returns.distance.size();
            geometry_->place(first, direction, returns,
                             {.x_m = std::span(cloud_.x_m).subspan(begin, count),
                              .y_m = std::span(cloud_.y_m).subspan(begin, count),
                              .z_m = std::span(cloud_.z_m).subspan(begin, count),
                              .intensity = std::span(cloud_.intensity).subspan(begin, count)});
            const std::span<Beam> beams = std::span(cloud_.beam).subspan(begin, count);
            std::transform(returns.distance.begin(), returns.distance.end(), beams.begin(),
                           [](std::uint16_t distance) { return distance == 0 ? Beam::kNoReturn : Beam::kHit; });
            if (r == 1) {
                const VelodyneReturns last =
                    returns_of(packet, params_.model, columns.returns, c, first / kVelodyneReturns, 0);
                for (std::size_t i = 0; i < count; ++i) {
                    if (returns.distance[i] == last.distance[i] && returns.reflectivity[i] == last.reflectivity[i]) {
                        beams[i] = Beam::kInvalid;  // said already
                    }
                }
            }
        }
    }
}

void VelodyneAssembler::end_revolution(bool complete, Visitor visitor) {
    if (cloud_.columns > 0) {
        cloud_.complete = complete;
        visitor.call(visitor.object, cloud_);
    }
    cloud_.columns = 0;
    cloud_.missing_columns = 0;
    began_at_cut_ = false;
    skipping_ = false;
    clock_.adopt();
}

}  // namespace crspf
