// What a running service decided and a replay cannot know: how its threads happened to be timed. A recording's source
// of LinkKind::kJournal holds one entry for each scan that was matched and for each word of an operator.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/pose.hpp"

namespace crspf {

struct JournalEntry {
    enum class Kind : std::uint8_t { kScan, kPlace };
    Kind kind = Kind::kScan;
    bool updated = false;       ///< kScan: whether the map's thread was given it
    bool tidy = false;          ///< kScan: MapTask::tidy of it
    std::uint64_t motions = 0;  ///< samples of the odometer that the filter had taken before it, since the start
    std::uint64_t scan = 0;     ///< kScan: which scan of the lidar it was, the first is 1
    std::uint64_t changes = 0;  ///< kScan: updates whose changes the filter's image of the map had, since the start
    std::uint32_t tiles = 0;    ///< kScan: MapTask::tiles of it
    Pose2 P_map_base{};         ///< kScan: what was found; kPlace: where the robot is

    friend bool operator==(const JournalEntry&, const JournalEntry&) = default;
};

/// Version, kind, updated, tidy, tiles (4 bytes); the three numbers and the three of the pose: 8 bytes each.
/// Little-endian.
inline constexpr std::size_t kJournalBytes = 56;

/// No heap, no throw.
[[nodiscard]] std::array<std::uint8_t, kJournalBytes> encode(const JournalEntry& entry);
/// Nothing for bytes that are no entry of this version.
[[nodiscard]] std::optional<JournalEntry> decode_journal(std::span<const std::uint8_t> bytes);

}  // namespace crspf
