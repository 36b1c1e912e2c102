#include "tools/crspf/replay.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <system_error>

#include "core/base/trig.hpp"
#include "platform/files/atomic_file.hpp"
#include "platform/files/input_error.hpp"
#include "platform/files/png_image.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "platform/service/map_image.hpp"
#include "tools/crspf/pose_digest.hpp"
#include "tools/crspf/run_player.hpp"
#include "tools/crspf/run_report.hpp"

namespace crspf {
namespace {

double process_time_s() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
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
    const double began_s = process_time_s();
    RunPlayer player(job);
    out.config = player.config();
    Pacer pacer(job.rate);
    while (const LogEvent* const event = player.next()) {
        pacer.wait_for(stamp_of(*event));
        const std::optional<ScanResult> result = player.play();
        if (!result) {
            continue;
        }
        if (job.on_result) {
            job.on_result(event->kind == LogEvent::Kind::kScan ? &event->scan : nullptr, *result);
        }
        if (event->live) {
            ++(event->live->P_map_base == result->P_map_base ? out.live_same : out.live_other);
        }
        out.trajectory.push_back({.stamp_s = player.recorded_stamp_s(), .P_map_base = result->P_map_base});
        out.M.push_back(static_cast<float>(result->M));
        out.time_per_scan_ms.push_back(static_cast<float>(1e3 * player.core_s()));
        constexpr std::size_t kScansPerReport = 64;
        if (job.progress && out.trajectory.size() % kScansPerReport == 0) {
            job.progress(player.share(), out.trajectory.size());
        }
    }
    if (out.trajectory.empty()) {
        throw player.without_scans();
    }
    out.log = player.counts();
    out.sources = player.sources();
    out.pipeline = player.take_pipeline();
    out.far_tiles = player.take_far_tiles();
    out.digest = digest_of(out.trajectory);
    out.cpu_s = process_time_s() - began_s;
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
        const GridMap map = export_map(slam.map(), outcome.config.slam.map.resolution_m, outcome.far_tiles.get());
        write_grid_map(map, directory / "map");
        constexpr int kPictureSide_px = 2000;
        write_png(draw_map(map, outcome.trajectory, kPictureSide_px), directory / "map.png");
    }

    const LocalizerCounters& c = slam.counters();
    const MapUpdateCounters& m = slam.map_counters();
    const std::vector<float>& ms = outcome.time_per_scan_ms;
    const auto scans = static_cast<double>(outcome.trajectory.size());
    nlohmann::ordered_json report;
    for (const std::filesystem::path& log : job.logs) {
        report["logs"].push_back(log.string());
    }
    report["scans"] = outcome.trajectory.size();
    report["digest"] = outcome.digest;
    if (outcome.live_same + outcome.live_other > 0) {
        report["live_poses"] = {{"same", outcome.live_same}, {"other", outcome.live_other}};
    }
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
    report["pipeline"] = {{"matched", c.matched},
                          {"key_frames", c.key_frames},
                          {"drawn", c.to_draw},
                          {"lost", c.lost},
                          {"degenerate", c.degenerate},
                          {"stood", c.stood},
                          {"not_believed", c.not_believed},
                          {"too_few_rays", c.too_few_rays},
                          {"outside_map", c.outside_map},
                          {"cells_erased", m.cells_erased}};
    report["odometry"] = to_json(slam.odometry().counters());
    if (const InertialCounters& i = slam.odometry().inertial_counters();
        i.samples > 0 || slam.odometry().yaw_rate_bias_radps() != 0.0) {
        report["imu"] = {{"yaw_rate_bias_degps", degrees(slam.odometry().yaw_rate_bias_radps())},
                         {"six_axes", i.samples},
                         {"damaged", i.damaged},
                         {"gaps", i.gaps},
                         {"stuck", i.stuck}};
    }
    report["log"] = to_json(outcome.log);
    if (!outcome.sources.empty()) {
        report["sources"] = to_json(outcome.sources);
    }
    const TileArchiveState far = outcome.far_tiles->state();
    report["map"] = {{"resolution_m", outcome.config.slam.map.resolution_m},
                     {"tiles", slam.map().tiles()},
                     {"tiles_capacity", capacity::kTiles},
                     {"tiles_on_disk", far.tiles - far.in_memory},
                     {"tiles_brought_back", far.brought_back},
                     {"tiles_lost", far.lost},
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
