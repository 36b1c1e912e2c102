// What a SCIP sensor says of itself, and its ranges as a Scan.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/samples.hpp"
#include "drivers/scip/scip_parser.hpp"

namespace crspf {

/// Values that are no distances mean different things in different families.
enum class ScipFamily : std::uint8_t { kUrg, kUtm, kUst };

/// The reply to PP. Steps are counted counter-clockwise.
struct ScipSensor {
    std::array<char, 64> model{};  ///< MODL, ends with 0
    std::uint32_t dmin_mm = 0;     ///< DMIN
    std::uint32_t dmax_mm = 0;     ///< DMAX
    std::uint32_t ares = 0;        ///< steps of a whole turn
    std::uint32_t amin = 0;        ///< first step that measures
    std::uint32_t amax = 0;        ///< last step that measures
    std::uint32_t afrt = 0;        ///< step that looks forward
    std::uint32_t scan_rpm = 0;    ///< SCAN
    ScipFamily family{};           ///< from MODL

    [[nodiscard]] constexpr double period_s() const { return 60.0 / scan_rpm; }
    [[nodiscard]] constexpr double step_s() const { return period_s() / ares; }
};

/// What the replies to VV and II tell besides; texts end with 0.
struct ScipIdentity {
    std::array<char, 32> serial{};     ///< SERI
    std::array<char, 48> firmware{};   ///< FIRM
    std::array<char, 64> diagnosis{};  ///< STAT: how the sensor says it is
};

/// Takes over what `body`, of VV or II, tells.
void read_identity(Bytes body, ScipIdentity& identity);

/// False where a value is missing or senseless: amin < afrt < amax < 2 ares, DMIN < DMAX, no zero turn or speed.
[[nodiscard]] bool read_sensor(Bytes body, ScipSensor& sensor);

/// Ranges as a Scan without its stamp, which the caller knows. A beam that stands for a cluster lies in its middle. Of
/// the codes, "nothing in range" becomes Beam::kNoReturn; all others, and distances beyond DMIN and DMAX, kInvalid.
/// Wait-free.
void fill_scan(const ScipRanges& ranges, const ScipScanRequest& request, const ScipSensor& sensor, Scan& scan);

/// The sensor's 24 bits of milliseconds, which wrap every 4 h 40 min, as a line without end.
class ScipTimer {
 public:
    /// Stamps must come less than 2 h 20 min apart; an earlier stamp gives an earlier time.
    constexpr Stamp unwrap(std::uint32_t stamp_ms) {
        constexpr std::uint32_t kMask = 0xFFFFFF;
        constexpr std::int64_t kTurn = kMask + std::int64_t{1};
        const std::int64_t step = (stamp_ms - last_ms_) & kMask;
        total_ms_ += step >= kTurn / 2 ? step - kTurn : step;
        last_ms_ = stamp_ms & kMask;
        return {total_ms_ * 1'000'000};
    }

 private:
    std::uint32_t last_ms_ = 0;
    std::int64_t total_ms_ = 0;
};

}  // namespace crspf
