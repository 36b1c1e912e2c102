// The pose on the CAN bus: five classic frames of 8 bytes, ids base to base + 4, described by config/crspf.dbc.
//
//   +0 position     x, y                          0.001 m, 24 bit signed
//   +1 motion       heading                       0.0001 rad, 16 bit signed
//                   speed, yaw rate               0.001 m/s, 0.001 rad/s, 16 bit signed
//   +2 quality      match value M                 0.1, 16 bit
//                   age                           0.0001 s, 16 bit: from the last scan's first beam to the sending
//                   flags, reset counter          8 bit each
//   +3 deviation    of x, y, heading              0.0001 m, 0.0001 m, 0.0001 rad, 16 bit
//   +4 correlation  of x y, x heading, y heading  0.0001, 16 bit signed
//
// All are little-endian. Byte 6 of each frame holds in its lower half the alive counter, the same in all five frames of
// one pose and one more (mod 16) in the next pose's; its upper half is zero. Byte 7 is the CRC-8 SAE J1850 of the id's
// lower byte, the id's upper byte, and bytes 0 to 6: a frame that was damaged, or stands under another frame's id, is
// seen. Values beyond their field are held at its end; for x, y, heading, speed and yaw rate a flag then says so.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/base/can_frame.hpp"
#include "core/base/pose.hpp"
#include "core/base/time.hpp"

namespace crspf {

/// A report's age before the first scan.
inline constexpr Duration kNoScanYet{std::numeric_limits<std::int64_t>::max()};

struct PoseReport {
    Pose2 P_map_base;
    double speed_mps = 0.0;       ///< [m/s] along the heading
    double yaw_rate_radps = 0.0;  ///< [rad/s] counter-clockwise positive
    Covariance3 covariance;       ///< of the pose
    double M = 0.0;               ///< match value of the paper's (11) [0 .. 2975 and a little over]
    Duration age = kNoScanYet;    ///< [ns] from the last scan's first beam to the sending, or kNoScanYet
    bool matched = false;         ///< the scan corrected the pose; otherwise it is the odometry's alone
    bool result = false;          ///< Result of (12): the pose is good
    bool degenerate = false;      ///< a direction kept the odometry's word
    bool lost = false;            ///< do not steer by it
    bool saturated = false;       ///< set by the encoder: a value did not fit its field
    std::uint8_t resets = 0;      ///< one more (mod 256) each time the pose jumped other than by moving
};

inline constexpr std::size_t kPoseFrames = 5;
/// Between CANopen's heartbeats (to 0x77F) and OBD-II (from 0x7DF).
inline constexpr std::uint32_t kPoseBaseId = 0x780;

/// Wait-free, no heap, no throw; one owner.
class PoseEncoder {
 public:
    /// @param base_id the five ids must be standard ones: at most 0x7FB
    explicit PoseEncoder(std::uint32_t base_id = kPoseBaseId) : base_id_(base_id) {}

    /// The frames of one pose. Nothing where a number of it is not finite: no pose is better than a false one.
    std::optional<std::array<CanFrame, kPoseFrames>> encode(const PoseReport& report);

 private:
    std::uint32_t base_id_;
    std::uint8_t alive_ = 0;
};

/// Never reset.
struct PoseDecoderCounters {
    std::uint64_t poses = 0;
    std::uint64_t bad_crc = 0;     ///< frames that were damaged, or are not of this kind
    std::uint64_t incomplete = 0;  ///< poses of which a frame is missing
    std::uint64_t missed = 0;      ///< poses of which no frame came, as far as the alive counter tells (mod 16)
};

/// Puts the frames together again, in whatever order they come. Wait-free, no heap, no throw; one owner.
class PoseDecoder {
 public:
    explicit PoseDecoder(std::uint32_t base_id = kPoseBaseId) : base_id_(base_id) {}

    /// The pose, with the last of its frames. Feed every frame of the bus.
    std::optional<PoseReport> on_frame(const CanFrame& frame);

    [[nodiscard]] const PoseDecoderCounters& counters() const { return counters_; }

 private:
    void begin(std::uint8_t alive);

    std::uint32_t base_id_;
    std::array<CanFrame, kPoseFrames> frames_{};
    unsigned have_ = 0;  ///< bit i: frame i of the pose `alive_`
    std::uint8_t alive_ = 0;
    bool begun_ = false;
    PoseDecoderCounters counters_;
};

}  // namespace crspf
