#include <catch2/catch.hpp>
#include <limits>
#include <vector>

#include "platform/capture/journal.hpp"

using namespace crspf;

TEST_CASE("journal: an entry is read as it was written") {
    const JournalEntry entry{.kind = JournalEntry::Kind::kScan,
                             .updated = true,
                             .tidy = true,
                             .motions = 0x0102030405060708,
                             .scan = 77,
                             .changes = std::numeric_limits<std::uint64_t>::max(),
                             .tiles = 0x0A0B0C0D,
                             .P_map_base = {.x_m = -1.25, .y_m = 1e-300, .theta_rad = 3.0}};
    const auto bytes = encode(entry);
    CHECK(bytes[0] == 2);
    CHECK(bytes[4] == 0x0D);
    CHECK(bytes[8] == 0x08);  // little-endian
    CHECK(decode_journal(bytes) == entry);
    const JournalEntry place{.kind = JournalEntry::Kind::kPlace, .motions = 3, .P_map_base = {.x_m = 1.0}};
    CHECK(decode_journal(encode(place)) == place);
}

TEST_CASE("journal: what is no entry is none") {
    const auto good = encode({.scan = 1});
    for (const std::size_t at : {0U, 1U, 2U, 3U}) {
        auto bad = good;
        bad[at] = 3;
        CHECK_FALSE(decode_journal(bad));
    }
    CHECK_FALSE(decode_journal({}));
    CHECK_FALSE(decode_journal(std::span(good).first(55)));
    std::vector<std::uint8_t> longer(good.begin(), good.end());
    longer.push_back(0);
    CHECK_FALSE(decode_journal(longer));
    auto infinite = good;
    infinite[38] = 0xF0;  // x = infinity
    infinite[39] = 0x7F;
    CHECK_FALSE(decode_journal(infinite));
}
