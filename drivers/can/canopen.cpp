#include "drivers/can/canopen.hpp"

namespace crspf {
namespace {

constexpr std::uint32_t kSyncId = 0x080;
constexpr std::uint32_t kHeartbeatId = 0x700;  // + node

bool known(std::uint8_t state) {
    switch (static_cast<NodeState>(state)) {
        case NodeState::kBootUp:
        case NodeState::kStopped:
        case NodeState::kOperational:
        case NodeState::kPreOperational: return true;
    }
    return false;
}

}  // namespace

CanFrame nmt_command(NmtCommand command, std::uint8_t node) {
    CanFrame frame{.id = 0, .length = 2};
    frame.data[0] = static_cast<std::uint8_t>(command);
    frame.data[1] = node;
    return frame;
}

CanFrame canopen_sync() {
    return {.id = kSyncId};
}

std::optional<CanFrame> HeartbeatWatch::on_frame(const CanFrame& frame, Stamp received) {
    if (frame.id != kHeartbeatId + node_ || frame.extended || frame.error || frame.remote) {
        return std::nullopt;
    }
    on_time(received);
    const std::uint8_t byte = frame.data[0] & 0x7FU;  // bit 7 toggles in the node guarding of old devices
    if (frame.length != 1 || !known(byte)) {
        ++counters_.unknown;
        return std::nullopt;
    }
    ++counters_.heartbeats;
    state_ = static_cast<NodeState>(byte);
    counters_.boot_ups += state_ == NodeState::kBootUp ? 1U : 0U;
    last_ = received;
    silent_ = false;
    if (state_ == NodeState::kBootUp || state_ == NodeState::kPreOperational) {
        return nmt_command(NmtCommand::kStart, node_);
    }
    return std::nullopt;
}

void HeartbeatWatch::on_time(Stamp now) {
    if (state_ && !silent_ && now - last_ > timeout_) {
        silent_ = true;
        ++counters_.timeouts;
    }
}

}  // namespace crspf
