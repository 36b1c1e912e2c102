// The readers against public recordings whose contents are known from elsewhere.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <optional>

#include "platform/capture/log_reader.hpp"
#include "platform/files/grid_map.hpp"
#include "tests/unit/eval/recordings.hpp"

using crspf::GridCell;
using crspf::LogEvent;
using crspf::Stamp;
using crspf::test::recording;

namespace {

struct Totals {
    crspf::LogCounts counts;
    double distance_m = 0.0;
    double line_s = 0.0;        ///< from the first scan to the last
    bool same_stamps = true;    ///< each scan has that of the motion before it
    bool odometry_runs = true;  ///< its stamps never run back
    bool scans_run = true;      ///< nor do theirs
    double progress = 0.0;
};

Totals read_log(const std::filesystem::path& file) {
    Totals totals;
    const auto reader = crspf::open_log(file, {}, {});
    const auto event = std::make_unique<LogEvent>();
    std::optional<Stamp> odometry;
    std::optional<Stamp> first;
    Stamp scan;
    while (reader->next(*event)) {
        if (event->kind != LogEvent::Kind::kScan) {
            const bool motion = event->kind == LogEvent::Kind::kMotion;
            const Stamp stamp = motion ? event->motion.stamp : event->differential.stamp;
            totals.odometry_runs = totals.odometry_runs && (!odometry || stamp >= *odometry);
            odometry = stamp;
        }
        if (event->kind == LogEvent::Kind::kMotion) {
            totals.distance_m += std::hypot(event->motion.P_previous_base.x_m, event->motion.P_previous_base.y_m);
        } else if (event->kind == LogEvent::Kind::kDifferential) {
            totals.distance_m += std::abs(event->differential.left_m + event->differential.right_m) / 2.0;
        } else {
            totals.scans_run = totals.scans_run && (!first || event->scan.stamp >= scan);
            scan = event->scan.stamp;
            first = first.value_or(scan);
            totals.same_stamps = totals.same_stamps && (!odometry || scan == *odometry);
            totals.line_s = (scan - *first).seconds();
        }
    }
    totals.counts = reader->counts();
    totals.progress = reader->progress();
    return totals;
}

}  // namespace

TEST_CASE("recordings: intel, whose stamps jump") {
    const auto file = recording("carmen/intel.clf.xz");
    CRSPF_NEED_RECORDING(file);
    const Totals totals = read_log(file);
    CHECK(totals.counts.scans == 13631);
    CHECK(totals.counts.odometry == 13630);
    CHECK(totals.counts.ignored_lines == 2);
    CHECK(totals.counts.damaged_lines == 0);
    CHECK(totals.counts.stamp_jumps == 1242);
    CHECK(totals.distance_m == Approx(508.4).margin(0.1));
    CHECK(totals.progress == 1.0);
    CHECK(totals.same_stamps);
    CHECK(totals.odometry_runs);
    CHECK(totals.scans_run);
    // 2,691 s by the recorded stamps: what they leap ahead before they run back stays on the line.
    CHECK(totals.line_s == Approx(3062.68).margin(0.01));
}

TEST_CASE("recordings: aces, whose stamps run evenly") {
    const auto file = recording("carmen/aces.clf.xz");
    CRSPF_NEED_RECORDING(file);
    const Totals totals = read_log(file);
    CHECK(totals.counts.scans == 7374);
    CHECK(totals.counts.damaged_lines == 0);
    CHECK(totals.counts.stamp_jumps == 0);
    CHECK(totals.distance_m == Approx(325.2).margin(0.1));
    CHECK(totals.line_s == Approx(1365.52).margin(0.01));
    CHECK(totals.same_stamps);
}

TEST_CASE("recordings: the URG-04LX robot") {
    const auto first = recording("urg04lx/breezyslam_exp1.dat.xz");
    const auto second = recording("urg04lx/tinyslam_exp3.dat.xz");
    CRSPF_NEED_RECORDING(first);
    CRSPF_NEED_RECORDING(second);
    const Totals a = read_log(first);
    CHECK(a.counts.scans == 756);
    CHECK(a.counts.damaged_lines == 0);
    CHECK(a.counts.stamp_jumps == 0);
    CHECK(a.odometry_runs);
    CHECK(a.scans_run);
    CHECK(a.line_s == Approx(74.6).margin(0.1));
    const Totals b = read_log(second);
    CHECK(b.counts.scans == 525);
    CHECK(b.counts.damaged_lines == 0);
    CHECK(b.counts.stamp_jumps == 0);
    CHECK(b.odometry_runs);
    CHECK(b.scans_run);
    CHECK(b.line_s == Approx(51.7).margin(0.1));
}

TEST_CASE("recordings: the Stage map 1r5") {
    const auto file = recording("maps/1r5.yaml");
    CRSPF_NEED_RECORDING(file);
    const crspf::GridMap map = crspf::read_grid_map(file);
    CHECK(map.width == 239);
    CHECK(map.height == 249);
    CHECK(map.resolution_m == 0.05);
    const auto occupied = std::count(map.cells.begin(), map.cells.end(), GridCell::kOccupied);
    const auto free = std::count(map.cells.begin(), map.cells.end(), GridCell::kFree);
    CHECK(occupied > 1000);
    CHECK(free > 10000);
}
