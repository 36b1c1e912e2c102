// Hokuyo's SCIP 2.0 on the wire: characters, check characters, requests, replies (specification C-42-03320B).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/common/byte_writer.hpp"

namespace crspf {

using Bytes = std::span<const std::uint8_t>;

/// The bytes of a literal without its final 0 are `text`.
template <std::size_t N>
[[nodiscard]] constexpr bool is_text(Bytes bytes, const char (&text)[N]) {
    if (bytes.size() != N - 1) {
        return false;
    }
    for (std::size_t i = 0; i < N - 1; ++i) {
        if (bytes[i] != static_cast<std::uint8_t>(text[i])) {
            return false;
        }
    }
    return true;
}
template <std::size_t N>
[[nodiscard]] constexpr bool begins_with(Bytes bytes, const char (&text)[N]) {
    return bytes.size() >= N - 1 && is_text(bytes.first(N - 1), text);
}
template <std::size_t N>
constexpr void put_text(ByteWriter& out, const char (&text)[N]) {
    for (std::size_t i = 0; i < N - 1; ++i) {
        out.byte(static_cast<std::uint8_t>(text[i]));
    }
}
/// `value` in exactly `digits` decimal digits; the higher ones are lost.
void put_decimal(ByteWriter& out, std::uint32_t value, std::size_t digits);

/// Six bits a character, the most significant first, each plus 0x30.
inline constexpr std::uint8_t kScipZero = 0x30;
inline constexpr std::size_t kScipLineChars = 64;

[[nodiscard]] constexpr bool is_scip_char(std::uint8_t c) {
    return c >= kScipZero && c < kScipZero + 64;
}
/// Characters outside of the alphabet give nonsense; ask is_scip_char() before.
[[nodiscard]] constexpr std::uint32_t scip_decode(Bytes chars) {
    std::uint32_t value = 0;
    for (const std::uint8_t c : chars) {
        value = (value << 6U) | ((c - kScipZero) & 0x3FU);
    }
    return value;
}
void scip_encode(ByteWriter& out, std::uint32_t value, std::size_t chars);

/// The check character of a line.
[[nodiscard]] constexpr std::uint8_t scip_sum(Bytes bytes) {
    std::uint32_t sum = 0;
    for (const std::uint8_t c : bytes) {
        sum += c;
    }
    return static_cast<std::uint8_t>((sum & 0x3FU) + kScipZero);
}
/// The line, without its line feed, ends with the check character of what stands before.
[[nodiscard]] bool scip_line_ok(Bytes line);
/// The same for a line `KEY:value;S` of VV, PP and II: sensors leave out the ';', some also the comment from "<-" on.
[[nodiscard]] bool scip_text_line_ok(Bytes line);

/// What the letters of a request for scans ask for.
enum class ScipEncoding : std::uint8_t {
    kThreeChars,     ///< MD, GD: 18 bits, [mm]
    kTwoChars,       ///< MS, GS: 12 bits, at most 4095 mm
    kWithIntensity,  ///< ME, GE: three characters of range and three of intensity a beam
};
[[nodiscard]] constexpr std::size_t scip_chars(ScipEncoding encoding) {
    return encoding == ScipEncoding::kTwoChars ? 2 : encoding == ScipEncoding::kThreeChars ? 3 : 6;
}

/// A request for scans.
struct ScipScanRequest {
    ScipEncoding encoding = ScipEncoding::kThreeChars;
    bool continuous = true;     ///< M: a stream of scans; G: the latest one
    std::uint32_t start = 0;    ///< step of the first beam
    std::uint32_t end = 0;      ///< step of the last beam
    std::uint32_t cluster = 1;  ///< steps to a beam, of which the nearest counts; 0 is 1
    std::uint32_t skip = 0;     ///< revolutions between scans, 0-9; M only
    std::uint32_t count = 0;    ///< scans, 1-99; 0 until QT; M only

    [[nodiscard]] constexpr std::uint32_t cluster_steps() const { return cluster == 0 ? 1 : cluster; }
    [[nodiscard]] constexpr std::uint32_t beams() const { return (end - start) / cluster_steps() + 1; }
    friend constexpr bool operator==(const ScipScanRequest&, const ScipScanRequest&) = default;
};
/// The request without its line feed.
void put_request(ByteWriter& out, const ScipScanRequest& request);
/// Reads what put_request() writes, with or without a `;string`. False where it is something else.
[[nodiscard]] bool read_request(Bytes line, ScipScanRequest& request);

/// Status line of a reply.
void put_status(ByteWriter& out, Bytes two_chars);
/// A line `KEY:value;S`; `text` ends before the ';'.
void put_text_line(ByteWriter& out, Bytes text);
/// Lines of 64 characters with their check characters; `chars` is the whole payload.
void put_payload(ByteWriter& out, Bytes chars);

/// What a status means, for a human: of a request for scans or, else, of any other command.
[[nodiscard]] const char* scip_status_text(Bytes two_chars, bool of_scans);

}  // namespace crspf
