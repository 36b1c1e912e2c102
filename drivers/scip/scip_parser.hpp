// A stream of bytes from a SCIP sensor -> replies, and their payloads.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "config/capacities.hpp"
#include "core/base/time.hpp"
#include "drivers/scip/scip_codec.hpp"

namespace crspf {

/// A reply whose check characters are right. Valid during the call only.
struct ScipReply {
    Bytes echo;      ///< the request, with its string
    Bytes status;    ///< two characters; one from a sensor that speaks SCIP 1.1, whose lines have no check characters
    Bytes body;      ///< the lines after the status, with check characters and line feeds
    Stamp received;  ///< of the reply's first byte

    [[nodiscard]] bool scip1() const { return status.size() == 1; }
};

/// Never reset.
struct ScipParserCounters {
    std::uint64_t replies = 0;
    std::uint64_t bad_sum = 0;        ///< blocks dropped because a line's check character was wrong
    std::uint64_t bad_shape = 0;      ///< blocks dropped because they were no reply
    std::uint64_t overflow = 0;       ///< blocks longer than any reply
    std::uint64_t bytes_dropped = 0;  ///< of all of these
};

/// Splits at the blank line that ends every reply. What is no reply, or has a wrong check character, is dropped up to
/// the next blank line; where a blank line was lost, the whole reply behind it is still found. No heap, wait-free.
class ScipParser {
 public:
    template <typename Visit>
    void feed(Bytes bytes, Stamp received, Visit&& visit) {
        for (const std::uint8_t c : bytes) {
            if (push(c, received)) {
                ScipReply reply;
                if (take(reply)) {
                    visit(static_cast<const ScipReply&>(reply));
                }
                size_ = 0;
            }
        }
    }
    /// Forgets the beginning of a reply, where the port was opened anew.
    void clear() { size_ = 0; }
    [[nodiscard]] const ScipParserCounters& counters() const { return counters_; }

 private:
    // The largest reply: two times three characters a beam, a check character and a line feed for each 64 of them.
    static constexpr std::size_t kBytes = capacity::kBeams * 6 * 66 / 64 + 128;

    bool push(std::uint8_t c, Stamp received);  // true where a block is complete
    bool take(ScipReply& reply);

    std::array<std::uint8_t, kBytes> buffer_{};
    std::size_t size_ = 0;
    bool skipping_ = false;  // an overflow: up to the next blank line
    std::uint8_t last_ = 0;
    Stamp received_;
    ScipParserCounters counters_;
};

/// The value of `KEY:value;S` in the body of VV, PP or II; empty where there is none. `key` with its colon.
[[nodiscard]] Bytes scip_text_value(Bytes body, Bytes key);

/// The payload of a scan.
struct ScipRanges {
    std::uint32_t stamp_ms = 0;  ///< 24 bits of the sensor's timer when it passed step 0
    std::uint32_t count = 0;
    std::array<std::uint32_t, capacity::kBeams> range_mm{};   ///< or a code, see scip_sensor.hpp
    std::array<std::uint32_t, capacity::kBeams> intensity{};  ///< ScipEncoding::kWithIntensity only
};

/// The body of a reply that carries a scan, whose lines' check characters are right already. False where it has not
/// exactly the lines, their lengths and the values that `request` asks for, or holds a character that is none of
/// SCIP's or a range beyond 65535, which is farther than any of these sensors or their codes reach. Wait-free.
[[nodiscard]] bool decode_scan(Bytes body, const ScipScanRequest& request, ScipRanges& out);

}  // namespace crspf
