// LMDscandata -> what follows plausibly from what came before, with its times -> Scan.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/lidar_params.hpp"
#include "core/base/samples.hpp"
#include "core/base/time.hpp"
#include "drivers/common/clock_estimator.hpp"
#include "drivers/sick/lmd_scandata.hpp"

namespace crspf {

/// When a scan was measured and sent, on the sensor's own clock, and received, on the host's. Who knows the offset
/// between the two clocks can stamp the scan: SickClock does.
struct SickTiming {
    std::uint64_t start_us = 0;     ///< [us] beam 0, unwrapped: the sensor's clock has 32 bits, 4295 s
    std::uint64_t transmit_us = 0;  ///< [us] when the telegram was sent, on the same line
    Stamp received;                 ///< when its last byte was handed in
    std::uint32_t clock_epoch = 0;  ///< counts up where start_us begins anew: a restarted sensor, a new connection
    std::uint32_t lost_before = 0;  ///< telegrams missing since the scan before
};

/// The sensor's clock on the host's line, learnt from when its telegrams arrive. Wait-free. One owner.
class SickClock {
 public:
    /// Beam 0's stamp on the host's line. What the fastest telegram takes on its way remains in it, some 0.1 ms.
    [[nodiscard]] Stamp beam0(const SickTiming& timing);

 private:
    ClockEstimator clock_;
    std::uint32_t epoch_ = 0;
};

struct SickSequenceCounters {
    std::uint64_t delivered = 0;
    std::uint64_t withheld = 0;  ///< does not follow from the scan before: damaged, or the first of its kind
    std::uint64_t lost = 0;      ///< gaps of the telegram counter
};

/// Passes a telegram that follows from the one before: same sensor and geometry, counters and clock ahead and in step.
/// One that does not is withheld; the next is passed if it follows from either. So a damaged telegram that CoLa's weak
/// sum let through stays out, and a restarted or reconfigured sensor costs one scan. Wait-free.
class SickSequence {
 public:
    /// The timing of a telegram that may be used.
    [[nodiscard]] std::optional<SickTiming> accept(const LmdScandata& data, Stamp received);

    /// For a new connection: the next scan follows from nothing.
    void reset();

    /// From a telegram to the next, as the last two say; 0 where there were none. [s]
    [[nodiscard]] double period_s() const { return period_s_; }
    [[nodiscard]] const SickSequenceCounters& counters() const { return counters_; }

 private:
    struct Key {
        std::uint32_t serial = 0;
        std::uint16_t telegram_counter = 0;
        std::uint16_t scan_counter = 0;
        std::uint32_t start_us = 0;
        std::uint32_t scan_frequency_centihertz = 0;
        std::uint16_t version = 0;
        std::uint16_t device = 0;
        std::uint16_t channels16 = 0;
        std::uint16_t channels8 = 0;
        SickChannel distance;
    };
    [[nodiscard]] static Key key_of(const LmdScandata& data);
    [[nodiscard]] static bool follows(const Key& before, const Key& now);

    std::optional<Key> last_;
    std::optional<Key> withheld_;
    std::uint64_t last_start_us_ = 0;
    std::uint32_t epoch_ = 0;
    double period_s_ = 0.0;
    SickSequenceCounters counters_;
};

enum class SickScanResult : std::uint8_t {
    kFilled,
    kNoDistances,  ///< no channel DIST1, or an empty one, or one without a step
    kTooMany,      ///< more beams than capacity::kBeams
};

/// Fills `scan` from the first echo (DIST1), seen upright or hanging as `lidar` says, in REP-103's sense. `beam0` is
/// when the sensor measured its first beam; where beams are turned round, scan.stamp is that of the new beam 0 and
/// time_per_beam_s negative, as everywhere. Raw values below 16 are codes: 0 is no return, the others invalid.
/// Wait-free; a few microseconds for 1081 beams.
SickScanResult fill_scan(const LmdScandata& data, const LidarParams& lidar, Stamp beam0, Scan& scan);

}  // namespace crspf
