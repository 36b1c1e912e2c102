// Fig. 9: the critical rays of scans, drawn; and whether they are those that see the corners of the world.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/trig.hpp"
#include "core/slam/scan_points.hpp"
#include "tools/eval/logged_scans.hpp"
#include "tools/experiments/corners.hpp"
#include "tools/experiments/experiment.hpp"
#include "tools/experiments/ray_tally.hpp"
#include "tools/experiments/runs.hpp"

namespace crspf::experiments {
namespace {

constexpr double kDrive_s = 160.0;
constexpr double kScanRate_hz = 2.5;  // of those looked at: enough, and each at another place
constexpr std::size_t kRealScans = 1000;
constexpr double kGap = std::numeric_limits<double>::quiet_NaN();

/// A scan as a plan: in the frame of the world where there is one.
Chart plan_of(std::string caption, std::string file, const ScanPoints& points, const RayFinder& finder,
              const Pose2& P_plan_base, const sim::World* world) {
    Series hits{.name = "hits", .x = {}, .y = {}, .mark = Mark::kDots};
    Series critical{.name = "critical rays", .x = {}, .y = {}, .mark = Mark::kDots};
    Series lidar{.name = "robot", .x = {P_plan_base.x_m}, .y = {P_plan_base.y_m}, .mark = Mark::kDots};
    for (std::uint32_t i = 0; i < points.count; ++i) {
        const Pose2 at =
            P_plan_base * Pose2{.x_m = static_cast<double>(points.x_m[i]), .y_m = static_cast<double>(points.y_m[i])};
        Series& series = finder.critical(i) ? critical : hits;
        series.x.push_back(at.x_m);
        series.y.push_back(at.y_m);
    }
    Chart chart{.caption = std::move(caption), .x_label = "x [m]", .y_label = "y [m]", .series = {}};
    chart.equal_scales = true;
    chart.file = std::move(file);
    if (world != nullptr && !hits.x.empty()) {
        constexpr double kMargin_m = 0.5;
        const auto [x0, x1] = std::minmax_element(hits.x.begin(), hits.x.end());
        const auto [y0, y1] = std::minmax_element(hits.y.begin(), hits.y.end());
        Series walls{.name = "true walls", .x = {}, .y = {}, .mark = Mark::kLine};
        for (const sim::Segment& wall : world->walls()) {
            // Cut to what is in view: along a wall of 80 m the scan would be a speck.
            const double length_m = sim::distance(wall.a, wall.b);
            const double dx = (wall.b.x_m - wall.a.x_m) / std::max(length_m, 1e-9);
            const double dy = (wall.b.y_m - wall.a.y_m) / std::max(length_m, 1e-9);
            sim::Part part{.from_m = 0.0, .to_m = length_m};
            part.cut(wall.a.x_m, dx, *x0 - kMargin_m, *x1 + kMargin_m);
            part.cut(wall.a.y_m, dy, *y0 - kMargin_m, *y1 + kMargin_m);
            if (!part.empty()) {
                for (const double along_m : {part.from_m, part.to_m}) {
                    walls.x.push_back(wall.a.x_m + along_m * dx);
                    walls.y.push_back(wall.a.y_m + along_m * dy);
                }
                walls.x.push_back(kGap);
                walls.y.push_back(kGap);
            }
        }
        chart.series.push_back(std::move(walls));
    }
    chart.series.push_back(std::move(hits));
    chart.series.push_back(std::move(critical));
    chart.series.push_back(std::move(lidar));
    return chart;
}

struct Wanted {
    std::size_t scan = 0;  ///< which one is drawn; 0: none
    std::string caption;
    std::string file;
};

/// Drives the lidar through a scene; the scan that is wanted becomes a chart.
RayCount look_round(const sim::Scene& scene, const sim::LidarModel& lidar, const Wanted& wanted,
                    std::vector<Block>& blocks) {
    sim::SimulationParams params = urg_robot(1);
    params.lidar = lidar;
    params.lidar.scan_rate_hz = kScanRate_hz;
    params.duration_s = kDrive_s;
    const sim::SampleDrive drive = sim::record_drive(scene, params);
    const Corners corners(scene.world);
    RayTally tally(scene.world, corners);
    const auto odometry = std::make_unique<Odometry>(OdometryParams{});
    const auto finder = std::make_unique<RayFinder>(drive.lidar);
    const auto points = std::make_unique<ScanPoints>();
    ScanProjector projector(drive.lidar, true);
    for (std::size_t i = 0; i < drive.steps.size(); ++i) {
        for (const MotionSample& motion : drive.steps[i].motions) {
            odometry->add(motion);
        }
        projector.project(drive.steps[i].scan, *odometry, *points);
        finder->find(*points);
        const Pose2 P_world_base = drive.P_world_map * drive.truth[i];
        tally.add(*points, *finder, P_world_base);
        if (i > 0 && i == wanted.scan) {
            blocks.emplace_back(plan_of(wanted.caption, wanted.file, *points, *finder, P_world_base, &scene.world));
        }
    }
    return tally.count();
}

/// Of a recorded run nobody knows the corners.
RayCount look_at_log(const std::filesystem::path& log, double range_max_m, const Wanted* wanted,
                     std::vector<Block>& blocks) {
    Config config;
    config.slam.lidar.range_max_m = range_max_m;
    const auto finder = std::make_unique<RayFinder>(config.slam.lidar);
    RayCount count;
    eval::for_each_scan({log}, config, [&](double /*stamp_s*/, const ScanPoints& points) {
        if (count.scans >= kRealScans) {
            return;
        }
        count.critical += finder->find(points);
        count.hits += points.count;
        if (wanted != nullptr && count.scans == wanted->scan) {
            blocks.emplace_back(plan_of(wanted->caption, wanted->file, points, *finder, {}, nullptr));
        }
        ++count.scans;
    });
    return count;
}

struct Row {
    std::string name;  ///< in the table
    std::string key;   ///< in the figures
    RayCount count;
    bool simulated = true;
};

Table table_of(const std::vector<Row>& rows) {
    Table table{.caption = "Critical rays, and how many of them lie within " + text_of(kAtCorner_m, 2) +
                           " m of a corner in view",
                .head = {"run", "scans", "hits a scan", "critical rays a scan", "of 1000 hits",
                         "critical rays at corners", "all rays at corners", "corners in view with a critical ray"},
                .rows = {}};
    for (const Row& row : rows) {
        const RayCount& c = row.count;
        const auto known = [&row](double share) {
            return row.simulated ? percent_of(share, 0) : std::string("not known");
        };
        table.rows.push_back({row.name, std::to_string(c.scans), text_of(c.hits_per_scan(), 0),
                              text_of(c.critical_per_scan(), 1),
                              text_of(1000.0 * RayCount::share(c.critical, c.hits), 1), known(c.critical_share()),
                              known(c.all_share()), known(c.found_share())});
    }
    return table;
}

Table incidence_table(const std::vector<Row>& rows) {
    Table table{.caption =
                    "Critical rays away from all corners, of 1000 hits there, by the angle of the beam to the "
                    "wall's normal",
                .head = {"run", "0 to 30 deg", "30 to 60 deg", "60 to 90 deg"},
                .rows = {}};
    for (const Row& row : rows) {
        if (row.simulated) {
            std::vector<std::string> cells{row.name};
            for (std::size_t k = 0; k < kIncidences; ++k) {
                cells.push_back(text_of(1000.0 * RayCount::share(row.count.wrong[k], row.count.plain[k]), 1));
            }
            table.rows.push_back(std::move(cells));
        }
    }
    return table;
}

nlohmann::ordered_json figures_of(const std::vector<Row>& rows) {
    nlohmann::ordered_json figures;
    for (const Row& row : rows) {
        const RayCount& c = row.count;
        nlohmann::ordered_json& f = figures[row.key];
        f["scans"] = c.scans;
        f["hits_per_scan"] = c.hits_per_scan();
        f["critical_per_scan"] = c.critical_per_scan();
        if (row.simulated) {
            f["critical_at_corner"] = c.critical_share();
            f["all_at_corner"] = c.all_share();
            f["corners_found"] = c.found_share();
        }
    }
    return figures;
}

/// What decides: most critical rays see corners, and clearly more than any ray does.
Verdict verdict_on(const RayCount& c) {
    constexpr double kMost = 0.6;
    constexpr double kClearly = 2.0;
    constexpr double kHardly = 1.5;
    if (c.critical_share() >= kMost && c.critical_share() >= kClearly * c.all_share()) {
        return Verdict::kHolds;
    }
    return c.critical_share() < kHardly * c.all_share() ? Verdict::kDoesNotHold : Verdict::kPartly;
}

std::string at_corners(const RayCount& c) {
    return percent_of(c.critical_share(), 0) + " of the critical rays lie at a corner, of all rays " +
           percent_of(c.all_share(), 0) + ".";
}

struct Compared {
    const RayCount& urg;
    const RayCount& quiet;  ///< without noise
    const RayCount& half;   ///< of the noise
    const RayCount* real;   ///< nullptr: the recording is not there
};

Claim urg_claim(const Compared& counts) {
    Claim claim{.paper =
                    "Critical rays express the structure of the environment (4.2, Fig. 9): they see its corners. "
                    "With the URG-04LX:",
                .measured = at_corners(counts.urg),
                .verdict = verdict_on(counts.urg)};
    if (claim.verdict == Verdict::kHolds) {
        return claim;
    }
    const CriticalRaysParams params;
    const sim::LidarModel model = sim::lidar_model("urg");
    constexpr double kMillimetres = 1000.0;
    const auto per_metre_mm = [&](double points) { return text_of(kMillimetres * points * model.increment_rad, 0); };
    claim.reason = "Range noise. For each metre of range, the arms of (4) and (5) are " +
                   per_metre_mm(params.window_min) + " to " + per_metre_mm(params.window_max) +
                   " mm long on a wall that faces the sensor, and a range's standard deviation is " +
                   text_of(kMillimetres * model.noise_fraction, 0) +
                   " mm: (7) takes the sharpest of 25 angles, and noise bends one below 125 deg often enough. The same "
                   "drive without noise gives " +
                   text_of(counts.quiet.critical_per_scan(), 1) + " critical rays a scan in place of " +
                   text_of(counts.urg.critical_per_scan(), 1) + ", " + percent_of(counts.quiet.critical_share(), 0) +
                   " of them at corners; with half of the noise " + percent_of(counts.half.critical_share(), 0) + ".";
    if (counts.real != nullptr) {
        const auto per_thousand = [](const RayCount& c) {
            return text_of(1000.0 * RayCount::share(c.critical, c.hits), 0);
        };
        claim.reason += " A real URG has " + per_thousand(*counts.real) +
                        " critical rays in 1000 hits, the simulated one " + per_thousand(counts.urg) +
                        ", with half of the noise " + per_thousand(counts.half) +
                        ": the data sheet's noise is more than that sensor had from beam to beam.";
    }
    return claim;
}

Claim lms_claim(const RayCount& lms) {
    Claim claim{.paper = "Critical rays see the corners (4.2): with a SICK LMS.",
                .measured = at_corners(lms),
                .verdict = verdict_on(lms)};
    if (claim.verdict != Verdict::kHolds) {
        claim.reason = "Its points are 1 deg apart: few corners have four points on one surface to either side.";
    }
    return claim;
}

sim::LidarModel with_noise(sim::LidarModel model, double times) {
    model.noise_m *= times;
    model.noise_fraction *= times;
    return model;
}

}  // namespace

Findings rays(const Context& context) {
    Findings found;
    found.blocks.emplace_back(Paragraph{
        "A ray is critical where the outline of what the lidar sees bends below 125 degrees, by the points 4 to 8 "
        "beams to either side. The charts show them on single scans. The table counts, over a drive of " +
        text_of(kDrive_s, 0) +
        " s, how many lie at a corner of the true world: where two walls meet at more than 30 degrees or one ends, "
        "with nothing in between. The corners that have a critical ray are counted as runs of neighbouring hits."});
    const sim::Scene office = sim::make_scene("office");
    const sim::LidarModel urg = sim::lidar_model("urg");
    constexpr std::size_t kSteps = 7;
    std::size_t step = 0;
    const auto next = [&] { context.progress(static_cast<double>(++step) / kSteps); };
    constexpr std::size_t kInARoom = 225;
    constexpr std::size_t kInTheCorridor = 40;

    std::vector<Row> rows;
    const auto drive = [&](std::string name, std::string key, const sim::Scene& scene, const sim::LidarModel& lidar,
                           const Wanted& wanted) {
        RayCount count = look_round(scene, lidar, wanted, found.blocks);
        rows.push_back({std::move(name), std::move(key), count});
        next();
    };
    drive("office, URG", "office_urg", office, urg,
          {kInARoom, "A scan of the URG in the office (simulated; noise 10 mm, or 1 % of the range)", "rays-office"});
    drive("office, URG without noise", "office_urg_without_noise", office, with_noise(urg, 0.0),
          {kInARoom, "The same scan without noise", "rays-office-without-noise"});
    drive("office, URG with half of the noise", "office_urg_half_noise", office, with_noise(urg, 0.5), {});
    drive("corridor, URG", "corridor_urg", sim::make_scene("corridor"), urg,
          {kInTheCorridor, "A scan of the URG in the corridor (simulated)", "rays-corridor"});
    drive("office, SICK LMS", "office_lms", office, sim::lidar_model("lms"),
          {kInARoom, "A scan of a SICK LMS at the same place of the office (simulated; noise 10 mm)", "rays-lms"});

    const std::filesystem::path intel = context.data / "carmen/intel.clf.xz";
    if (std::filesystem::exists(intel)) {
        constexpr double kIntelRange_m = 40.0;
        const Wanted wanted{kRealScans / 2, "A scan of a real SICK LMS (intel.clf), seen from the robot", "rays-intel"};
        rows.push_back(
            {"intel.clf, real SICK LMS", "intel", look_at_log(intel, kIntelRange_m, &wanted, found.blocks), false});
    }
    next();
    const std::filesystem::path exp1 = context.data / "urg04lx/breezyslam_exp1.dat.xz";
    if (std::filesystem::exists(exp1)) {
        const Wanted wanted{kRealScans / 4, "A scan of a real URG-04LX, seen from the robot", "rays-urg"};
        rows.push_back(
            {"exp1.dat, real URG-04LX", "exp1", look_at_log(exp1, urg.range_max_m, &wanted, found.blocks), false});
    }
    next();

    found.blocks.emplace_back(table_of(rows));
    found.blocks.emplace_back(incidence_table(rows));
    found.figures = figures_of(rows);
    const auto count_of = [&rows](const std::string& key) {
        const auto row = std::find_if(rows.begin(), rows.end(), [&](const Row& r) { return r.key == key; });
        return row == rows.end() ? nullptr : &row->count;
    };
    found.claims.push_back(urg_claim({.urg = *count_of("office_urg"),
                                      .quiet = *count_of("office_urg_without_noise"),
                                      .half = *count_of("office_urg_half_noise"),
                                      .real = count_of("exp1")}));
    found.claims.push_back(lms_claim(*count_of("office_lms")));
    found.claims.push_back({.paper = "Our method obtains better critical rays than CRSM-SLAM (4.2, Fig. 9).",
                            .measured = "CRSM-SLAM is not run here.",
                            .verdict = Verdict::kNotMeasured});
    return found;
}

}  // namespace crspf::experiments
