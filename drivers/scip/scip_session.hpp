// The conversation with a SCIP sensor, from an unknown state to a stream of scans and back again after every failure.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/samples.hpp"
#include "drivers/common/backoff.hpp"
#include "drivers/common/clock_estimator.hpp"
#include "drivers/scip/scip_params.hpp"
#include "drivers/scip/scip_parser.hpp"
#include "drivers/scip/scip_sensor.hpp"

namespace crspf {

/// Never reset.
struct ScipCounters {
    std::uint64_t scans = 0;
    std::uint64_t lost_scans = 0;    ///< that the sensor's stamps tell of: a gap in its revolutions
    std::uint64_t bad_scans = 0;     ///< right check characters, yet not the values that were asked for
    std::uint64_t bad_stamps = 0;    ///< dropped: the sensor's time fits neither the scan before nor the host's
    std::uint64_t clock_jumps = 0;   ///< the sensor's time moved for good
    std::uint64_t stuck_stamps = 0;  ///< dropped: the stamp of the scan before
    std::uint64_t trouble = 0;       ///< status 21-49 and 50-97 while streaming
    std::uint64_t laser_off = 0;     ///< status 10 while streaming
    std::uint64_t silences = 0;      ///< nothing for three scan periods
    std::uint64_t timeouts = 0;      ///< of commands
    std::uint64_t refused = 0;       ///< commands that a sensor refused, so that we gave up
    std::uint64_t failures = 0;      ///< attempts and streams that ended; each is followed by another attempt
};

/// Who owns the port does, for ever:
///     on_time(now) at least every 10 ms
///     if wants_port(): close it, open it anew; on_open(now) or on_close(now), which is also for a port that was lost
///     if baud() is not 0: have the port run at it, before anything is sent
///     send to_send(), then sent(now)
///     on_bytes(bytes, received, visit(const Scan&))
/// Scans are valid during the call only. Silence is noticed after three scan periods; attempts never end and come at
/// most 2 s apart. No heap, wait-free; about 80 KiB, so keep it out of small stacks.
class ScipSession {
 public:
    explicit ScipSession(const ScipParams& params) : params_(params) {}

    void on_open(Stamp now);
    void on_close(Stamp now) { fail(now); }
    void on_time(Stamp now);
    template <typename Visit>
    void on_bytes(Bytes bytes, Stamp received, Visit&& visit) {
        heard_ = received;
        parser_.feed(bytes, received, [&](const ScipReply& reply) {
            if (on_reply(reply, received)) {
                visit(static_cast<const Scan&>(scan_));
            }
        });
    }

    [[nodiscard]] bool wants_port() const { return state_ == State::kOpening; }
    [[nodiscard]] std::uint32_t baud() const { return baud_; }
    [[nodiscard]] Bytes to_send() const { return Bytes(out_).first(out_size_); }
    /// `now`: just before it was sent, as exactly as the host can tell; half of what it is off shifts all stamps.
    void sent(Stamp now) {
        if (out_size_ > 0) {
            asked_ = now;
            out_size_ = 0;
        }
    }

    [[nodiscard]] bool streaming() const { return state_ == State::kStream; }
    /// Of the last PP; ares is 0 before the first.
    [[nodiscard]] const ScipSensor& sensor() const { return sensor_; }
    [[nodiscard]] const ScipScanRequest& request() const { return request_; }
    /// Raw values behind the scan that is visited.
    [[nodiscard]] const ScipRanges& ranges() const { return ranges_; }
    [[nodiscard]] const ScipCounters& counters() const { return counters_; }
    [[nodiscard]] const ScipParserCounters& parser_counters() const { return parser_.counters(); }
    /// What the last refusal or trouble was, for a human.
    [[nodiscard]] const char* last_trouble() const { return trouble_; }

 private:
    enum class State : std::uint8_t {
        kOpening,      // asks for the port
        kWaiting,      // until deadline_, then asks for it
        kProbe,        // QT, which also silences a sensor that streams
        kScip2,        // SCIP2.0, to a sensor that woke up in SCIP 1.1
        kLeaveAdjust,  // TM2, to one that was left in adjust mode
        kSetBaud,      // SS
        kSettle,       // the sensor changes its bit rate
        kParameters,   // PP
        kAdjust,       // TM0
        kReadTimer,    // TM1, several times
        kEndAdjust,    // TM2
        kLaser,        // BM
        kStart,        // MD, MS, ME
        kStream,
    };

    void enter(State state, Stamp now);
    void send_command(Stamp now);
    void fail(Stamp now);
    void refuse(Bytes status, Stamp now);
    void time_out(Stamp now);
    void next_baud(Stamp now);
    bool on_reply(const ScipReply& reply, Stamp now);
    void on_probe(const ScipReply& reply, Stamp now);
    void on_timer(const ScipReply& reply, Stamp now);
    bool on_stream(const ScipReply& reply, Stamp now);
    bool on_scan(const ScipReply& reply, Stamp now);
    bool stamp_ok(Stamp received, Stamp now);
    void stamp_scan(Stamp received);

    ScipParams params_;
    State state_ = State::kOpening;
    Stamp deadline_;
    int tries_ = 0;
    Backoff backoff_{{100'000'000}, {2'000'000'000}};
    std::uint32_t baud_ = 0;
    std::size_t candidate_ = 0;
    std::array<std::uint8_t, 32> out_{};
    std::size_t out_size_ = 0;
    ScipParser parser_;
    std::uint64_t replies_at_entry_ = 0;
    Stamp heard_;

    ScipSensor sensor_;
    ScipScanRequest request_;
    ScipRanges ranges_;
    Scan scan_;
    Stamp last_scan_;  // host time of the last good one
    bool first_ = true;

    // Bounds of host - device that the replies to TM1 leave, in ns; then what a scan takes from its end to the host.
    Stamp asked_;
    std::int64_t offset_low_ns_ = 0;
    std::int64_t offset_high_ns_ = 0;
    int timer_reads_ = 0;
    int calibrating_ = 0;
    Duration scan_delay_;
    ScipTimer timer_;
    ClockEstimator clock_;

    std::uint32_t accepted_ms_ = 0;  // stamp of the last scan that was taken, and its reception
    Stamp accepted_at_;
    std::uint32_t doubted_ms_ = 0;  // the same of the last that was not
    Stamp doubted_at_;
    bool doubted_ = false;
    int repeated_ = 0;

    const char* trouble_ = "none";
    ScipCounters counters_;
};

}  // namespace crspf
