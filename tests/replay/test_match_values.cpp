#include <catch2/catch.hpp>
#include <cmath>

#include "platform/files/input_error.hpp"
#include "tests/replay/simulated_log.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tools/eval/match_values.hpp"

using crspf::eval::match_values;

TEST_CASE("match values: the match tells true poses from poses beside them", "[replay]") {
    const crspf::test::Scratch scratch;
    auto run = crspf::test::simulate_office(crspf::test::LogFormat::kCarmen, 30.0);
    const auto log = scratch.file("log", run.log);
    const auto rows = match_values({log}, run.config, run.truth);
    CHECK(rows[0].scans > run.truth.size() / 2);
    CHECK(rows[0].median > rows[1].median);
    CHECK(rows[1].median > rows[2].median);
    CHECK(rows[2].median > rows[3].median);
    CHECK(rows[0].p01 > rows[3].median);

    SECTION("control: at poses that are wrong themselves it does not") {
        for (std::size_t i = 0; i < run.truth.size(); ++i) {
            run.truth[i].P_map_base.x_m += 0.5 * std::sin(static_cast<double>(i));
        }
        CHECK(match_values({log}, run.config, run.truth)[0].p01 < 0.5 * rows[0].p01);
    }
    SECTION("one pose a scan") {
        run.truth.pop_back();
        CHECK_THROWS_AS(match_values({log}, run.config, run.truth), crspf::InputError);
    }
}
