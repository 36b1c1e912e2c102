// Two drives of CiA 402 that tell their position counters.
#pragma once

#include <cstdint>
#include <string_view>

#include "core/base/time.hpp"
#include "drivers/can/frame_signal.hpp"
#include "tools/sim/base_bus.hpp"

namespace crspf::sim {

/// The two messages of config/dbc/canopen_402.dbc that the drives send.
inline constexpr std::string_view kCanopenDbc =
    "BO_ 897 LeftPosition: 6 LEFT\n"
    " SG_ LeftStatusword : 0|16@1+ (1,0) [0|65535] \"\" Vector__XXX\n"
    " SG_ LeftPositionActual : 16|32@1- (1,0) [0|0] \"counts\" Vector__XXX\n"
    "\n"
    "BO_ 898 RightPosition: 6 RIGHT\n"
    " SG_ RightStatusword : 0|16@1+ (1,0) [0|65535] \"\" Vector__XXX\n"
    " SG_ RightPositionActual : 16|32@1- (1,0) [0|0] \"counts\" Vector__XXX\n";
inline constexpr std::string_view kLeftSignal = "LeftPosition.LeftPositionActual";
inline constexpr std::string_view kRightSignal = "RightPosition.RightPositionActual";

class CanopenDrives final : public BaseBus {
 public:
    CanopenDrives(std::uint64_t seed, Record record);

    /// Both nodes are operational from now on and say so twice a second.
    void begin(Stamp now) override;
    /// Heartbeats up to `now`, at which both drives send their counters.
    void send(Stamp now, const OdometryRecord& odometry) override;

 private:
    FrameSignal left_;
    FrameSignal right_;
    Stamp next_heartbeat_;
};

}  // namespace crspf::sim
