// The conversation with a SCIP sensor, from an unknown state to a stream of scans and back again after every failure.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/samples.hpp"
#include "drivers/common/backoff.hpp"
#include "drivers/scip/scip_listener.hpp"
#include "drivers/scip/scip_params.hpp"

namespace crspf {

/// Never reset.
struct ScipCounters {
    std::uint64_t trouble = 0;    ///< status 21-49 and 50-97 while streaming
    std::uint64_t laser_off = 0;  ///< status 10 while streaming
    std::uint64_t silences = 0;   ///< nothing for three scan periods
    std::uint64_t timeouts = 0;   ///< of commands
    std::uint64_t refused = 0;    ///< commands that a sensor refused, so that we gave up
    std::uint64_t failures = 0;   ///< attempts and streams that ended; each is followed by another attempt
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
        listener_.on_bytes(bytes, received, [&](const ScipReply& reply, const Scan* scan) {
            if (scan != nullptr) {
                visit(*scan);
            }
            on_reply(reply, scan != nullptr, received);
        });
    }

    [[nodiscard]] bool wants_port() const { return state_ == State::kOpening; }
    [[nodiscard]] std::uint32_t baud() const { return baud_; }
    [[nodiscard]] Bytes to_send() const { return Bytes(out_).first(out_size_); }
    /// `now`: just before it was sent, as ScipListener::on_sent() has it.
    void sent(Stamp now) {
        if (out_size_ > 0) {
            listener_.on_sent(now);
            out_size_ = 0;
        }
    }

    [[nodiscard]] bool streaming() const { return state_ == State::kStream; }
    [[nodiscard]] const ScipListener& listener() const { return listener_; }
    [[nodiscard]] const ScipScanRequest& request() const { return request_; }
    [[nodiscard]] const ScipCounters& counters() const { return counters_; }
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
        kVersion,      // VV
        kParameters,   // PP
        kAdjust,       // TM0
        kReadTimer,    // TM1, several times
        kEndAdjust,    // TM2
        kLaser,        // BM
        kStart,        // MD, MS, ME
        kStream,
        kDiagnose,  // II, after a refusal or trouble; then another attempt
    };

    void enter(State state, Stamp now);
    void send_command(Stamp now);
    void fail(Stamp now);
    void refuse(Bytes status, Stamp now);
    void time_out(Stamp now);
    void next_baud(Stamp now);
    void on_reply(const ScipReply& reply, bool scan, Stamp now);
    void on_probe(const ScipReply& reply, Stamp now);
    void on_stream(const ScipReply& reply, bool scan, Stamp now);

    ScipParams params_;
    State state_ = State::kOpening;
    Stamp deadline_;
    int tries_ = 0;
    Backoff backoff_{{100'000'000}, {2'000'000'000}};
    std::uint32_t baud_ = 0;
    std::size_t candidate_ = 0;
    std::array<std::uint8_t, 32> out_{};
    std::size_t out_size_ = 0;
    ScipListener listener_;
    ScipScanRequest request_;
    std::uint64_t replies_at_entry_ = 0;
    Stamp heard_;
    Stamp last_scan_;    // host time of the last good one
    bool first_ = true;  // none came yet

    const char* trouble_ = "none";
    ScipCounters counters_;
};

}  // namespace crspf
