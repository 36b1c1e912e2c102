// The HDL-64E says its calibration in the status bytes of its packets, a byte each: no file is needed.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "drivers/velodyne/velodyne_models.hpp"

namespace crspf {

/// 16 packets are a cycle: H M S D N Y G T V, which tell the time, GPS, temperature and firmware, then '1' to '7',
/// which carry seven bytes. Four cycles are a laser, 260 are the whole (HDL-64E S3 manual 63-HDL64ES3, pp. 32-38).
inline constexpr std::uint32_t kVelodyneStatusCycle = 16;
inline constexpr std::uint32_t kVelodyneStatusPackets = 260 * kVelodyneStatusCycle;

struct VelodyneStatus {
    std::uint8_t type = 0;
    std::uint8_t value = 0;
};

/// Collects a calibration. It needs 4096 packets in a row, about a second; a lost one makes it begin again, since the
/// bytes are numbered within a cycle only. The place of a laser in the stream is known by its number: of the four
/// places where the first could stand, one counts from 0 to 63. Wait-free. One owner.
class VelodyneStatusListener {
 public:
    /// The calibration, with the packet that completes it.
    std::optional<VelodyneCalibration> on_packet(VelodyneStatus status);

    [[nodiscard]] std::uint32_t restarts() const { return restarts_; }

 private:
    static constexpr std::uint32_t kPlaces = 4;      // cycles of a laser
    static constexpr std::uint32_t kCycleBytes = 7;  // of which three cycles hold the corrections
    static constexpr std::uint32_t kLaserBytes = 21;
    using LaserBytes = std::array<std::uint8_t, kLaserBytes>;

    std::optional<VelodyneCalibration> on_cycle();
    [[nodiscard]] static VelodyneLaser laser_of(const LaserBytes& bytes);

    std::uint32_t step_ = 0;  ///< within the cycle
    std::uint32_t place_ = 0;
    std::uint32_t restarts_ = 0;
    std::array<std::uint8_t, kCycleBytes> cycle_{};
    std::array<std::uint32_t, kPlaces> cycles_{};  ///< held so far, if the first stands in this place
    std::array<VelodyneCalibration, kPlaces> lasers_{};
    std::array<LaserBytes, kPlaces> bytes_{};
};

/// For the simulator: the status of packet `index` of a stream that tells this calibration.
[[nodiscard]] VelodyneStatus status_of(const VelodyneCalibration& calibration, std::uint32_t index);

}  // namespace crspf
