// A serial stream -> telegrams and acknowledgements of an LMS2xx, either direction.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/time.hpp"
#include "drivers/common/stream_buffer.hpp"
#include "drivers/sick/lms2xx_codec.hpp"

namespace crspf {

/// Views the parser's buffer.
struct Lms2xxMessage {
    enum class Kind : std::uint8_t { kTelegram, kAck, kNack };
    Kind kind = Kind::kTelegram;
    std::uint8_t address = 0;
    std::span<const std::uint8_t> payload;  ///< of a telegram: command, data; at least one byte
};

struct Lms2xxCounters {
    std::uint64_t telegrams = 0;
    std::uint64_t bytes_skipped = 0;
    std::uint64_t bad_sums = 0;
    std::uint64_t broken_off = 0;  ///< given up because the line was silent in the middle of a telegram
};

/// Wait-free.
class Lms2xxParser {
 public:
    /// Calls visit(const Lms2xxMessage&, Stamp received) for each message. It is valid during the call.
    template <typename Visit>
    void feed(std::span<const std::uint8_t> bytes, Stamp received, Visit&& visit) {
        Lms2xxMessage message;
        if (!buffer_.pending().empty() && received - last_ > kByteTimeout) {
            ++counters_.broken_off;
            drop(1);
            while (next(message)) {
                visit(message, received);
            }
        }
        last_ = received;
        while (!bytes.empty()) {
            bytes = bytes.subspan(buffer_.append(bytes));
            while (next(message)) {
                visit(message, received);
            }
        }
    }

    void reset();
    [[nodiscard]] const Lms2xxCounters& counters() const { return counters_; }

 private:
    // The sensor leaves at most 35 ms between bytes of a telegram; a driver hands over in larger pieces.
    static constexpr Duration kByteTimeout{100'000'000};

    bool next(Lms2xxMessage& message);
    void drop(std::size_t n);

    StreamBuffer<2 * kLargestLms2xxTelegram> buffer_;
    Stamp last_;
    Lms2xxCounters counters_;
};

}  // namespace crspf
