#include "tools/experiments/carried_run.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "core/base/trig.hpp"
#include "core/slam/pipeline.hpp"
#include "core/slam/relocalization.hpp"
#include "core/slam/scan_points.hpp"
#include "platform/service/map_image.hpp"

namespace crspf::experiments {
namespace {

constexpr Duration kPause{2'000'000'000};  // between two searches, as in the service
constexpr std::uint64_t kSlice = 1'000'000;

double turn_rate_radps(const sim::SampleDrive::Step& step, Stamp before) {
    if (step.motions.empty()) {
        return 0.0;
    }
    double turned_rad = 0.0;
    for (const MotionSample& motion : step.motions) {
        turned_rad += motion.P_previous_base.theta_rad;
    }
    const double took_s = (step.motions.back().stamp - before).seconds();
    return took_s > 0.0 ? turned_rad / took_s : 0.0;
}

/// The robot was there at an instant; it may have moved since.
void place(Pipeline& pipeline, Stamp stamp, const Pose2& P_map_base) {
    const Odometry& odometry = pipeline.odometry();
    pipeline.set_pose(P_map_base * (inverse(odometry.pose_at(stamp)) * odometry.pose()));
}

/// Looks for the robot of a pipeline in its map. The service does it in a thread of its own, here it takes no time.
class Finder {
 public:
    explicit Finder(const SlamParams& params)
        : resolution_m_(params.map.resolution_m), projector_(params.lidar, params.deskew) {}

    void look(const Scan& scan, Pipeline& pipeline, SearchTally& tally) {
        if (ended_ && scan.stamp - *ended_ < kPause) {
            return;
        }
        ended_ = scan.stamp;
        ++tally.searches;
        projector_.project(scan, pipeline.odometry(), *points_);
        const Relocalization found = search(export_map(pipeline.map(), resolution_m_));
        if (found.verdict != PlaceVerdict::kFound) {
            return;
        }
        place(pipeline, scan.stamp, found.P_map_base);
        ++tally.found;
        tally.first_found_s = tally.first_found_s > 0.0 ? tally.first_found_s : (scan.stamp - Stamp{}).seconds();
    }

 private:
    [[nodiscard]] Relocalization search(const GridMap& map) const {
        const std::vector<Evidence> cells = evidence_of(map);
        const MapView view = view_of(map, cells);
        const auto relocalizer = std::make_unique<Relocalizer>(RelocalizationParams{});
        std::vector<std::uint8_t> memory(relocalizer->bytes_needed(view));
        if (!relocalizer->load(view, memory)) {
            return {};
        }
        relocalizer->begin(*points_);
        while (!relocalizer->step(kSlice)) {
        }
        return relocalizer->result();
    }

    double resolution_m_;
    ScanProjector projector_;
    std::unique_ptr<ScanPoints> points_ = std::make_unique<ScanPoints>();
    std::optional<Stamp> ended_;
};

/// On a map that is known and stays as it is.
void load(const RunOptions& options, Pipeline& pipeline) {
    if (options.map == nullptr) {
        return;
    }
    for (const TileRecord& tile : tiles_of(*options.map, "the map", options.params.map.resolution_m, {})) {
        pipeline.load(tile);
    }
    pipeline.set_pose({});
}

const Carry* find(const std::vector<Carry>& carries, std::size_t Carry::*when, std::size_t scan) {
    const auto found = std::find_if(carries.begin(), carries.end(), [&](const Carry& c) { return c.*when == scan; });
    return found == carries.end() ? nullptr : &*found;
}

void move_on(Pipeline& pipeline, const sim::SampleDrive::Step& step, const Carry* carry) {
    bool told = carry == nullptr;
    for (MotionSample motion : step.motions) {
        motion.P_previous_base = told ? motion.P_previous_base : motion.P_previous_base * carry->P_base_told;
        told = true;
        pipeline.on_motion(motion);
    }
}

}  // namespace

CarriedRun run_drive(const sim::SampleDrive& drive, const RunOptions& options) {
    CarriedRun run;
    SlamParams params = options.params;
    params.localize_only = options.map != nullptr;
    const auto pipeline = std::make_unique<Pipeline>(params);
    load(options, *pipeline);
    const auto finder = std::make_unique<Finder>(params);
    const std::size_t all = drive.steps.size();
    const std::size_t scans = options.scans_max > 0 ? std::min(options.scans_max, all) : all;
    Stamp before;
    bool carried = false;
    for (std::size_t i = 0; i < scans; ++i) {
        const sim::SampleDrive::Step& step = drive.steps[i];
        const Carry* const carry = i == 0 ? nullptr : find(options.carries, &Carry::scan, i);
        move_on(*pipeline, step, carry);
        carried = carried || carry != nullptr;
        Matched scan{.time_s = (step.scan.stamp - drive.steps.front().scan.stamp).seconds(),
                     .result = pipeline->on_scan(step.scan)};
        scan.turn_radps = turn_rate_radps(step, before);
        scan.carried = carried;
        const Pose2& found = scan.result.P_map_base;
        const Pose2& truth = drive.truth[i];
        scan.off_m = std::hypot(found.x_m - truth.x_m, found.y_m - truth.y_m);
        scan.off_deg = degrees(std::abs(wrap_angle(found.theta_rad - truth.theta_rad)));
        if (options.search && scan.result.lost) {
            finder->look(step.scan, *pipeline, run.search);
        }
        if (i > 0 && find(options.carries, &Carry::placed_at, i) != nullptr) {
            place(*pipeline, step.scan.stamp, truth);
            carried = false;
        }
        run.scans.push_back(scan);
        before = step.motions.empty() ? before : step.motions.back().stamp;
    }
    run.map = export_map(pipeline->map(), params.map.resolution_m);
    return run;
}

}  // namespace crspf::experiments
