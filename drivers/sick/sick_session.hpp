// The conversation with an LMS1xx, LMS5xx, TiM5xx or TiM7xx: find its dialect, log in, configure, start, wait until it
// is ready, subscribe, and begin again whenever it falls silent. It never gives up; it never reopens in a hurry.
//
//     session.on_open(now);                         the port stands
//     session.on_bytes(bytes, received, visit);     visit(const LmdScandata&, const SickTiming&) for each scan
//     session.on_time(now);                         at least every 50 ms
//     session.next_output(now)                      until kNothing: what is to be done with the port
//     session.on_closed(now);                       the port failed, or could not be opened
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/time.hpp"
#include "drivers/sick/sick_listener.hpp"
#include "drivers/sick/sick_params.hpp"

namespace crspf {

enum class SickState : std::uint8_t {
    kClosed,  ///< waits until it is time to open the port again
    kLogin,   ///< tries either dialect in turn until something answers
    kSwitchDialect,
    kConfigureScan,
    kConfigureOutput,
    kStartMeasuring,
    kWaitReady,
    kRun,
    kSubscribe,
    kStreaming,
    kStopped,
};

/// What the session wants done.
struct SickOutput {
    enum class Kind : std::uint8_t {
        kNothing,
        kSend,    ///< send `bytes`
        kReopen,  ///< close the port, open it again, then on_open or on_closed
    };
    Kind kind = Kind::kNothing;
    std::span<const std::uint8_t> bytes;  ///< valid until the next call
};

struct SickSessionCounters {
    std::uint64_t reopened = 0;
    std::uint64_t refused = 0;      ///< commands that the sensor refused; see last_refusal()
    std::uint64_t repeated = 0;     ///< commands sent again because no answer came
    std::uint64_t silences = 0;     ///< streams that stopped
    std::uint64_t passed_over = 0;  ///< telegrams that nobody asked for
};

/// The last command that the sensor refused. A refusal does not end the conversation: a TiM knows no STlms, and a scan
/// tells its own geometry whether or not ours was taken.
struct SickRefusal {
    SickCommand command = SickCommand::kLogin;
    std::uint16_t number = 0;   ///< of sFA; 0 where the sensor said no without a number
    const char* text = "none";  ///< for people
};

/// Wait-free.
class SickSession {
 public:
    explicit SickSession(const SickParams& params);

    void on_open(Stamp now);
    void on_closed(Stamp now);
    void on_time(Stamp now);

    template <typename Visit>
    void on_bytes(std::span<const std::uint8_t> bytes, Stamp received, Visit&& visit) {
        listener_.on_bytes(bytes, received,
                           [&](const ColaTelegram& telegram, Stamp stamp, const std::optional<SickTiming>& timing) {
                               if (timing) {
                                   visit(listener_.data(), *timing);
                               }
                               on_telegram(telegram, timing.has_value(), stamp);
                           });
    }

    [[nodiscard]] SickOutput next_output(Stamp now);

    /// Ends the stream: send what next_output() then gives, and close the port. For good, until on_open().
    void stop();

    [[nodiscard]] SickState state() const { return state_; }
    [[nodiscard]] ColaDialect dialect() const { return dialect_; }
    [[nodiscard]] const SickRefusal& last_refusal() const { return refusal_; }
    [[nodiscard]] const SickSessionCounters& counters() const { return counters_; }
    [[nodiscard]] const SickListener& listener() const { return listener_; }

 private:
    void on_telegram(const ColaTelegram& telegram, bool scan, Stamp received);
    void on_reply(const ColaTelegram& reply, Stamp now);
    [[nodiscard]] SickCommand command() const;
    void enter(SickState state, Stamp now);
    void advance(Stamp now);
    void send(Stamp now);
    void close(Stamp now);

    SickParams params_;
    SickListener listener_;
    std::uint64_t decoded_before_ = 0;  // of the listener
    SickState state_ = SickState::kClosed;
    ColaDialect dialect_;
    bool switched_ = false;  // once: a sensor that acknowledges and does not switch must not be asked for ever
    Stamp opened_;
    Stamp heard_;  // last telegram
    Stamp sent_;
    Stamp reopen_at_;
    bool wants_reopen_ = false;
    bool polling_ = false;  // STlms answered "not yet": the next one waits for its turn
    Duration back_off_{};
    std::array<std::uint8_t, kLargestColaCommand> out_{};
    std::size_t out_size_ = 0;
    SickRefusal refusal_;
    SickSessionCounters counters_;
};

}  // namespace crspf
