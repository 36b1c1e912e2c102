// Guards against gross error. The bounds are loose on purpose: `crspf eval` tells how good a result is.
#include <catch2/catch.hpp>

#include "config/config.hpp"
#include "tests/replay/replay.hpp"
#include "tests/replay/simulated_log.hpp"
#include "tests/unit/eval/recordings.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tools/eval/ate.hpp"
#include "tools/eval/relations.hpp"

TEST_CASE("accuracy: the whole tour of the simulated office", "[replay]") {
    const crspf::test::Scratch scratch;
    const auto run = crspf::test::simulate_office(crspf::test::LogFormat::kCarmen, std::nullopt);
    const auto replay = crspf::test::replay(scratch.file("log", run.log), run.config);
    REQUIRE(replay.trajectory.size() == run.truth.size());
    const auto report = crspf::eval::absolute_trajectory_error(replay.trajectory, run.truth, {});
    REQUIRE(report);
    CHECK(report->unmatched == 0);
    CHECK(report->position_m.rms < 0.25);
}

TEST_CASE("accuracy: the relations of the intel recording", "[replay]") {
    const auto log = crspf::test::recording("carmen/intel.clf.xz");
    const auto relations = crspf::test::recording("carmen/intel.relations.xz");
    CRSPF_NEED_RECORDING(log);
    CRSPF_NEED_RECORDING(relations);
    const auto replay = crspf::test::replay(log, crspf::load_config(CRSPF_SOURCE_DIR "/config/examples/intel.toml"));
    const auto errors = crspf::eval::relation_errors(replay.trajectory, crspf::eval::read_relations(relations));
    CHECK(errors.skipped == 0);
    CHECK(errors.translation_m.mean < 0.05);
}
