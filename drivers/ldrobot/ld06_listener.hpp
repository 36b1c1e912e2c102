// What an LD06 says, understood by listening only, which is all there is to it: whole revolutions as scans.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "config/capacities.hpp"
#include "core/base/samples.hpp"
#include "core/base/time.hpp"
#include "drivers/common/clock_estimator.hpp"
#include "drivers/ldrobot/ld06_parser.hpp"

namespace crspf {

/// Never reset.
struct Ld06Counters {
    std::uint64_t scans = 0;
    std::uint64_t bad_scans = 0;      ///< dropped: half a turn of it was lost, or 30 degrees at an end
    std::uint64_t lost_readings = 0;  ///< gaps in the scans: their beams are invalid
    std::uint64_t ran_back = 0;       ///< readings dropped: at an angle that had been passed
};

/// A scan is a revolution from the sensor's rear to its rear. Its readings are laid on beams of one width, the mean of
/// what the revolution's packets say: a reading is told where it was to half of that. Stamps: the sensor's clock counts
/// whole milliseconds, so a scan's is up to one too early. Scans are valid during the call only. No heap, wait-free; 45
/// KiB.
class Ld06Listener {
 public:
    /// The port was opened anew.
    void on_open();

    /// Calls visit(const Scan&) for each revolution.
    template <typename Visit>
    void on_bytes(std::span<const std::uint8_t> bytes, Stamp received, Visit&& visit) {
        parser_.feed(bytes, received, [&](const Ld06Packet& packet, Stamp stamp) {
            if (on_packet(packet, stamp)) {
                visit(scan_);
            }
        });
    }

    [[nodiscard]] const Ld06Counters& counters() const { return counters_; }
    [[nodiscard]] const Ld06ParserCounters& parser_counters() const { return parser_.counters(); }

 private:
    struct Reading {
        int angle = 0;  ///< [1/1100 degree] clockwise from the front, -180 to 180 degrees
        std::uint16_t range_mm = 0;
    };

    bool on_packet(const Ld06Packet& packet, Stamp received);
    [[nodiscard]] Stamp when_sent(const Ld06Packet& packet, Stamp received);
    bool finish();

    Ld06Parser parser_;
    ClockEstimator clock_;
    bool heard_ = false;  ///< a packet, of which there are:
    Stamp received_;
    Stamp device_;               ///< the sensor's clock without its wraps
    std::uint16_t time_ms_ = 0;  ///< the same as it says it
    int angle_ = 0;              ///< of its last reading

    bool begun_ = false;  ///< the rear has been passed: what comes belongs to a whole revolution
    std::array<Reading, capacity::kBeams> readings_{};  ///< of the one under way
    std::size_t count_ = 0;
    Stamp newest_;               ///< when the last of them was measured
    double steps_ = 0.0;         ///< sum over them of the angle to the next
    double speeds_degps_ = 0.0;  ///< the same of the speed

    Scan scan_;
    Ld06Counters counters_;
};

}  // namespace crspf
