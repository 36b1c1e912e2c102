// The little of CANopen (CiA 301) that a listener to drives and encoders needs: start the nodes, watch them live.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/can_frame.hpp"
#include "core/base/time.hpp"

namespace crspf {

enum class NmtCommand : std::uint8_t {
    kStart = 1,
    kStop = 2,
    kEnterPreOperational = 128,
    kResetNode = 129,
    kResetCommunication = 130,
};

/// States of a node as its heartbeat tells them.
enum class NodeState : std::uint8_t { kBootUp = 0, kStopped = 4, kOperational = 5, kPreOperational = 127 };

/// A node sends its PDOs only after kStart. @param node 1 to 127, 0 for all
[[nodiscard]] CanFrame nmt_command(NmtCommand command, std::uint8_t node);
/// Synchronous PDOs are sampled and sent at this frame: both wheels at one instant.
[[nodiscard]] CanFrame canopen_sync();

struct HeartbeatCounters {
    std::uint64_t heartbeats = 0;
    std::uint64_t boot_ups = 0;  ///< the node restarted: counters may have begun anew
    std::uint64_t timeouts = 0;  ///< silences, each counted once
    std::uint64_t unknown = 0;   ///< heartbeats of a wrong length, or of a state that CiA 301 does not know
};

/// Watches one node. Wait-free, no heap, no throw; one owner.
class HeartbeatWatch {
 public:
    /// @param node 1 to 127  @param timeout two or three periods of the node's heartbeat (object 0x1017)
    HeartbeatWatch(std::uint8_t node, Duration timeout) : node_(node), timeout_(timeout) {}

    /// Feed every frame of the bus. What comes back is to be sent: the start of a node that waits for it, once for each
    /// of its heartbeats. A stopped node was stopped by somebody and stays so.
    std::optional<CanFrame> on_frame(const CanFrame& frame, Stamp received);
    void on_time(Stamp now);

    /// Operational, and heard within the timeout.
    [[nodiscard]] bool operational(Stamp now) const {
        return state_ == NodeState::kOperational && now - last_ <= timeout_;
    }
    /// Nothing before the first heartbeat.
    [[nodiscard]] std::optional<NodeState> state() const { return state_; }
    [[nodiscard]] const HeartbeatCounters& counters() const { return counters_; }

 private:
    std::uint8_t node_;
    Duration timeout_;
    std::optional<NodeState> state_;
    Stamp last_;
    bool silent_ = false;
    HeartbeatCounters counters_;
};

}  // namespace crspf
