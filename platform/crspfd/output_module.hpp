// The thread that sends the pose, at a fixed rate.
#pragma once

#include <memory>

#include "config/service_config.hpp"
#include "core/base/latest_value.hpp"
#include "drivers/can/pose_frames.hpp"
#include "platform/crspfd/exchange.hpp"
#include "platform/crspfd/pose_composer.hpp"
#include "platform/ports/can_bus.hpp"

namespace crspf {

struct OutputState {
    PoseReport report;
    PoseComposerCounters counters;
    std::uint64_t unsent = 0;  ///< poses of which a frame did not get onto the bus in its time
    bool bus_open = false;
    int bus_error = 0;  ///< why not: the number of the system's error
    CanHealth bus;
};

/// turn() is one thread's: no heap, no throw; waits for the bus no longer than half a period.
class OutputModule {
 public:
    /// @param bus nullptr: the pose is composed, not sent
    OutputModule(const PoseOutputConfig& config, Exchange& exchange, std::unique_ptr<CanBus> bus);

    [[nodiscard]] Duration period() const { return period_; }
    /// Composes and sends the pose of this moment. A frame that the bus does not take in time is given up: what comes
    /// next is newer.
    void turn(Stamp now);

    /// -> control
    LatestValue<OutputState> state;

 private:
    void send(const PoseReport& report, Stamp now);

    Exchange& exchange_;
    Duration period_;
    PoseComposer composer_;
    PoseEncoder encoder_;
    std::unique_ptr<CanBus> bus_;
    OutputState out_;
};

}  // namespace crspf
