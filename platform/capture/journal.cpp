#include "platform/capture/journal.hpp"

#include <bit>
#include <cmath>

namespace crspf {

namespace {

constexpr std::uint8_t kVersion = 2;
constexpr std::size_t kTilesAt = 4;
constexpr std::size_t kNumbersAt = 8;
constexpr std::size_t kNumbers = 6;

}  // namespace

std::array<std::uint8_t, kJournalBytes> encode(const JournalEntry& entry) {
    std::array<std::uint8_t, kJournalBytes> bytes{kVersion, static_cast<std::uint8_t>(entry.kind),
                                                  static_cast<std::uint8_t>(entry.updated ? 1 : 0),
                                                  static_cast<std::uint8_t>(entry.tidy ? 1 : 0)};
    for (std::size_t i = kTilesAt; i < kNumbersAt; ++i) {
        bytes[i] = static_cast<std::uint8_t>(entry.tiles >> (8 * (i - kTilesAt)));
    }
    const std::array<std::uint64_t, kNumbers> numbers{entry.motions,
                                                      entry.scan,
                                                      entry.changes,
                                                      std::bit_cast<std::uint64_t>(entry.P_map_base.x_m),
                                                      std::bit_cast<std::uint64_t>(entry.P_map_base.y_m),
                                                      std::bit_cast<std::uint64_t>(entry.P_map_base.theta_rad)};
    std::size_t at = kNumbersAt;
    for (const std::uint64_t number : numbers) {
        for (unsigned shift = 0; shift < 64; shift += 8) {
            bytes[at++] = static_cast<std::uint8_t>(number >> shift);
        }
    }
    return bytes;
}

std::optional<JournalEntry> decode_journal(std::span<const std::uint8_t> bytes) {
    if (bytes.size() != kJournalBytes || bytes[0] != kVersion || bytes[1] > 1 || bytes[2] > 1 || bytes[3] > 1) {
        return std::nullopt;
    }
    std::uint32_t tiles = 0;
    for (std::size_t i = kTilesAt; i < kNumbersAt; ++i) {
        tiles |= std::uint32_t{bytes[i]} << (8 * (i - kTilesAt));
    }
    std::array<std::uint64_t, kNumbers> numbers{};
    for (std::size_t i = 0; i < kNumbers; ++i) {
        for (std::size_t k = 0; k < 8; ++k) {
            numbers[i] |= std::uint64_t{bytes[kNumbersAt + 8 * i + k]} << (8 * k);
        }
    }
    const JournalEntry entry{.kind = static_cast<JournalEntry::Kind>(bytes[1]),
                             .updated = bytes[2] == 1,
                             .tidy = bytes[3] == 1,
                             .motions = numbers[0],
                             .scan = numbers[1],
                             .changes = numbers[2],
                             .tiles = tiles,
                             .P_map_base = {.x_m = std::bit_cast<double>(numbers[3]),
                                            .y_m = std::bit_cast<double>(numbers[4]),
                                            .theta_rad = std::bit_cast<double>(numbers[5])}};
    const Pose2& P = entry.P_map_base;
    return std::isfinite(P.x_m) && std::isfinite(P.y_m) && std::isfinite(P.theta_rad) ? std::optional(entry)
                                                                                      : std::nullopt;
}

}  // namespace crspf
