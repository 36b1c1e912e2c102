#include "tools/experiments/taped_robot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <string_view>
#include <utility>

#include "core/base/trig.hpp"
#include "tools/experiments/runs.hpp"
#include "tools/sim/log_writer.hpp"
#include "tools/sim/scene.hpp"
#include "tools/sim/simulation.hpp"

namespace crspf::experiments {
namespace {

constexpr std::uint64_t kStands = 20;  // revolutions: until the service listens
constexpr double kStands_s = static_cast<double>(kStands) / TapedRobot::kScanRate_hz;
constexpr double kTapeRate_hz = 250.0;  // of the wheels: finer than the time from step 0 to the first beam
constexpr double kMetresPerMillimetre = 1e-3;

/// Takes the place of a log.
class Tape final : public sim::LogWriter {
 public:
    Tape(std::vector<std::vector<int>>& range_mm, std::vector<sim::EncoderCounts>& counts)
        : range_mm_(range_mm), counts_(counts) {}

    void odometry(const sim::OdometryRecord& record, std::string& /*text*/) override {
        counts_.push_back(record.counts);
    }
    void scan(const sim::ScanRecord& record, std::string& /*text*/) override { range_mm_.push_back(record.range_mm); }

 private:
    std::vector<std::vector<int>>& range_mm_;
    std::vector<sim::EncoderCounts>& counts_;
};

}  // namespace

TapedRobot::TapedRobot(double seconds, std::uint64_t seed) {
    sim::SimulationParams params = urg_robot(seed);
    params.duration_s = seconds;
    params.odometry_rate_hz = kTapeRate_hz;
    metres_per_count_ = params.robot.metres_per_count();
    P_base_lidar_ = params.P_base_lidar;
    wheel_span_m_ = params.robot.wheel_span_m;
    range_max_m_ = params.lidar.range_max_m;
    Tape tape(range_mm_, counts_);
    const sim::SimulationResult result = sim::simulate(
        sim::make_scene("office"), params, tape, [](std::string_view) {}, [](double) {});
    for (const TimedPose& pose : result.truth) {
        truth_.push_back(pose.P_map_base);
    }
}

ScipSensor TapedRobot::sensor() {
    constexpr std::string_view kModel = "URG-04LX";
    constexpr double kSecondsPerMinute = 60.0;
    ScipSensor sensor;
    std::copy(kModel.begin(), kModel.end(), sensor.model.begin());
    sensor.dmin_mm = 20;
    sensor.dmax_mm = 5600;
    sensor.ares = 1024;
    sensor.amin = 44;
    sensor.amax = 725;
    sensor.afrt = 384;
    sensor.scan_rpm = static_cast<std::uint32_t>(kSecondsPerMinute * kScanRate_hz);
    return sensor;
}

void TapedRobot::revolution(std::uint64_t number, std::span<std::uint32_t> step_mm) const {
    const std::uint64_t at = std::min<std::uint64_t>(number > kStands ? number - kStands : 0, range_mm_.size() - 1);
    const std::vector<int>& ranges = *(range_mm_.begin() + static_cast<std::ptrdiff_t>(at));
    std::copy(ranges.begin(), ranges.end(), step_mm.subspan(sensor().amin).begin());
}

std::vector<CanFrame> TapedRobot::wheels(std::uint64_t tick) const {
    // Of a revolution of the drive the first beam is at its beginning, of one of the sensor some steps later.
    const double first_beam_s = sensor().amin * sensor().step_s();
    const double time_s = std::max(kWheelPeriod_s * static_cast<double>(tick) - kStands_s - first_beam_s, 0.0);
    const auto index = static_cast<std::size_t>(std::lround(kTapeRate_hz * time_s));
    const sim::EncoderCounts& counts = counts_[std::min(index, counts_.size() - 1)];
    std::vector<CanFrame> frames(2);
    for (std::size_t side = 0; side < frames.size(); ++side) {
        const auto count = static_cast<std::int32_t>(side == 0 ? counts.left : counts.right);
        frames[side].id = static_cast<std::uint32_t>(side + 1);
        frames[side].length = sizeof count;
        std::memcpy(frames[side].data.data(), &count, sizeof count);
    }
    return frames;
}

std::string TapedRobot::config(const std::string& line) const {
    std::array<char, 256> text{};
    std::snprintf(text.data(), text.size(),
                  "[lidar]\nx_m = %.6f\nrange_max_m = %.6f\n\n[odometry]\nwheel_span_m = %.6f\n\n", P_base_lidar_.x_m,
                  range_max_m_, wheel_span_m_);
    std::string config = text.data();
    config += "[source.lidar]\ndriver = \"scip\"\nport = \"" + line + "\"\n\n";
    config +=
        "[source.base]\ndriver = \"can\"\nport = \"can0\"\n"
        "dbc_text = \"\"\"\nBO_ 1 L: 4 X\n SG_ C : 0|32@1- (1,0) [0|0] \\\"\\\" X\n"
        "BO_ 2 R: 4 X\n SG_ C : 0|32@1- (1,0) [0|0] \\\"\\\" X\n\"\"\"\n";
    for (const auto& [side, signal] : {std::pair{"left", "L.C"}, std::pair{"right", "R.C"}}) {
        std::snprintf(text.data(), text.size(), "\n[source.base.%s]\nsignal = \"%s\"\nscale = %.12e\n", side, signal,
                      metres_per_count_);
        config += text.data();
    }
    return config;
}

std::optional<std::size_t> TapedRobot::recognise(const Scan& scan) const {
    constexpr float kSame_m = 0.0005F;
    const auto same = [&scan](const std::vector<int>& range_mm) {
        const std::size_t beams = std::min<std::size_t>(scan.count, range_mm.size());
        for (std::size_t i = 0; i < beams; ++i) {
            const auto told_m = static_cast<float>(kMetresPerMillimetre * range_mm[i]);
            if (scan.beam[i] == Beam::kHit && std::abs(scan.range_m[i] - told_m) > kSame_m) {
                return false;
            }
        }
        return beams > 0;
    };
    const auto found = std::find_if(range_mm_.begin(), range_mm_.end(), same);
    return found == range_mm_.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - range_mm_.begin()));
}

}  // namespace crspf::experiments
