// One log, one result: the same bits from every replay and every match kernel.
#include <catch2/catch.hpp>

#include "tests/replay/replay.hpp"
#include "tests/replay/simulated_log.hpp"
#include "tests/unit/platform/scratch.hpp"

using crspf::Kernel;
using crspf::test::replay;

TEST_CASE("digest: equal for equal input, whatever the kernel", "[replay]") {
    const crspf::test::Scratch scratch;
    const auto run = crspf::test::simulate_office(crspf::test::LogFormat::kCarmen, 60.0);
    const auto log = scratch.file("log", run.log);
    const auto first = replay(log, run.config);
    REQUIRE(first.trajectory.size() > 500);
    CHECK(replay(log, run.config).digest == first.digest);

    if (crspf::field_sum_kernel(Kernel::kFastest) == crspf::field_sum_kernel(Kernel::kPortable)) {
        WARN("skipped: no vector kernel for this processor, there is only one kernel to compare");
    } else {
        CHECK(replay(log, run.config, {.kernel = Kernel::kPortable}).digest == first.digest);
    }

    // Control: a digest that is blind to the result would not see the seed either.
    crspf::Config other = run.config;
    ++other.slam.particle_filter.seed;
    CHECK(replay(log, other).digest != first.digest);
}
