// What a SICK lidar on TCP says, understood by listening only. The live session speaks through one of these and a
// replay has nothing else, so the same bytes give the same scans in both.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/base/time.hpp"
#include "drivers/sick/cola_parser.hpp"
#include "drivers/sick/lmd_scandata.hpp"
#include "drivers/sick/sick_scan.hpp"

namespace crspf {

/// Wait-free.
class SickListener {
 public:
    /// The port was opened anew: the next scan follows from nothing.
    void on_open();

    /// Calls visit(const ColaTelegram&, Stamp received, const std::optional<SickTiming>&) for each telegram; the timing
    /// is that of the scan in data(), none where the telegram gives no scan.
    template <typename Visit>
    void on_bytes(std::span<const std::uint8_t> bytes, Stamp received, Visit&& visit) {
        parser_.feed(bytes, received, [&](const ColaTelegram& telegram, Stamp stamp) {
            visit(telegram, stamp, on_telegram(telegram, stamp));
        });
    }

    [[nodiscard]] const LmdScandata& data() const { return data_; }
    /// From a telegram to the next, as the last two say; 0 where there were none. [s]
    [[nodiscard]] double period_s() const { return sequence_.period_s(); }
    /// Scan telegrams whose structure holds, and those whose does not. Never reset.
    [[nodiscard]] std::uint64_t decoded() const { return decoded_; }
    [[nodiscard]] std::uint64_t undecodable() const { return undecodable_; }
    [[nodiscard]] const ColaCounters& parser_counters() const { return parser_.counters(); }
    [[nodiscard]] const SickSequenceCounters& sequence_counters() const { return sequence_.counters(); }

 private:
    std::optional<SickTiming> on_telegram(const ColaTelegram& telegram, Stamp received);

    ColaParser parser_;
    LmdScandata data_;
    SickSequence sequence_;
    std::uint64_t decoded_ = 0;
    std::uint64_t undecodable_ = 0;
};

}  // namespace crspf
