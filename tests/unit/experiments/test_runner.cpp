#include <catch2/catch.hpp>

#include "tests/unit/experiments/fakes.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tools/experiments/runner.hpp"

using crspf::experiments::chosen;
using crspf::experiments::Context;
using crspf::experiments::Experiment;
using crspf::experiments::Outcome;
using crspf::experiments::run_all;
using crspf::experiments::Section;
using crspf::test::kFakes;
using crspf::test::Scratch;

TEST_CASE("Experiments run in the table's order, whatever the order of their names", "[experiments][runner]") {
    CHECK(chosen(kFakes, {}).size() == 4);
    const std::vector<Experiment> some = chosen(kFakes, {"absent", "found", "absent"});
    REQUIRE(some.size() == 2);
    CHECK(some[0].name == std::string("found"));
    CHECK(some[1].name == std::string("absent"));
}

TEST_CASE("A wrong name is refused with those that there are", "[experiments][runner]") {
    CHECK_THROWS_WITH(chosen(kFakes, {"found", "fuond"}),
                      "fuond: there is no such experiment; there are found absent failing crashing");
}

TEST_CASE("An experiment that fails does not keep the others from running", "[experiments][runner]") {
    const Scratch folder;
    const Context context{.data = {}, .maps = {}, .scratch = folder.directory(), .seeds = 0, .progress = {}};
    const Outcome outcome = run_all(kFakes, context, " --out o", {});
    REQUIRE(outcome.sections.size() == 4);
    CHECK(outcome.failed);
    CHECK(outcome.internal_error);
    const Section& found = outcome.sections[0];
    CHECK(found.command == "crspf experiments found --out o");
    CHECK(found.seeds == "1 to 3");
    CHECK(found.findings.headlines[0].result == "3 seeds");
    CHECK(outcome.sections[1].skipped == "no <recording> here");
    CHECK(outcome.sections[1].seeds == "1, always");
    CHECK(outcome.sections[2].failure == "map.yaml:3: wrong; mend it");
    CHECK(outcome.sections[2].seeds == "1");
    CHECK(outcome.sections[3].failure == "internal error: a bug");
    CHECK(std::filesystem::is_empty(folder.directory()));
}

TEST_CASE("A skipped experiment is no failure", "[experiments][runner]") {
    const Scratch folder;
    const Context context{.data = {}, .maps = {}, .scratch = folder.directory(), .seeds = 7, .progress = {}};
    std::string seen;
    const Outcome outcome = run_all(chosen(kFakes, {"found", "absent"}), context, "",
                                    {.begins = [&](const Experiment& experiment) { seen += experiment.name; },
                                     .progress = [&](double share) { seen += share == 0.5 ? " half " : " other "; },
                                     .ends = [&](const Section&) { seen += " end "; }});
    CHECK_FALSE(outcome.failed);
    CHECK_FALSE(outcome.internal_error);
    CHECK(outcome.sections[0].seeds == "1 to 7");
    CHECK(outcome.sections[0].findings.headlines[0].result == "7 seeds");
    CHECK(seen == "found half  end absent end ");
}
