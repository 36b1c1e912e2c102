#include "tools/crspf/replay.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <bit>
#include <climits>
#include <cmath>
#include <cstddef>
#include <ctime>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>
#include <utility>

#include "platform/files/atomic_file.hpp"
#include "platform/files/input_error.hpp"
#include "platform/files/png_image.hpp"
#include "platform/files/sha256.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "platform/service/open_run.hpp"

namespace crspf {
namespace {

double processor_time_s(clockid_t clock) {
    timespec t{};
    clock_gettime(clock, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

void add(LogCounts& sum, const LogCounts& part) {
    sum.lines += part.lines;
    sum.scans += part.scans;
    sum.odometry += part.odometry;
    sum.ignored_lines += part.ignored_lines;
    sum.damaged_lines += part.damaged_lines;
    sum.stamp_jumps += part.stamp_jumps;
    sum.invalid_beams += part.invalid_beams;
    sum.no_return_beams += part.no_return_beams;
    if (sum.first_damage.empty()) {
        sum.first_damage = part.first_damage;
    }
}

/// Holds a replay back to a multiple of the recorded pace.
class Pacer {
 public:
    explicit Pacer(double rate) : rate_(rate) {}

    void wait_for(Stamp stamp) {
        if (rate_ <= 0.0) {
            return;
        }
        if (!begun_) {
            begun_ = true;
            first_ = stamp;
            start_ = monotonic_now();
        }
        sleep_until(start_ + Duration::from_seconds((stamp - first_).seconds() / rate_));
    }

 private:
    double rate_;
    bool begun_ = false;
    Stamp first_;
    Stamp start_;
};

void load_map(const std::filesystem::path& yaml, double resolution_m, Pipeline& slam) {
    const GridMap map = read_grid_map(yaml);
    // The map's cells are painted onto ours, whatever their size and turn: each of ours takes the one it lies in.
    const Pose2 P_origin_map = inverse(map.P_map_origin);
    const double width_m = map.width * map.resolution_m;
    const double height_m = map.height * map.resolution_m;
    double low_x = 1e300;
    double low_y = 1e300;
    double high_x = -1e300;
    double high_y = -1e300;
    for (const auto& [x, y] :
         std::array<std::array<double, 2>, 4>{{{0.0, 0.0}, {width_m, 0.0}, {0.0, height_m}, {width_m, height_m}}}) {
        const Pose2 corner = map.P_map_origin * Pose2{.x_m = x, .y_m = y, .theta_rad = 0.0};
        low_x = std::min(low_x, corner.x_m);
        low_y = std::min(low_y, corner.y_m);
        high_x = std::max(high_x, corner.x_m);
        high_y = std::max(high_y, corner.y_m);
    }
    constexpr double kExtent = TileGeometry::kHalf;
    if (low_x < -kExtent * resolution_m || low_y < -kExtent * resolution_m || high_x > kExtent * resolution_m ||
        high_y > kExtent * resolution_m) {
        throw InputError(yaml.string() + ": the map reaches " + std::to_string(kExtent * resolution_m) +
                         " m or more from the origin; raise [map] resolution_m or capacity::kDirectoryTiles");
    }
    const auto cell = [resolution_m](double v) { return static_cast<std::int32_t>(std::floor(v / resolution_m)); };
    for (std::int32_t y = cell(low_y); y <= cell(high_y); ++y) {
        for (std::int32_t x = cell(low_x); x <= cell(high_x); ++x) {
            const Pose2 middle{.x_m = (x + 0.5) * resolution_m, .y_m = (y + 0.5) * resolution_m, .theta_rad = 0.0};
            const Pose2 in_map = P_origin_map * middle;
            const int column = static_cast<int>(std::floor(in_map.x_m / map.resolution_m));
            const int row = static_cast<int>(std::floor(in_map.y_m / map.resolution_m));
            if (!map.contains(column, row)) {
                continue;
            }
            switch (map.at(column, row)) {
                case GridCell::kFree: slam.set_cell({.x = x, .y = y}, kFreeCell); break;
                case GridCell::kOccupied: slam.set_cell({.x = x, .y = y}, kOccupiedCell); break;
                case GridCell::kUnknown: break;
            }
        }
    }
    if (slam.map().refused() > 0) {
        throw InputError(yaml.string() + ": the map has more than the " + std::to_string(capacity::kTiles) +
                         " tiles of config/capacities.hpp; raise [map] resolution_m or capacity::kTiles");
    }
}

std::string digest_of(std::span<const TimedPose> trajectory) {
    Sha256 sha;
    for (const TimedPose& pose : trajectory) {
        std::array<std::byte, 24> bytes{};
        std::size_t at = 0;
        for (const double v : {pose.P_map_base.x_m, pose.P_map_base.y_m, pose.P_map_base.theta_rad}) {
            const auto bits = std::bit_cast<std::uint64_t>(v);
            for (unsigned shift = 0; shift < 64; shift += CHAR_BIT) {
                bytes.at(at++) = static_cast<std::byte>(bits >> shift);
            }
        }
        sha.update(bytes);
    }
    return sha.hex();
}

double peak_rss_mib() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-union-access): glibc declares the field so
    return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

double quantile(std::vector<float> values, double share) {
    if (values.empty()) {
        return 0.0;
    }
    std::sort(values.begin(), values.end());
    const auto last = static_cast<double>(values.size() - 1);
    return static_cast<double>(values[static_cast<std::size_t>(std::lround(share * last))]);
}

double mean(std::span<const float> values) {
    double sum = 0.0;
    for (const float v : values) {
        sum += static_cast<double>(v);
    }
    return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

}  // namespace

ReplayOutcome run_replay(const ReplayJob& job) {
    ReplayOutcome out;
    const double began_s = processor_time_s(CLOCK_PROCESS_CPUTIME_ID);
    Run run = open_run(job.logs, job.config);
    out.config = run.config;
    SlamParams params = run.config.slam;
    params.localize_only = job.localize.has_value();
    out.pipeline = std::make_unique<Pipeline>(params, job.kernel);
    Pipeline& slam = *out.pipeline;
    if (job.localize) {
        load_map(*job.localize, params.map.resolution_m, slam);
    }
    if (job.initial_pose) {
        slam.set_pose(*job.initial_pose);
    }

    const auto event = std::make_unique<LogEvent>();
    Duration origin;  // each log's time line starts at 0: they are laid end to end
    Stamp newest;
    double since_scan_s = 0.0;
    Pacer pacer(job.rate);
    for (std::size_t i = 0; i < run.parts.size(); ++i) {
        const std::unique_ptr<LogReader> log = std::move(run.parts[i]);
        while (log->next(*event)) {
            Stamp& stamp = stamp_of(*event);
            stamp = stamp + origin;
            newest = std::max(newest, stamp);
            pacer.wait_for(stamp);
            const double start_s = processor_time_s(CLOCK_THREAD_CPUTIME_ID);
            switch (event->kind) {
                case LogEvent::Kind::kMotion: slam.on_motion(event->motion); break;
                case LogEvent::Kind::kDifferential: slam.on_wheel(event->differential); break;
                case LogEvent::Kind::kAckermann: slam.on_wheel(event->ackermann); break;
                case LogEvent::Kind::kImu: slam.on_imu(event->imu); break;
                case LogEvent::Kind::kScan: {
                    const ScanResult result = slam.on_scan(event->scan);
                    out.trajectory.push_back({.stamp_s = event->recorded_stamp_s, .P_map_base = result.P_map_base});
                    out.M.push_back(static_cast<float>(result.M));
                    break;
                }
            }
            since_scan_s += processor_time_s(CLOCK_THREAD_CPUTIME_ID) - start_s;
            if (event->kind == LogEvent::Kind::kScan) {
                out.time_per_scan_ms.push_back(static_cast<float>(1e3 * since_scan_s));
                since_scan_s = 0.0;
                constexpr std::size_t kScansPerReport = 64;
                if (job.progress && out.trajectory.size() % kScansPerReport == 0) {
                    job.progress((static_cast<double>(i) + log->progress()) / static_cast<double>(run.parts.size()),
                                 out.trajectory.size());
                }
            }
        }
        add(out.log, log->counts());
        for (SourceReport& source : log->sources()) {
            out.sources.push_back(std::move(source));
        }
        origin = newest - Stamp{};
    }
    if (out.trajectory.empty()) {
        std::string what = job.logs.empty() ? "no log given" : job.logs.back().string() + ": no usable scan in it";
        if (!out.log.first_damage.empty()) {
            what += "; first of " + std::to_string(out.log.damaged_lines) + " damaged lines: " + out.log.first_damage;
        }
        for (const SourceReport& source : out.sources) {
            what += "; " + text_of(source);
        }
        throw InputError(what + "; is it a CARMEN log, a URG-04LX .dat or a recording of a lidar?");
    }
    out.digest = digest_of(out.trajectory);
    out.cpu_s = processor_time_s(CLOCK_PROCESS_CPUTIME_ID) - began_s;
    return out;
}

GridMap export_map(const OccupancyMap& map, double resolution_m) {
    constexpr std::int32_t kHalf = TileGeometry::kHalf;
    std::int32_t low_x = kHalf;
    std::int32_t low_y = kHalf;
    std::int32_t high_x = -kHalf;
    std::int32_t high_y = -kHalf;
    map.for_each_tile([&](Cell corner, const OccupancyTile&) {
        low_x = std::min(low_x, corner.x);
        low_y = std::min(low_y, corner.y);
        high_x = std::max(high_x, corner.x + TileGeometry::kSide);
        high_y = std::max(high_y, corner.y + TileGeometry::kSide);
    });
    GridMap out;
    if (high_x < low_x) {  // nothing seen: one unknown cell, so that the file is still a map
        high_x = low_x = high_y = low_y = 0;
        ++high_x;
        ++high_y;
    }
    out.width = high_x - low_x;
    out.height = high_y - low_y;
    out.resolution_m = resolution_m;
    out.P_map_origin = {.x_m = low_x * resolution_m, .y_m = low_y * resolution_m, .theta_rad = 0.0};
    out.cells.assign(static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height), GridCell::kUnknown);
    map.for_each_tile([&](Cell corner, const OccupancyTile& tile) {
        for (std::int32_t y = 0; y < TileGeometry::kSide; ++y) {
            const std::size_t row =
                static_cast<std::size_t>(corner.y + y - low_y) * static_cast<std::size_t>(out.width);
            for (std::int32_t x = 0; x < TileGeometry::kSide; ++x) {
                const Evidence e = tile.cells[TileGeometry::offset({.x = x, .y = y})];
                if (e != kUnseen) {
                    out.cells[row + static_cast<std::size_t>(corner.x + x - low_x)] =
                        e >= kOccupiedFrom ? GridCell::kOccupied : GridCell::kFree;
                }
            }
        }
    });
    return out;
}

std::string write_replay(const ReplayOutcome& outcome, const ReplayJob& job, const std::filesystem::path& directory) {
    std::error_code error;
    std::filesystem::create_directories(directory, error);
    if (error) {
        throw InputError(directory.string() + ": cannot make the directory: " + error.message());
    }
    const Pipeline& slam = *outcome.pipeline;
    write_tum(outcome.trajectory, directory / "trajectory.tum");
    {
        const GridMap map = export_map(slam.map(), outcome.config.slam.map.resolution_m);
        write_grid_map(map, directory / "map");
        constexpr int kPictureSide_px = 2000;
        write_png(draw_map(map, outcome.trajectory, kPictureSide_px), directory / "map.png");
    }

    const PipelineCounters& c = slam.counters();
    const OdometryCounters& o = slam.odometry().counters();
    const MapUpdateCounters& m = slam.map_counters();
    const std::vector<float>& ms = outcome.time_per_scan_ms;
    const auto scans = static_cast<double>(outcome.trajectory.size());
    nlohmann::ordered_json report;
    for (const std::filesystem::path& log : job.logs) {
        report["logs"].push_back(log.string());
    }
    report["scans"] = outcome.trajectory.size();
    report["digest"] = outcome.digest;
    report["time_per_scan_ms"] = {{"mean", mean(ms)},
                                  {"p50", quantile(ms, 0.5)},
                                  {"p99", quantile(ms, 0.99)},
                                  {"p999", quantile(ms, 0.999)},
                                  {"max", quantile(ms, 1.0)}};
    report["cpu_ms_per_scan_everything"] = 1e3 * outcome.cpu_s / scans;
    report["evaluations_per_scan"] = {{"mean", static_cast<double>(c.evaluations) / scans}};
    report["match_value_M"] = {{"p01", quantile(outcome.M, 0.01)},
                               {"p10", quantile(outcome.M, 0.1)},
                               {"p50", quantile(outcome.M, 0.5)},
                               {"p90", quantile(outcome.M, 0.9)}};
    report["pipeline"] = {
        {"matched", c.matched},         {"key_frames", c.key_frames},     {"drawn", c.drawn},
        {"degenerate", c.degenerate},   {"not_believed", c.not_believed}, {"too_few_rays", c.too_few_rays},
        {"outside_map", c.outside_map}, {"cells_erased", m.cells_erased}};
    report["odometry"] = {{"samples", o.samples}, {"not_finite", o.not_finite},   {"ran_back", o.ran_back},
                          {"gaps", o.gaps},       {"implausible", o.implausible}, {"out_of_history", o.out_of_history}};
    report["log"] = {{"lines", outcome.log.lines},
                     {"ignored_lines", outcome.log.ignored_lines},
                     {"damaged_lines", outcome.log.damaged_lines},
                     {"stamp_jumps", outcome.log.stamp_jumps},
                     {"invalid_beams", outcome.log.invalid_beams},
                     {"no_return_beams", outcome.log.no_return_beams}};
    for (const SourceReport& source : outcome.sources) {
        nlohmann::ordered_json& one = report["sources"][source.name];
        one["records"] = source.records;
        for (const auto& [name, count] : source.counts) {
            one[name] = count;
        }
    }
    report["map"] = {{"resolution_m", outcome.config.slam.map.resolution_m},
                     {"tiles", slam.map().tiles()},
                     {"tiles_capacity", capacity::kTiles},
                     {"writes_refused", slam.map().refused()},
                     {"changes_refused", slam.changes_refused()}};
    report["state_size_mib"] = static_cast<double>(sizeof(Pipeline)) / (1024.0 * 1024.0);
    report["peak_rss_mib"] = peak_rss_mib();
    std::string text = report.dump(2) + "\n";
    AtomicFile file(directory / "report.json");
    file.write(text);
    file.commit();
    return text;
}

}  // namespace crspf
