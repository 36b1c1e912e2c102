#include "drivers/can/pose_frames.hpp"

#include <algorithm>
#include <cmath>  // abs, isfinite, sqrt
#include <initializer_list>

#include "core/base/trig.hpp"
#include "drivers/can/can_signal.hpp"
#include "drivers/can/crc8.hpp"

namespace crspf {
namespace {

constexpr CanSignal whole(std::uint16_t byte, std::uint8_t bytes, SignalType type, double factor) {
    return {.start_bit = static_cast<std::uint16_t>(8 * byte),
            .length = static_cast<std::uint8_t>(8 * bytes),
            .type = type,
            .factor = factor};
}

// As config/crspf.dbc has them; a test compares the two.
constexpr CanSignal kX = whole(0, 3, SignalType::kSigned, 1e-3);
constexpr CanSignal kY = whole(3, 3, SignalType::kSigned, 1e-3);
constexpr CanSignal kHeading = whole(0, 2, SignalType::kSigned, 1e-4);
constexpr CanSignal kSpeed = whole(2, 2, SignalType::kSigned, 1e-3);
constexpr CanSignal kYawRate = whole(4, 2, SignalType::kSigned, 1e-3);
constexpr CanSignal kMatch = whole(0, 2, SignalType::kUnsigned, 0.1);
constexpr CanSignal kAge = whole(2, 2, SignalType::kUnsigned, 1e-4);
constexpr std::size_t kFlagsByte = 4;
constexpr std::size_t kResetsByte = 5;
constexpr std::array<CanSignal, 3> kDeviations = {whole(0, 2, SignalType::kUnsigned, 1e-4),
                                                  whole(2, 2, SignalType::kUnsigned, 1e-4),
                                                  whole(4, 2, SignalType::kUnsigned, 1e-4)};
constexpr std::array<CanSignal, 3> kCorrelations = {whole(0, 2, SignalType::kSigned, 1e-4),
                                                    whole(2, 2, SignalType::kSigned, 1e-4),
                                                    whole(4, 2, SignalType::kSigned, 1e-4)};
constexpr std::size_t kAliveByte = 6;
constexpr std::size_t kCrcByte = 7;
constexpr unsigned kAliveMask = 0x0F;

constexpr unsigned kMatched = 0x01;
constexpr unsigned kResult = 0x02;
constexpr unsigned kDegenerate = 0x04;
constexpr unsigned kLost = 0x08;
constexpr unsigned kSaturated = 0x10;

std::uint8_t crc_of(const CanFrame& frame) {
    const std::array<std::uint8_t, 2> id = {static_cast<std::uint8_t>(frame.id & 0xFFU),
                                            static_cast<std::uint8_t>(frame.id >> 8U)};
    return crc8_j1850(frame.payload().first(kCrcByte), crc8_j1850(id));
}

/// Puts a value into its field. Whether the field could hold it.
bool put(CanFrame& frame, const CanSignal& signal, double value) {
    const bool known = encode(signal, frame.data, value);
    const double kept = decode(signal, frame.data).value_or(0.0);
    return known && std::abs(kept - value) <= signal.factor;
}

double get(const CanFrame& frame, const CanSignal& signal) {
    return decode(signal, frame.payload()).value_or(0.0);
}

/// Rounding may have left a correlation of a hair over one, and a variance that is 0 has none.
double correlation(double covariance, double deviation_a, double deviation_b) {
    const double product = deviation_a * deviation_b;
    return product > 0.0 ? std::clamp(covariance / product, -1.0, 1.0) : 0.0;
}

bool finite(const PoseReport& report) {
    const Covariance3& c = report.covariance;
    const auto all = {report.P_map_base.x_m,
                      report.P_map_base.y_m,
                      report.P_map_base.theta_rad,
                      report.speed_mps,
                      report.yaw_rate_radps,
                      report.M,
                      c.xx,
                      c.xy,
                      c.yy,
                      c.xt,
                      c.yt,
                      c.tt};
    return std::all_of(all.begin(), all.end(), [](double value) { return std::isfinite(value); });
}

void put_covariance(const Covariance3& c, CanFrame& deviation_frame, CanFrame& correlation_frame) {
    std::array<double, 3> deviation{};
    const std::array<double, 3> variance = {c.xx, c.yy, c.tt};
    for (std::size_t i = 0; i < 3; ++i) {
        deviation[i] = std::sqrt(std::max(variance[i], 0.0));
        put(deviation_frame, kDeviations[i], deviation[i]);
    }
    put(correlation_frame, kCorrelations[0], correlation(c.xy, deviation[0], deviation[1]));
    put(correlation_frame, kCorrelations[1], correlation(c.xt, deviation[0], deviation[2]));
    put(correlation_frame, kCorrelations[2], correlation(c.yt, deviation[1], deviation[2]));
}

Covariance3 get_covariance(const CanFrame& deviation_frame, const CanFrame& correlation_frame) {
    const double x = get(deviation_frame, kDeviations[0]);
    const double y = get(deviation_frame, kDeviations[1]);
    const double t = get(deviation_frame, kDeviations[2]);
    return {.xx = x * x,
            .xy = get(correlation_frame, kCorrelations[0]) * x * y,
            .yy = y * y,
            .xt = get(correlation_frame, kCorrelations[1]) * x * t,
            .yt = get(correlation_frame, kCorrelations[2]) * y * t,
            .tt = t * t};
}

}  // namespace

std::optional<std::array<CanFrame, kPoseFrames>> PoseEncoder::encode(const PoseReport& report) {
    if (!finite(report)) {
        return std::nullopt;
    }
    std::array<CanFrame, kPoseFrames> frames{};
    for (std::size_t i = 0; i < kPoseFrames; ++i) {
        frames[i].id = base_id_ + static_cast<std::uint32_t>(i);
        frames[i].length = 8;
        frames[i].data[kAliveByte] = alive_;
    }
    bool fit = put(frames[0], kX, report.P_map_base.x_m);
    fit = put(frames[0], kY, report.P_map_base.y_m) && fit;
    fit = put(frames[1], kHeading, wrap_angle(report.P_map_base.theta_rad)) && fit;
    fit = put(frames[1], kSpeed, report.speed_mps) && fit;
    fit = put(frames[1], kYawRate, report.yaw_rate_radps) && fit;
    put(frames[2], kMatch, report.M);
    put(frames[2], kAge, report.age.seconds());
    const unsigned flags = (report.matched ? kMatched : 0U) | (report.result ? kResult : 0U) |
                           (report.degenerate ? kDegenerate : 0U) | (report.lost ? kLost : 0U) |
                           (report.saturated || !fit ? kSaturated : 0U);
    frames[2].data[kFlagsByte] = static_cast<std::uint8_t>(flags);
    frames[2].data[kResetsByte] = report.resets;
    put_covariance(report.covariance, frames[3], frames[4]);
    for (CanFrame& frame : frames) {
        frame.data[kCrcByte] = crc_of(frame);
    }
    alive_ = static_cast<std::uint8_t>((alive_ + 1U) & kAliveMask);
    return frames;
}

void PoseDecoder::begin(std::uint8_t alive) {
    if (begun_) {
        counters_.incomplete += have_ != 0 && have_ != (1U << kPoseFrames) - 1 ? 1U : 0U;
        counters_.missed += (alive - alive_ - 1U) & kAliveMask;
    }
    begun_ = true;
    alive_ = alive;
    have_ = 0;
}

std::optional<PoseReport> PoseDecoder::on_frame(const CanFrame& frame) {
    const std::uint32_t index = frame.id - base_id_;
    if (index >= kPoseFrames || frame.extended || frame.error || frame.remote) {
        return std::nullopt;
    }
    if (frame.length != 8 || frame.data[kCrcByte] != crc_of(frame)) {
        ++counters_.bad_crc;
        return std::nullopt;
    }
    const auto alive = static_cast<std::uint8_t>(frame.data[kAliveByte] & kAliveMask);
    // The same frame once more: 16 poses later, or sent twice.
    if (!begun_ || alive != alive_ || (have_ >> index & 1U) != 0) {
        begin(alive);
    }
    frames_[index] = frame;
    have_ |= 1U << index;
    if (have_ != (1U << kPoseFrames) - 1) {
        return std::nullopt;
    }
    ++counters_.poses;
    const unsigned flags = frames_[2].data[kFlagsByte];
    PoseReport report;
    report.P_map_base = {
        .x_m = get(frames_[0], kX), .y_m = get(frames_[0], kY), .theta_rad = get(frames_[1], kHeading)};
    report.speed_mps = get(frames_[1], kSpeed);
    report.yaw_rate_radps = get(frames_[1], kYawRate);
    report.covariance = get_covariance(frames_[3], frames_[4]);
    report.M = get(frames_[2], kMatch);
    report.age = Duration::from_seconds(get(frames_[2], kAge));
    report.matched = (flags & kMatched) != 0;
    report.result = (flags & kResult) != 0;
    report.degenerate = (flags & kDegenerate) != 0;
    report.lost = (flags & kLost) != 0;
    report.saturated = (flags & kSaturated) != 0;
    report.resets = frames_[2].data[kResetsByte];
    return report;
}

}  // namespace crspf
