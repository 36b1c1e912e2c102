#include <array>
#include <catch2/catch.hpp>
#include <cstdint>
#include <memory>
#include <thread>

#include "core/base/latest_value.hpp"

using crspf::LatestValue;

TEST_CASE("The newest value wins, and the others are counted", "[latest]") {
    LatestValue<int> cell;
    CHECK_FALSE(cell.update());
    CHECK(cell.number() == 0);
    cell.publish(1);
    REQUIRE(cell.update());
    CHECK(cell.value() == 1);
    CHECK_FALSE(cell.update());
    CHECK(cell.value() == 1);
    cell.publish(2);
    cell.publish(3);
    cell.publish(4);
    REQUIRE(cell.update());
    CHECK(cell.value() == 4);
    CHECK(cell.number() == 4);
    CHECK(cell.skipped() == 2);
}

TEST_CASE("A value that is being read is not written to", "[latest]") {
    LatestValue<int> cell;
    cell.publish(1);
    REQUIRE(cell.update());
    const int& held = cell.value();
    for (int i = 2; i < 10; ++i) {
        cell.publish(i);
        CHECK(held == 1);
    }
}

TEST_CASE("A reader sees whole values, ever newer ones, and the last", "[latest][threads]") {
    using Value = std::array<std::uint64_t, 64>;
    const auto cell = std::make_unique<LatestValue<Value>>();
    constexpr std::uint64_t kValues = 200'000;
    std::jthread writer([&cell] {
        for (std::uint64_t i = 1; i <= kValues; ++i) {
            cell->slot().fill(i);
            cell->publish();
        }
    });
    std::uint64_t newest = 0;
    std::uint64_t read = 0;
    std::uint64_t wrong = 0;
    while (newest < kValues) {
        if (!cell->update()) {
            std::this_thread::yield();
            continue;
        }
        ++read;
        const Value& value = cell->value();
        wrong += value[0] > newest ? 0U : 1U;
        newest = value[0];
        wrong += cell->number() == newest ? 0U : 1U;
        for (const std::uint64_t v : value) {
            wrong += v == newest ? 0U : 1U;
        }
    }
    CHECK(wrong == 0);
    CHECK(read + cell->skipped() == kValues);
}
