// A simulated drive, kept as what its sensors say, so that live sensors can say it in real time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/can_frame.hpp"
#include "core/base/pose.hpp"
#include "core/base/samples.hpp"
#include "drivers/scip/scip_sensor.hpp"
#include "tools/sim/robot.hpp"

namespace crspf::experiments {

/// The URG robot in the office. It stands for a while, then drives. Read-only once made: for any thread.
class TapedRobot {
 public:
    static constexpr double kWheelPeriod_s = 0.02;
    static constexpr double kScanRate_hz = 10.0;

    /// @param seconds of the drive
    TapedRobot(double seconds, std::uint64_t seed);

    [[nodiscard]] static ScipSensor sensor();
    /// What a revolution reads, for sim::LiveUrg.
    void revolution(std::uint64_t number, std::span<std::uint32_t> step_mm) const;
    /// What the wheels' controller sends, for sim::LiveCanNode.
    [[nodiscard]] std::vector<CanFrame> wheels(std::uint64_t tick) const;
    /// What a service must be told of it.
    [[nodiscard]] std::string config(const std::string& line) const;

    /// Which revolution of the drive a scan was; it knows it by its noise.
    [[nodiscard]] std::optional<std::size_t> recognise(const Scan& scan) const;
    /// At the first beam of a revolution of the drive. Frame: the simulated world.
    [[nodiscard]] const std::vector<Pose2>& truth() const { return truth_; }

 private:
    double metres_per_count_ = 0.0;
    Pose2 P_base_lidar_;
    double wheel_span_m_ = 0.0;
    double range_max_m_ = 0.0;
    std::vector<std::vector<int>> range_mm_;  ///< of each revolution
    std::vector<sim::EncoderCounts> counts_;  ///< each kTape_s
    std::vector<Pose2> truth_;
};

}  // namespace crspf::experiments
