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
    CHECK(times.below(1.0) == Duration{1'024'000});
    CHECK(times.max() == Duration{900'000});
    CHECK(times.count(0) == 1);
    times.add(Duration{std::int64_t{1} << 60U});
    CHECK(times.count(TimeHistogram::kBuckets - 1) == 1);
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
