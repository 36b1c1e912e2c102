// What the service says of itself; docs/service.md describes it.
#include <sys/resource.h>

#include <cstring>
#include <ctime>

#include "platform/crspfd/service.hpp"
#include "platform/crspfd/status_json.hpp"
#include "platform/linux/monotonic_clock.hpp"

namespace crspf {

namespace {

constexpr Duration kStatusShown{500'000'000};  ///< between two looks at the status for those who watch

double microseconds(Duration d) {
    return 1e-3 * static_cast<double>(d.ns);
}

double milliseconds(Duration d) {
    return 1e-6 * static_cast<double>(d.ns);
}

/// [from us, below us, count] of what there is, two steps to a power of two: as fine as is looked at.
nlohmann::ordered_json histogram(const TimeHistogram& times) {
    constexpr std::size_t kStep = 4;
    static_assert(TimeHistogram::kBuckets % kStep == 0);
    nlohmann::ordered_json steps = nlohmann::ordered_json::array();
    for (std::size_t first = 0; first < TimeHistogram::kBuckets; first += kStep) {
        std::uint64_t count = 0;
        for (std::size_t bucket = first; bucket < first + kStep; ++bucket) {
            count += times.count(bucket);
        }
        if (count > 0) {
            steps.push_back({TimeHistogram::begin_of(first), TimeHistogram::end_of(first + kStep - 1), count});
        }
    }
    return steps;
}

}  // namespace

nlohmann::ordered_json Service::pose() {
    refresh();
    const OutputState& out = output_->state.value();
    const PoseReport& report = out.report;
    return {{"x_m", report.P_map_base.x_m},
            {"y_m", report.P_map_base.y_m},
            {"heading_deg", degrees(report.P_map_base.theta_rad)},
            {"speed_mps", report.speed_mps},
            {"yaw_rate_degps", degrees(report.yaw_rate_radps)},
            {"covariance",
             {report.covariance.xx, report.covariance.xy, report.covariance.yy, report.covariance.xt,
              report.covariance.yt, report.covariance.tt}},
            {"age_ms", report.age < kNoScanYet ? nlohmann::ordered_json(milliseconds(report.age)) : nullptr},
            {"M", report.M},
            {"matched", report.matched},
            {"result", report.result},
            {"degenerate", report.degenerate},
            {"lost", report.lost},
            {"resets", report.resets}};
}

nlohmann::ordered_json Service::status() {
    using Json = nlohmann::ordered_json;
    refresh();
    const Stamp now = monotonic_now();
    Json status{{"version", 1}, {"uptime_s", (now - started_).seconds()}};
    status["realtime"] = {{"sched_fifo", realtime_}, {"memory_locked", locked_}};
    status["pose"] = pose();
    for (const Worker& worker : workers_) {
        const TimeHistogram& times = worker.health.times();
        status["threads"].push_back({{"name", worker.name},
                                     {"id", worker.thread.thread_id()},
                                     {"priority", realtime_ ? worker.config.priority : 0},
                                     {"alive", now - worker.health.last_turn() < kStuck},
                                     {"median_below_us", microseconds(times.below(0.5))},
                                     {"p999_below_us", microseconds(times.below(0.999))},
                                     {"max_us", microseconds(times.max())},
                                     {"deadline_us", 1e3 * worker.config.deadline_ms},
                                     {"misses", worker.health.misses()},
                                     {"histogram_us", histogram(times)}});
    }
    for (SourceThread& source : sources_) {
        Json counts = Json::object();
        for (const auto& [name, count] : source.report().counts) {
            counts[name] = count;
        }
        const Stamp last = source.last_sample();
        status["sources"].push_back({{"name", source.config().name},
                                     {"port", source.config().port_text},
                                     {"state", name_of(state_of(source))},
                                     {"says", std::string(source.report().state.view())},
                                     {"samples", source.samples()},
                                     {"age_ms", last > Stamp{} ? Json(milliseconds(now - last)) : Json()},
                                     {"counts", std::move(counts)}});
    }
    const FilterState& filter = exchange_->filter.for_control.value();
    status["filter"] = filter_json(filter.counters, filter.result);
    status["filter"]["skipped"] = filter.skipped_scans;
    status["filter"]["undrawn"] = filter.undrawn;
    status["analyser"] = analyser_json(config_.slam.analyser);
    const PoseSearchState& search = search_->state();
    status["relocalization"] = {{"searching", search.searching},
                                {"searches", search.searches},
                                {"found", search.found},
                                {"last", search.last_words},
                                {"verdict", verdict_name(search.last.verdict)},
                                {"last_s", search.last_s}};
    const OdometryState& odometry = exchange_->odometry.for_control.value();
    status["odometry"] = {
        {"samples", odometry.counters.samples},
        {"blind_s", odometry.blind_since > Stamp{} ? (now - odometry.blind_since).seconds() : 0.0},
        {"not_finite", odometry.counters.not_finite},
        {"ran_back", odometry.counters.ran_back},
        {"gaps", odometry.counters.gaps},
        {"implausible", odometry.counters.implausible},
        {"askew", odometry.counters.askew},
        {"lost_to_full_rings", exchange_->motions.rejected() + exchange_->motions_to_filter.rejected()}};
    const MapState& map = exchange_->map.value();
    const TileArchiveState far = far_tiles_.state();
    status["map"] = {{"drawn", map.counters.drawn},
                     {"tiles", map.tiles},
                     {"tiles_on_disk", far.tiles - far.in_memory},
                     {"tiles_brought_back", far.brought_back},
                     {"tiles_lost", far.lost},
                     {"tiles_max", capacity::kTiles},
                     {"refused", map.refused},
                     {"directory", config_.service.state_directory},
                     {"problem", save_problem_.empty() ? far.problem : save_problem_}};
    const OutputState& out = output_->state.value();
    status["output"] = {{"interface", config_.pose_output.can},
                        {"poses", out.counters.poses},
                        {"lost", out.counters.lost},
                        {"jumps", out.counters.jumps},
                        {"unsent", out.unsent},
                        {"bus_open", out.bus_open},
                        {"bus_error", out.bus_open || out.bus_error == 0 ? "" : ::strerrordesc_np(out.bus_error)},
                        {"bus_offs", out.bus.bus_offs},
                        {"send_timeouts", out.bus.send_timeouts},
                        {"queue_full", out.bus.queue_full}};
    if (recorder_ != nullptr) {
        const RunRecorderState recorded = recorder_->state();
        status["recording"] = {{"file", recorded.file.string()},
                               {"written", recorded.counters.written},
                               {"lost", recorded.counters.lost},
                               {"unrecorded", recorded.unrecorded},
                               {"problem", recorded.problem}};
    }
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    // NOLINTBEGIN(cppcoreguidelines-pro-type-union-access): glibc declares the fields so
    status["process"] = {{"cpu_s", static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
                                       1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec)},
                         {"rss_max_kib", usage.ru_maxrss},
                         {"minor_faults", usage.ru_minflt},
                         {"major_faults", usage.ru_majflt}};
    // NOLINTEND(cppcoreguidelines-pro-type-union-access)
    return status;
}

void Service::show(WatchBoard& board) {
    const Stamp now = monotonic_now();
    const Duration utc_minus_stamp = clock_now(CLOCK_REALTIME) - now;
    if (watch_feed_->turn(now, utc_minus_stamp, board)) {
        map_wakeup_.notify();
    }
    if (board.watched() && now - status_shown_ >= kStatusShown) {
        status_shown_ = now;
        board.take_status((now + utc_minus_stamp).ns, status());
    }
}

}  // namespace crspf
