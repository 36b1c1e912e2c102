// A serial stream -> packets of an LD06.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/time.hpp"
#include "drivers/common/stream_buffer.hpp"
#include "drivers/ldrobot/ld06_codec.hpp"

namespace crspf {

/// Never reset.
struct Ld06ParserCounters {
    std::uint64_t packets = 0;
    std::uint64_t bad_sum = 0;
    std::uint64_t implausible = 0;    ///< right sums, yet not what such a sensor says
    std::uint64_t bytes_dropped = 0;  ///< outside of packets, those of bad ones included
};

/// Wait-free.
class Ld06Parser {
 public:
    /// Calls visit(const Ld06Packet&, Stamp received) for each packet.
    template <typename Visit>
    void feed(std::span<const std::uint8_t> bytes, Stamp received, Visit&& visit) {
        Ld06Packet packet;
        while (!bytes.empty()) {
            bytes = bytes.subspan(buffer_.append(bytes));
            while (next(packet)) {
                visit(packet, received);
            }
        }
    }

    void clear();
    [[nodiscard]] const Ld06ParserCounters& counters() const { return counters_; }

 private:
    bool next(Ld06Packet& packet);
    void drop(std::size_t n);

    StreamBuffer<4 * kLd06Bytes> buffer_;
    Ld06ParserCounters counters_;
};

}  // namespace crspf
