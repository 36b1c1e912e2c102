// What a SCIP sensor says, understood by listening only: its geometry, its clock, its scans. The live session speaks
// through one of these and a replay has nothing else, so the same bytes give the same scans in both.
#pragma once

#include <cstdint>

#include "core/base/samples.hpp"
#include "drivers/common/clock_estimator.hpp"
#include "drivers/scip/scip_parser.hpp"
#include "drivers/scip/scip_sensor.hpp"

namespace crspf {

/// Never reset.
struct ScipListenerCounters {
    std::uint64_t scans = 0;
    std::uint64_t lost_scans = 0;      ///< that the sensor's stamps tell of: a gap in its revolutions
    std::uint64_t bad_scans = 0;       ///< right check characters, yet not the values that were asked for
    std::uint64_t bad_stamps = 0;      ///< dropped: the sensor's time fits neither the scan before nor the host's
    std::uint64_t clock_jumps = 0;     ///< the sensor's time moved for good
    std::uint64_t stuck_stamps = 0;    ///< dropped: the stamp of the scan before
    std::uint64_t unknown_sensor = 0;  ///< scans before any reply to PP: their angles are not known
};

/// Scans are valid during the call only. No heap, wait-free; about 80 KiB, so keep it out of small stacks.
class ScipListener {
 public:
    /// The port was opened anew: what was heard of a reply before is no part of one.
    void on_open() { parser_.clear(); }
    /// The host sent something. `now`: just before, as exactly as it can tell; half of what it is off shifts all
    /// stamps.
    void on_sent(Stamp now) { asked_ = now; }
    /// Calls visit(const ScipReply&, const Scan*) for each reply; the scan is nullptr where the reply gives none.
    template <typename Visit>
    void on_bytes(Bytes bytes, Stamp received, Visit&& visit) {
        parser_.feed(bytes, received, [&](const ScipReply& reply) { visit(reply, on_reply(reply)); });
    }

    /// Of the last PP; ares is 0 before the first, and after one that could not be read.
    [[nodiscard]] const ScipSensor& sensor() const { return sensor_; }
    /// Of the last VV and II; empty before them.
    [[nodiscard]] const ScipIdentity& identity() const { return identity_; }
    /// Raw values behind the scan that is visited.
    [[nodiscard]] const ScipRanges& ranges() const { return ranges_; }
    /// Replies to TM1 since the last PP or TM0.
    [[nodiscard]] int timer_reads() const { return timer_reads_; }
    /// The sensor sends scans, but its time stands still.
    [[nodiscard]] bool stuck() const;
    [[nodiscard]] const ScipListenerCounters& counters() const { return counters_; }
    [[nodiscard]] const ScipParserCounters& parser_counters() const { return parser_.counters(); }

 private:
    const Scan* on_reply(const ScipReply& reply);
    void on_parameters(const ScipReply& reply);
    void on_timer(const ScipReply& reply);
    const Scan* on_scan(const ScipReply& reply, const ScipScanRequest& request);
    void begin_scans(const ScipScanRequest& request);
    bool stamp_ok(Stamp received);
    void stamp_scan(Stamp received);

    ScipParser parser_;
    ScipSensor sensor_;
    ScipIdentity identity_;
    ScipScanRequest request_;
    ScipRanges ranges_;
    Scan scan_;
    bool asked_for_scans_ = false;
    bool first_ = true;

    // Bounds of host - device that the replies to TM1 leave, in ns; when that was, on the sensor's line; and what a
    // scan takes at least from its end to the host.
    Stamp asked_;
    std::int64_t offset_low_ns_ = 0;
    std::int64_t offset_high_ns_ = 0;
    int timer_reads_ = 0;
    bool synchronised_ = false;
    Stamp synchronised_at_;
    Duration scan_delay_;
    ScipTimer timer_;
    ClockEstimator clock_;

    std::uint32_t accepted_ms_ = 0;  // stamp of the last scan that was taken, and its reception
    Stamp accepted_at_;
    std::uint32_t doubted_ms_ = 0;  // the same of the last that was not
    Stamp doubted_at_;
    bool doubted_ = false;
    int repeated_ = 0;

    ScipListenerCounters counters_;
};

}  // namespace crspf
