#include "tools/sim/canopen_drives.hpp"

#include <utility>

#include "drivers/can/canopen.hpp"

namespace crspf::sim {
namespace {

constexpr Duration kHeartbeat{500'000'000};
constexpr std::uint16_t kOperationEnabled = 0x0237;

CanFrame position_frame(const FrameSignal& signal, std::int64_t counts) {
    CanFrame frame{.id = signal.id, .length = 6};
    frame.data[0] = kOperationEnabled & 0xFFU;
    frame.data[1] = kOperationEnabled >> 8U;
    insert_bits(signal.layout, frame.data, static_cast<std::uint32_t>(counts));  // the drive's counter has 32 bits
    return frame;
}

CanFrame heartbeat(std::uint8_t node) {
    CanFrame frame{.id = 0x700U + node, .length = 1};
    frame.data[0] = static_cast<std::uint8_t>(NodeState::kOperational);
    return frame;
}

}  // namespace

CanopenDrives::CanopenDrives(std::uint64_t seed, Record record)
    : BaseBus(seed, RandomStream::kDrives, std::move(record)),
      left_(signal_of(kCanopenDbc, kLeftSignal)),
      right_(signal_of(kCanopenDbc, kRightSignal)) {}

void CanopenDrives::begin(Stamp now) {
    next_heartbeat_ = now;
}

void CanopenDrives::send(Stamp now, const OdometryRecord& odometry) {
    for (; next_heartbeat_ <= now; next_heartbeat_ = next_heartbeat_ + kHeartbeat) {
        put(next_heartbeat_, heartbeat(1));
        put(next_heartbeat_, heartbeat(2));
    }
    put(now, position_frame(left_, odometry.counts.left));
    put(now, position_frame(right_, odometry.counts.right));
}

}  // namespace crspf::sim
