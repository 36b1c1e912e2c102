#include "tools/crspf/export_run.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "platform/files/grid_map.hpp"
#include "platform/files/input_error.hpp"
#include "platform/files/kitti_poses.hpp"
#include "platform/files/trajectory.hpp"
#include "platform/service/map_image.hpp"
#include "tests/replay/simulated_log.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tools/crspf/odometry_replay.hpp"
#include "tools/crspf/replay.hpp"

using namespace crspf;
using crspf::test::content_of;
using crspf::test::LogFormat;
using crspf::test::Scratch;

namespace {

ReplayJob office_job(const Scratch& scratch, LogFormat format) {
    const auto run = crspf::test::simulate_office(format, 20.0);
    ReplayJob job;
    job.logs = {scratch.file("office.log", run.log)};
    job.config = run.config;
    return job;
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) {
        lines.push_back(line);
    }
    return lines;
}

double farthest_m(const std::vector<TimedPose>& a, const std::vector<TimedPose>& b) {
    double farthest = 0.0;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
        farthest = std::max(
            farthest, std::hypot(a[i].P_map_base.x_m - b[i].P_map_base.x_m, a[i].P_map_base.y_m - b[i].P_map_base.y_m));
    }
    return farthest;
}

}  // namespace

TEST_CASE("export: all files from one replay, which is that of crspf replay") {
    const Scratch scratch;
    const ReplayJob job = office_job(scratch, LogFormat::kCarmen);
    const ReplayOutcome replayed = run_replay(job);
    const ExportOutputs outputs{.mcap = scratch / "run.mcap",
                                .tum = scratch / "run.tum",
                                .kitti = scratch / "run.kitti",
                                .carmen = scratch / "run.clf",
                                .csv = scratch / "run.csv",
                                .svg = scratch / "run.svg",
                                .png = scratch / "run.png",
                                .map = scratch / "map",
                                .planning = scratch / "planning"};
    const ExportOutcome outcome = export_run(job, outputs);
    CHECK(outcome.digest == replayed.digest);
    CHECK(outcome.scans == replayed.trajectory.size());
    CHECK(outcome.written.size() == 11);
    for (const std::string& file : outcome.written) {
        CHECK(std::filesystem::file_size(file) > 0);
    }

    const std::vector<TimedPose> tum = read_tum(scratch / "run.tum");
    REQUIRE(tum.size() == outcome.scans);
    CHECK(farthest_m(tum, replayed.trajectory) < 1e-8);
    const std::vector<KittiPose> kitti = read_kitti_poses(scratch / "run.kitti");
    REQUIRE(kitti.size() == outcome.scans);
    for (std::size_t i = 0; i < kitti.size(); ++i) {
        const Pose2& P = tum[i].P_map_base;
        REQUIRE(std::abs(kitti[i][3] - P.x_m) < 1e-8);
        REQUIRE(std::abs(kitti[i][7] - P.y_m) < 1e-8);
        REQUIRE(std::abs(std::atan2(kitti[i][4], kitti[i][0]) - P.theta_rad) < 1e-7);
    }

    const std::vector<std::string> csv = lines_of(content_of(scratch / "run.csv"));
    REQUIRE(csv.size() == outcome.scans + 1);
    CHECK(csv[0].starts_with("stamp_s,x_m,y_m,heading_deg,"));
    const auto columns = std::count(csv[0].begin(), csv[0].end(), ',');
    for (const std::string& line : csv) {
        REQUIRE(std::count(line.begin(), line.end(), ',') == columns);
    }
    std::istringstream last(csv.back());
    double stamp_s = 0.0;
    double x_m = 0.0;
    char comma = '\0';
    last >> stamp_s >> comma >> x_m;
    CHECK(stamp_s == Approx(tum.back().stamp_s).margin(1e-6));
    CHECK(x_m == replayed.trajectory.back().P_map_base.x_m);  // all digits

    const GridMap map = read_grid_map(scratch / "map.yaml");
    CHECK(map.cells ==
          export_map(replayed.pipeline->map(), replayed.config.slam.map.resolution_m, replayed.far_tiles.get()).cells);
    // 205 of 255 is 0.196 taken: it must lie between the thresholds to be unknown.
    CHECK(content_of(scratch / "map.yaml").find("free_thresh: 0.196") != std::string::npos);
    const std::string svg = content_of(scratch / "run.svg");
    CHECK(svg.starts_with("<svg "));
    CHECK(svg.find("href=\"data:image/png;base64,iVBOR") != std::string::npos);
    CHECK(svg.find("<polyline") != std::string::npos);
    CHECK(svg.find(" m</text>") != std::string::npos);
    CHECK(content_of(scratch / "run.png").starts_with("\x89PNG"));
}

TEST_CASE("export: the CARMEN log is the run again, whatever it was recorded as") {
    for (const LogFormat format : {LogFormat::kCarmen, LogFormat::kUrgDat}) {
        const Scratch scratch;
        ReplayJob job = office_job(scratch, format);
        const ReplayOutcome first = run_replay(job);
        const OdometryOutcome odometry = run_odometry(job);
        export_run(job, {.carmen = scratch / "again.clf"});
        job.logs = {scratch / "again.clf"};
        const ReplayOutcome again = run_replay(job);
        CHECK(again.trajectory.size() == first.trajectory.size());
        CHECK(again.log.damaged_lines == 0);
        CHECK(again.log.scans == first.log.scans);
        CHECK(again.log.invalid_beams == first.log.invalid_beams);
        CHECK(again.log.no_return_beams == first.log.no_return_beams);
        CHECK(farthest_m({run_odometry(job).trajectory.back()}, {odometry.trajectory.back()}) < 1e-6);
        // Odometry of a .dat log ends where a scan begins. The motion within is guessed by the last speed, which the
        // robot's pose in a line of a scan of the same time takes away.
        CHECK(farthest_m(again.trajectory, first.trajectory) < (format == LogFormat::kCarmen ? 0.03 : 0.2));
        const auto lasts_s = [](const ReplayOutcome& run) {
            return run.trajectory.back().stamp_s - run.trajectory.front().stamp_s;
        };
        CHECK(std::abs(lasts_s(again) - lasts_s(first)) < 2e-6);
        // Control: the way is long enough to tell.
        const Pose2& end = first.trajectory.back().P_map_base;
        CHECK(std::hypot(end.x_m, end.y_m) > 0.5);
    }
}

TEST_CASE("export: what cannot be played or written leaves no file") {
    const Scratch scratch;
    ReplayJob job;
    job.logs = {scratch.file("empty.clf", "ODOM 0 0 0 0 0 0 1 host 1\n")};
    CHECK_THROWS_AS(export_run(job, {.mcap = scratch / "run.mcap", .csv = scratch / "run.csv"}), InputError);
    CHECK(scratch.names() == std::vector<std::string>{"empty.clf"});
    // A directory that is not there is told before anything is played.
    CHECK_THROWS_WITH(export_run(job, {.svg = scratch / "no/such/run.svg"}), Catch::Contains("is no directory"));
    CHECK_THROWS_WITH(export_run(job, {.map = scratch / "no/such/map"}), Catch::Contains("is no directory"));
}
