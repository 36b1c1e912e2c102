// The base of the simulated robot on its CAN bus: two drives of CiA 402 that tell their position counters.
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>

#include "core/base/can_frame.hpp"
#include "core/base/time.hpp"
#include "drivers/can/frame_signal.hpp"
#include "tools/sim/random.hpp"
#include "tools/sim/robot.hpp"

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

class CanopenDrives {
 public:
    /// A frame, and when the host hears it.
    using Record = std::function<void(Stamp, const CanFrame&)>;

    CanopenDrives(std::uint64_t seed, Record record);

    /// Both nodes are operational from now on and say so twice a second.
    void begin(Stamp now);
    /// Heartbeats up to `now`, at which both drives send their counters. `now` never falls.
    void send(Stamp now, const EncoderCounts& counts);

 private:
    void put(Stamp now, const CanFrame& frame);

    Record record_;
    Random random_;
    FrameSignal left_;
    FrameSignal right_;
    Stamp next_heartbeat_;
    Stamp last_;  ///< reception of the frame before: frames do not overtake each other
};

}  // namespace crspf::sim
