#include "tools/eval/logged_scans.hpp"

#include <memory>
#include <string>

#include "core/odometry/odometry.hpp"
#include "core/slam/obstacle_scan.hpp"
#include "core/slam/scan_points.hpp"
#include "platform/capture/log_reader.hpp"
#include "platform/files/input_error.hpp"
#include "platform/service/open_run.hpp"

namespace crspf::eval {
namespace {

ScanHits hits_of(const ScanPoints& points) {
    ScanHits hits;
    hits.lidar = {points.P_base_first_lidar.x_m, points.P_base_first_lidar.y_m};
    hits.angle_increment_rad = points.angle_increment_rad;
    hits.points.reserve(points.count);
    for (std::uint32_t i = 0; i < points.count; ++i) {
        hits.points.emplace_back(points.x_m[i], points.y_m[i]);
    }
    return hits;
}

}  // namespace

void for_each_scan(const std::vector<std::filesystem::path>& logs, const Config& config,
                   const std::function<void(double, const ScanPoints&)>& visit) {
    std::size_t scans = 0;
    ScanProjector projector(config.slam.lidar, config.slam.deskew);
    const auto event = std::make_unique<LogEvent>();
    const auto points = std::make_unique<ScanPoints>();
    const auto obstacles = std::make_unique<ObstacleScanner>(config.slam.obstacles, config.slam.lidar);
    const auto obstacle_scan = std::make_unique<Scan>();
    std::string first_damage;
    const Run run = open_run(logs, config);
    for (const std::unique_ptr<LogReader>& log : run.parts) {
        const auto odometry = std::make_unique<Odometry>(config.slam.odometry);
        const auto visit_scan = [&](const Scan& scan) {
            projector.project(scan, *odometry, *points);
            visit(event->recorded_stamp_s + (scan.stamp - stamp_of(*event)).seconds(), *points);
            ++scans;
        };
        while (log->next(*event)) {
            switch (event->kind) {
                case LogEvent::Kind::kMotion: odometry->add(event->motion); break;
                case LogEvent::Kind::kDifferential: odometry->add(event->differential); break;
                case LogEvent::Kind::kAckermann: odometry->add(event->ackermann); break;
                case LogEvent::Kind::kImu: odometry->add(event->imu); break;
                case LogEvent::Kind::kPlace: break;
                case LogEvent::Kind::kScan: visit_scan(event->scan); break;
                case LogEvent::Kind::kCloud:
                    if (obstacles->scan(*event->cloud, odometry->attitude(), *obstacle_scan)) {
                        visit_scan(*obstacle_scan);
                    }
                    break;
            }
        }
        if (first_damage.empty()) {
            first_damage = log->counts().first_damage;
        }
    }
    if (scans == 0) {
        throw InputError((logs.empty() ? "no log given" : logs.back().string() + ": no usable scan in it") +
                         (first_damage.empty() ? "" : "; first damaged line: " + first_damage) +
                         "; is it a CARMEN log or a URG-04LX .dat?");
    }
}

std::vector<LoggedScan> read_scans(const std::vector<std::filesystem::path>& logs, const Config& config) {
    std::vector<LoggedScan> scans;
    for_each_scan(logs, config, [&scans](double stamp_s, const ScanPoints& points) {
        scans.push_back({.stamp_s = stamp_s, .hits = hits_of(points)});
    });
    return scans;
}

}  // namespace crspf::eval
