// A stream of bytes -> telegrams of either dialect. A length or a sum that does not hold costs one byte, then the
// search goes on; a telegram that broke off is given up as soon as the next one's header shows, so that nothing waits
// for bytes that will not come.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/time.hpp"
#include "drivers/common/stream_buffer.hpp"
#include "drivers/sick/cola_codec.hpp"

namespace crspf {

struct ColaCounters {
    std::uint64_t telegrams = 0;
    std::uint64_t bytes_skipped = 0;   ///< outside whole telegrams, for whatever reason
    std::uint64_t bad_sums = 0;        ///< CoLa-B whose XOR did not hold
    std::uint64_t broken_off = 0;      ///< CoLa-B given up because the next header came first
    std::uint64_t bad_characters = 0;  ///< CoLa-A with a control character inside, or without an end
};

/// Wait-free; a byte is looked at a bounded number of times in a stream of sound telegrams.
class ColaParser {
 public:
    /// Calls visit(const ColaTelegram&, Stamp received) for each whole telegram. The telegram is valid during the call.
    template <typename Visit>
    void feed(std::span<const std::uint8_t> bytes, Stamp received, Visit&& visit) {
        while (!bytes.empty()) {
            bytes = bytes.subspan(buffer_.append(bytes));
            ColaTelegram telegram;
            while (next(telegram)) {
                visit(telegram, received);
            }
        }
    }

    /// Forgets what was begun: for a new connection.
    void reset();

    [[nodiscard]] const ColaCounters& counters() const { return counters_; }

 private:
    enum class Step : std::uint8_t { kTelegram, kDropped, kNeedMore };

    bool next(ColaTelegram& telegram);
    Step ascii(std::span<const std::uint8_t> pending, ColaTelegram& telegram);
    Step binary(std::span<const std::uint8_t> pending, ColaTelegram& telegram);
    Step drop(std::size_t n);

    StreamBuffer<kLargestColaPayload + kColaFrame> buffer_;
    std::size_t looked_at_ = 0;  // pending bytes that hold neither an end nor another header
    ColaCounters counters_;
};

}  // namespace crspf
