#include <array>
#include <catch2/catch.hpp>
#include <cstdint>
#include <memory>
#include <thread>

#include "core/base/spsc_ring.hpp"

using crspf::SpscRing;

TEST_CASE("A ring gives back what was put in, in order", "[ring]") {
    SpscRing<int, 4> ring;
    int item = 0;
    CHECK_FALSE(ring.pop(item));
    CHECK(ring.front() == nullptr);
    for (int round = 0; round < 10; ++round) {  // several times around
        CHECK(ring.push(3 * round));
        CHECK(ring.push(3 * round + 1));
        CHECK(ring.push(3 * round + 2));
        CHECK(ring.size() == 3);
        for (int i = 0; i < 3; ++i) {
            REQUIRE(ring.pop(item));
            CHECK(item == 3 * round + i);
        }
        CHECK(ring.size() == 0);
    }
    CHECK(ring.rejected() == 0);
}

TEST_CASE("A full ring rejects, counts, and keeps what it has", "[ring]") {
    SpscRing<int, 2> ring;
    CHECK(ring.push(1));
    CHECK(ring.push(2));
    CHECK_FALSE(ring.push(3));
    CHECK(ring.claim() == nullptr);
    CHECK(ring.rejected() == 2);
    int item = 0;
    REQUIRE(ring.pop(item));
    CHECK(item == 1);
    CHECK(ring.push(4));
    REQUIRE(ring.pop(item));
    CHECK(item == 2);
    REQUIRE(ring.pop(item));
    CHECK(item == 4);
}

TEST_CASE("A claimed slot is not seen before it is committed", "[ring]") {
    SpscRing<int, 2> ring;
    int* const slot = ring.claim();
    REQUIRE(slot != nullptr);
    *slot = 7;
    CHECK(ring.front() == nullptr);
    ring.commit();
    REQUIRE(ring.front() != nullptr);
    CHECK(*ring.front() == 7);
}

TEST_CASE("Two threads lose, double and tear nothing in a ring", "[ring][threads]") {
    struct Item {
        std::uint64_t number;
        std::array<std::uint64_t, 15> copies;
    };
    const auto ring = std::make_unique<SpscRing<Item, 64>>();
    constexpr std::uint64_t kItems = 200'000;
    std::jthread producer([&ring] {
        for (std::uint64_t i = 1; i <= kItems;) {
            if (Item* const slot = ring->claim()) {
                slot->number = i;
                slot->copies.fill(i);
                ring->commit();
                ++i;
            } else {
                std::this_thread::yield();
            }
        }
    });
    std::uint64_t expected = 1;
    std::uint64_t torn = 0;
    std::uint64_t out_of_order = 0;
    while (expected <= kItems) {
        const Item* const item = ring->front();
        if (item == nullptr) {
            std::this_thread::yield();
            continue;
        }
        out_of_order += item->number == expected ? 0U : 1U;
        for (const std::uint64_t copy : item->copies) {
            torn += copy == item->number ? 0U : 1U;
        }
        ++expected;
        ring->pop();
    }
    CHECK(torn == 0);
    CHECK(out_of_order == 0);
}
