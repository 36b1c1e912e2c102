// The conversation with an LMS2xx: find its speed, quiet it, set variant and speed, stream, and begin again whenever it
// falls silent. Calls as in sick_session.hpp; the port's speed is set on demand.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/time.hpp"
#include "drivers/sick/lms2xx_listener.hpp"
#include "drivers/sick/lms2xx_params.hpp"

namespace crspf {

enum class Lms2xxState : std::uint8_t { kClosed, kFindBaud, kQuiet, kVariant, kSetBaud, kStream, kStreaming, kStopped };

struct Lms2xxOutput {
    enum class Kind : std::uint8_t {
        kNothing,
        kSetBaud,  ///< set the port to `baud`, drop what it received
        kSend,     ///< send `bytes`
        kReopen,   ///< close the port, open it again, then on_open or on_closed
    };
    Kind kind = Kind::kNothing;
    std::uint32_t baud = 0;
    std::span<const std::uint8_t> bytes;  ///< valid until the next call
};

struct Lms2xxSessionCounters {
    std::uint64_t reopened = 0;
    std::uint64_t refused = 0;   ///< NACKs, and replies that say no
    std::uint64_t repeated = 0;  ///< commands sent again because no answer came
    std::uint64_t silences = 0;  ///< streams that stopped
};

/// Wait-free.
class Lms2xxSession {
 public:
    explicit Lms2xxSession(const Lms2xxParams& params) : params_(params), listener_(params) {}

    void on_open(Stamp now);
    void on_closed(Stamp now);
    void on_time(Stamp now);

    /// visit(const Lms2xxScan&, Stamp beam0) for each scan.
    template <typename Visit>
    void on_bytes(std::span<const std::uint8_t> bytes, Stamp received, Visit&& visit) {
        listener_.on_bytes(bytes, received, [&](const Lms2xxMessage& message, Stamp stamp, bool scan) {
            if (scan) {
                visit(listener_.scan(), listener_.beam0(stamp));
            }
            on_message(message, scan, stamp);
        });
    }

    [[nodiscard]] Lms2xxOutput next_output(Stamp now);

    /// Ends the stream: send what next_output() then gives, and close the port. For good, until on_open().
    void stop();

    [[nodiscard]] Lms2xxState state() const { return state_; }
    [[nodiscard]] std::uint32_t baud() const { return baud_; }
    [[nodiscard]] const Lms2xxSessionCounters& counters() const { return counters_; }
    [[nodiscard]] const Lms2xxListener& listener() const { return listener_; }

 private:
    void on_message(const Lms2xxMessage& message, bool scan, Stamp now);
    void on_reply(std::span<const std::uint8_t> payload, Stamp now);
    [[nodiscard]] Duration silence() const;
    void enter(Lms2xxState state, Stamp now);
    void send(Stamp now);
    void set_baud(std::uint32_t baud);
    void close(Stamp now);

    Lms2xxParams params_;
    Lms2xxListener listener_;
    Lms2xxState state_ = Lms2xxState::kClosed;
    std::uint32_t baud_ = 0;
    std::size_t candidate_ = 0;  // index of the speed that is tried
    int attempts_ = 0;
    bool baud_wanted_ = false;
    bool wants_reopen_ = false;
    Stamp opened_;
    Stamp heard_;
    Stamp sent_;
    Stamp reopen_at_;
    Duration back_off_{};
    std::array<std::uint8_t, 32> out_{};
    std::size_t out_size_ = 0;
    Lms2xxSessionCounters counters_;
};

}  // namespace crspf
