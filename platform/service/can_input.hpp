// The frames of a CAN bus -> samples of the odometer that the configuration binds to it.
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "config/sources.hpp"
#include "drivers/can/canopen.hpp"
#include "drivers/can/motion_decoders.hpp"
#include "drivers/can/wheel_decoder.hpp"
#include "platform/capture/source_report.hpp"
#include "platform/service/sample_sink.hpp"

namespace crspf {

class CanInput {
 public:
    explicit CanInput(const CanSourceConfig& config);

    /// Every frame of the bus. What comes back is to be sent: the start of a CANopen node that waits for it.
    std::optional<CanFrame> on_frame(const CanFrame& frame, Stamp received, SampleSink& sink);
    /// Now and then, so that silence is seen.
    void on_time(Stamp now);
    [[nodiscard]] SourceCounts counts() const;

 private:
    std::variant<std::monostate, WheelDecoder, AckermannDecoder, ImuDecoder> decoder_;
    std::vector<HeartbeatWatch> nodes_;
};

}  // namespace crspf
