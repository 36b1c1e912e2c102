#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "tools/crspf/map_copies.hpp"
#include "tools/experiments/intel.hpp"
#include "tools/experiments/methods.hpp"
#include "tools/experiments/runs.hpp"
#include "tools/sim/scene.hpp"

using namespace crspf;
using namespace crspf::experiments;

namespace {

sim::SampleDrive short_drive(std::uint64_t seed) {
    sim::SimulationParams params = urg_robot(seed);
    params.duration_s = 5.0;
    return sim::record_drive(sim::make_scene("office"), params);
}

Pose2 way_of(const sim::SampleDrive& drive) {
    Pose2 way;
    for (const sim::SampleDrive::Step& step : drive.steps) {
        for (const MotionSample& motion : step.motions) {
            way = way * motion.P_previous_base;
        }
    }
    return way;
}

}  // namespace

TEST_CASE("runs: errors are those of the poses") {
    const std::vector<Pose2> truth{{}, {.x_m = 1.0}, {.x_m = 2.0}};
    const std::vector<Pose2> poses{{}, {.x_m = 1.3, .y_m = 0.4}, {.x_m = 2.0, .theta_rad = 0.1}};
    const DriveError error = error_of(poses, truth);
    CHECK(error.max_m == Approx(0.5));
    CHECK(error.rms_m == Approx(std::sqrt(0.25 / 3.0)));
    CHECK(error.end_m == 0.0);
    CHECK(error.heading_max_deg == Approx(5.7296).epsilon(1e-4));
    CHECK_FALSE(error.failed());
    CHECK(error_of({{.x_m = 1.1}}, {{}}).failed());
}

TEST_CASE("runs: in step the odometry tells one motion a scan, and the same way") {
    const sim::SampleDrive drive = short_drive(1);
    const sim::SampleDrive stepped = in_step(drive);
    REQUIRE(stepped.steps.size() == drive.steps.size());
    CHECK(drive.steps.at(10).motions.size() > 1);
    CHECK(stepped.steps.at(10).motions.size() == 1);
    CHECK(stepped.steps.at(10).motions.back().stamp == drive.steps.at(10).motions.back().stamp);
    CHECK(way_of(stepped).x_m == Approx(way_of(drive).x_m));
    CHECK(way_of(stepped).theta_rad == Approx(way_of(drive).theta_rad));
}

TEST_CASE("runs: work in parallel is done once each, told of, and its error comes out") {
    std::vector<std::atomic<int>> done(20);
    double told = 0.0;
    in_parallel(
        done.size(), [&](double share) { told = share; }, [&](std::size_t i) { ++done[i]; });
    CHECK(told == 1.0);
    CHECK(std::all_of(done.begin(), done.end(), [](const std::atomic<int>& times) { return times == 1; }));
    CHECK_THROWS_AS(in_parallel(
                        3, [](double) {}, [](std::size_t i) { i == 1 ? throw std::invalid_argument("no") : void(); }),
                    std::invalid_argument);
}

TEST_CASE("methods: each plays the drives of all seeds, and a seed gives the same again") {
    const Context context{.data = {}, .maps = {}, .scratch = {}, .seeds = 2, .progress = [](double) {}};
    const Comparison once = compare(context, 2, short_drive, {as_shipped(), tinyslam_way()});
    REQUIRE(once.methods.size() == 2);
    REQUIRE(once.methods[0].errors.size() == 2);
    CHECK(once.methods[0].rms_m().mean < 0.1);
    CHECK(once.methods[0].errors[0].rms_m != once.methods[0].errors[1].rms_m);
    CHECK(once.methods[0].errors[0].rms_m != once.methods[1].errors[0].rms_m);
    CHECK(once.odometry[0].rms_m > 0.0);
    const Comparison again = compare(context, 2, short_drive, {as_shipped(), tinyslam_way()});
    CHECK(again.methods[0].errors[1].rms_m == once.methods[0].errors[1].rms_m);
    const Table table = table_of(once, "caption");
    CHECK(table.rows.size() == 3);  // and the odometry alone
    CHECK(table.rows[0].size() == table.head.size());
}

TEST_CASE("methods: TinySLAM's way is none of the paper's ideas, and nothing that was added to them") {
    SlamParams params;
    tinyslam_way().change(params);
    CHECK_FALSE(params.particle_filter.feedback);
    CHECK_FALSE(params.critical_rays.enabled);
    CHECK_FALSE(params.map.remove_errors);
    CHECK_FALSE(params.particle_filter.refinement);
    CHECK(tinyslam_way().in_step);
    SlamParams paper;
    paper_alone().change(paper);
    CHECK(paper.particle_filter.feedback);
    CHECK(paper.critical_rays.weight == 10.0);
    CHECK_FALSE(paper.particle_filter.refinement);
    CHECK_FALSE(paper_alone().in_step);
}

TEST_CASE("intel: of every fifth scan the relations between kept scans are left, and all of the odometry") {
    IntelRun run;
    run.drive = short_drive(1);
    run.drive.steps.resize(11);
    for (std::size_t i = 0; i < run.drive.steps.size(); ++i) {
        run.stamps_s.push_back(0.1 * static_cast<double>(i));
    }
    run.relations = {{.stamp1_s = 0.0, .stamp2_s = 0.5, .P_1_2 = {}}, {.stamp1_s = 0.5, .stamp2_s = 0.6, .P_1_2 = {}}};
    const IntelRun fifth = every_fifth(run);
    CHECK(fifth.drive.steps.size() == 3);
    CHECK(fifth.relations.size() == 1);
    CHECK(way_of(fifth.drive).x_m == Approx(way_of(run.drive).x_m));
    CHECK(relation_error_m(fifth, {{}, {.x_m = 0.2}, {}}) == Approx(0.2));
}

TEST_CASE("map copies: land beside land, as far as there is room") {
    const sim::SampleDrive drive = short_drive(1);
    const SlamParams params = params_for(drive, 1);
    const Played played = play(drive, params);
    const std::size_t tiles = played.pipeline->map().tiles();
    const auto pipeline = std::make_unique<Pipeline>(params);
    load_copies(played.pipeline->map(), 3, *pipeline);
    CHECK(pipeline->map().tiles() == 3 * tiles);
    const auto too_many = static_cast<std::int32_t>(capacity::kTiles / tiles);
    CHECK_THROWS_AS(load_copies(played.pipeline->map(), too_many, *pipeline), std::length_error);
}
