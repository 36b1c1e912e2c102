#include <catch2/catch.hpp>
#include <memory>

#include "platform/crspfd/thread_health.hpp"

using namespace crspf;

TEST_CASE("health: times are counted by size") {
    TimeHistogram times;
    CHECK(times.below(0.5) == Duration{});
    for (int i = 0; i < 998; ++i) {
        times.add(Duration{3'000});  // 3 us
    }
    times.add(Duration{900'000});
    times.add(Duration{-5});
    CHECK(times.below(0.5) == Duration{4'000});
    CHECK(times.below(0.999) == Duration{4'000});
    CHECK(times.below(1.0) == Duration{960'000});  // the last eighth but one of 512 us to 1024 us
    CHECK(times.max() == Duration{900'000});
    CHECK(times.count(0) == 1);
    times.add(Duration{std::int64_t{1} << 60U});
    CHECK(times.count(TimeHistogram::kBuckets - 1) == 1);
}

TEST_CASE("health: the buckets follow one another, and a time is in the one around it") {
    for (std::size_t bucket = 0; bucket < TimeHistogram::kBuckets; ++bucket) {
        REQUIRE(TimeHistogram::begin_of(bucket) < TimeHistogram::end_of(bucket));
        for (const std::uint64_t us : {TimeHistogram::begin_of(bucket), TimeHistogram::end_of(bucket) - 1}) {
            TimeHistogram times;
            times.add(Duration{static_cast<std::int64_t>(us) * 1000});
            REQUIRE(times.count(bucket) == 1);
        }
    }
}

TEST_CASE("health: a bound is never below the time, nor above it by more than an eighth") {
    for (std::int64_t us = 0; us < 3'000'000; us += 1 + us / 50) {
        TimeHistogram times;
        times.add(Duration{us * 1000});
        const std::int64_t bound_us = times.below(1.0).ns / 1000;
        CHECK(bound_us > us);
        CHECK(bound_us <= us + 1 + us / 8);
    }
}

TEST_CASE("health: what takes longer than its deadline is a miss") {
    ThreadHealth health;
    health.worked(Duration{10}, Duration{10});
    CHECK(health.misses() == 0);
    health.worked(Duration{11}, Duration{10});
    CHECK(health.misses() == 1);
    health.turned(Stamp{77});
    CHECK(health.last_turn() == Stamp{77});
}
