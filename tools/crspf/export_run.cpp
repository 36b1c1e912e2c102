#include "tools/crspf/export_run.hpp"

#include <system_error>

#include "core/base/trig.hpp"
#include "platform/files/grid_map.hpp"
#include "platform/files/input_error.hpp"
#include "platform/files/kitti_poses.hpp"
#include "platform/files/planning_map.hpp"
#include "platform/files/png_image.hpp"
#include "platform/files/trajectory.hpp"
#include "platform/service/map_image.hpp"
#include "tools/crspf/export_carmen.hpp"
#include "tools/crspf/export_csv.hpp"
#include "tools/crspf/export_mcap.hpp"
#include "tools/crspf/export_svg.hpp"
#include "tools/crspf/pose_digest.hpp"
#include "tools/crspf/run_player.hpp"

namespace crspf {
namespace {

/// What is written while the run is played. The rest has to wait for its end.
class Streams {
 public:
    Streams(const ExportOutputs& outputs, const Config& config) {
        if (outputs.carmen) {
            carmen_.emplace(*outputs.carmen, config.slam);
        }
        if (outputs.csv) {
            csv_.emplace(*outputs.csv);
        }
        if (outputs.mcap) {
            mcap_.emplace(*outputs.mcap, config);
        }
    }

    void before(const LogEvent& event, const RunPlayer& player) {
        if (carmen_) {
            carmen_->before(event, player.pipeline().odometry());
        }
    }
    void after(const LogEvent& event, const RunPlayer& player) {
        if (carmen_) {
            carmen_->after(event, player.pipeline().odometry());
        }
    }
    void on_scan(const RunPlayer& player, const ScanResult& result) {
        if (csv_) {
            csv_->add(player, result);
        }
        if (mcap_) {
            mcap_->on_scan(player, result);
        }
    }
    void finish(RunPlayer& player) {
        if (carmen_) {
            carmen_->finish();
        }
        if (csv_) {
            csv_->finish();
        }
        if (mcap_) {
            mcap_->finish(player);
        }
    }

 private:
    std::optional<CarmenExport> carmen_;
    std::optional<CsvExport> csv_;
    std::optional<McapExport> mcap_;
};

std::vector<KittiPose> kitti_poses(const std::vector<TimedPose>& trajectory) {
    std::vector<KittiPose> poses;
    poses.reserve(trajectory.size());
    for (const TimedPose& pose : trajectory) {
        const auto& [x_m, y_m, theta_rad] = pose.P_map_base;
        const SinCos r = sin_cos(theta_rad);
        poses.push_back({r.cos, -r.sin, 0.0, x_m, r.sin, r.cos, 0.0, y_m, 0.0, 0.0, 1.0, 0.0});
    }
    return poses;
}

void write_maps(const ExportOutputs& outputs, const std::vector<TimedPose>& trajectory, RunPlayer& player) {
    if (!outputs.svg && !outputs.png && !outputs.map && !outputs.planning) {
        return;
    }
    const GridMap map = export_map(player.pipeline().map(), player.config().slam.map.resolution_m, &player.far_tiles());
    if (outputs.svg) {
        write_svg(map, trajectory, *outputs.svg);
    }
    if (outputs.png) {
        write_png(draw_map(map, trajectory, kPictureSide_px), *outputs.png);
    }
    if (outputs.map) {
        write_grid_map(map, *outputs.map);
    }
    if (outputs.planning) {
        write_grid_map(planning_map(map), *outputs.planning);
    }
}

std::vector<std::string> files_of(const ExportOutputs& outputs) {
    std::vector<std::string> files;
    for (const ExportOutputs::Path* const path :
         {&outputs.mcap, &outputs.tum, &outputs.kitti, &outputs.carmen, &outputs.csv, &outputs.svg, &outputs.png}) {
        if (*path) {
            files.push_back((*path)->string());
        }
    }
    for (const ExportOutputs::Path* const stem : {&outputs.map, &outputs.planning}) {
        if (*stem) {
            files.push_back((*stem)->string() + ".pgm");
            files.push_back((*stem)->string() + ".yaml");
        }
    }
    return files;
}

/// Before a run is played for minutes.
void demand_directories(const std::vector<std::string>& files) {
    for (const std::string& file : files) {
        const std::filesystem::path directory = std::filesystem::path(file).parent_path();
        std::error_code ignored;
        if (!directory.empty() && !std::filesystem::is_directory(directory, ignored)) {
            throw InputError(file + ": " + directory.string() + " is no directory; make it, or write elsewhere");
        }
    }
}

}  // namespace

ExportOutcome export_run(const ReplayJob& job, const ExportOutputs& outputs) {
    demand_directories(files_of(outputs));
    RunPlayer player(job);
    Streams streams(outputs, player.config());
    std::vector<TimedPose> trajectory;
    while (const LogEvent* const event = player.next()) {
        streams.before(*event, player);
        const std::optional<ScanResult> result = player.play();
        streams.after(*event, player);
        if (!result) {
            continue;
        }
        trajectory.push_back({.stamp_s = player.recorded_stamp_s(), .P_map_base = result->P_map_base});
        streams.on_scan(player, *result);
        constexpr std::size_t kScansPerReport = 64;
        if (job.progress && trajectory.size() % kScansPerReport == 0) {
            job.progress(player.share(), trajectory.size());
        }
    }
    if (trajectory.empty()) {
        throw player.without_scans();
    }
    streams.finish(player);
    if (outputs.tum) {
        write_tum(trajectory, *outputs.tum);
    }
    if (outputs.kitti) {
        write_kitti_poses(kitti_poses(trajectory), *outputs.kitti);
    }
    write_maps(outputs, trajectory, player);
    return {.scans = trajectory.size(),
            .written = files_of(outputs),
            .log = player.counts(),
            .sources = player.sources(),
            .map_refused = player.pipeline().map().refused(),
            .digest = digest_of(trajectory)};
}

}  // namespace crspf
