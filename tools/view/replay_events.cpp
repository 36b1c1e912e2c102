#include "tools/view/replay_events.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "config/capacities.hpp"
#include "core/base/trig.hpp"
#include "platform/crspfd/status_json.hpp"
#include "tools/crspf/run_report.hpp"

namespace crspf::view {
namespace {

/// A time that a clock may have shown: until 2106, as far as ROS's 32 bits of seconds go.
std::int64_t believed_ns(double utc_s) {
    constexpr double kEnd_s = 4'294'967'295.0;
    return utc_s >= 0.0 && utc_s <= kEnd_s ? std::llround(utc_s * 1e9) : 0;
}

bool due(const std::optional<Stamp>& last, Stamp now, Duration every) {
    return !last || now - *last >= every;
}

nlohmann::ordered_json sources_of(const RunPlayer& player) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const SourceReport& source : player.sources()) {
        nlohmann::ordered_json counts = nlohmann::ordered_json::object();
        for (const auto& [name, count] : source.counts) {
            counts[name] = count;
        }
        all.push_back({{"name", source.name}, {"samples", source.records}, {"counts", std::move(counts)}});
    }
    return all;
}

}  // namespace

ReplayEvents::ReplayEvents(const Config& config)
    : thresholds_(config.slam.analyser), tiles_(config.slam.map.resolution_m) {}

void ReplayEvents::on_scan(const RunPlayer& player, const ScanResult& result, const Out& out) {
    if (!std::exchange(begun_, true)) {
        begin(player, result);
    }
    newest_ = std::max(newest_, result.stamp);
    if (due(tiles_told_, newest_, kTilesEvery)) {
        tiles_told_ = newest_;
        const TilesEvent tiles = tiles_.look(player.pipeline().map(), nullptr);
        if (tiles.fresh || !tiles.tiles.empty()) {
            out(tiles);
        }
    }
    out(scan_event(player, result));
    tell_of_changes(player, result, out);
    if (due(status_told_, newest_, kStatusEvery)) {
        status_told_ = newest_;
        out(status_event(player, result));
    }
    last_ = result;
}

void ReplayEvents::on_end(RunPlayer& player, const Out& out) {
    const TilesEvent tiles = tiles_.look(player.pipeline().map(), &player.far_tiles());
    if (tiles.fresh || !tiles.tiles.empty()) {
        out(tiles);
    }
    if (begun_) {
        out(status_event(player, last_));
    }
}

void ReplayEvents::begin(const RunPlayer& player, const ScanResult& result) {
    first_ = newest_ = result.stamp;
    utc_of_zero_ns_ = believed_ns(player.recorded_stamp_s()) - result.stamp.ns;
}

ScanEvent ReplayEvents::scan_event(const RunPlayer& player, const ScanResult& result) const {
    const Pipeline& slam = player.pipeline();
    ScanEvent event{.stamp_ns = utc_ns(newest_),
                    .P_map_base = result.P_map_base,
                    .P_map_odom = slam.odometry().P_map_odom(),
                    .covariance = result.shape.covariance,
                    .M = result.M,
                    .m = result.m,
                    .thresholds = thresholds_,
                    .matched = result.matched,
                    .result = result.result,
                    .draw = result.draw,
                    .lost = result.lost,
                    .degenerate = result.shape.degenerate,
                    .rays = result.rays,
                    .critical_rays = result.critical_rays,
                    .evaluations = result.evaluations,
                    .range_m = result.range_m,
                    .range_rad = result.range_rad,
                    .points = {}};
    const ScanPoints& points = slam.points();
    const std::span<const bool> critical = slam.critical();
    event.points.reserve(points.count);
    for (std::size_t i = 0; i < points.count; ++i) {
        event.points.push_back({.x_m = points.x_m[i], .y_m = points.y_m[i], .critical = critical[i]});
    }
    return event;
}

/// Under the names of the service's document (docs/service.md), as far as a replay has the like.
StatusEvent ReplayEvents::status_event(const RunPlayer& player, const ScanResult& result) const {
    const Pipeline& slam = player.pipeline();
    nlohmann::ordered_json status{{"version", 1},
                                  {"replay", {{"position_s", position_s()}, {"share", player.share()}}}};
    status["pose"] = {{"x_m", result.P_map_base.x_m},
                      {"y_m", result.P_map_base.y_m},
                      {"heading_deg", degrees(result.P_map_base.theta_rad)},
                      {"M", result.M},
                      {"matched", result.matched},
                      {"result", result.result},
                      {"degenerate", result.shape.degenerate},
                      {"lost", result.lost}};
    status["sources"] = sources_of(player);
    status["filter"] = filter_json(slam.counters(), result);
    status["filter"]["core_ms"] = 1e3 * player.core_s();
    status["analyser"] = analyser_json(thresholds_);
    status["odometry"] = to_json(slam.odometry().counters());
    status["log"] = to_json(player.counts());
    status["map"] = {{"drawn", slam.map_counters().drawn},
                     {"tiles", slam.map().tiles()},
                     {"tiles_max", capacity::kTiles},
                     {"refused", slam.map().refused()}};
    return {.stamp_ns = utc_ns(newest_), .status = std::move(status)};
}

void ReplayEvents::tell_of_changes(const RunPlayer& player, const ScanResult& result, const Out& out) {
    const auto tell = [&](LogLine::Level level, const std::string& text) {
        out(LogLine{.stamp_ns = utc_ns(newest_), .level = level, .text = text});
    };
    if (result.lost != last_.lost) {
        tell(result.lost ? LogLine::Level::kWarning : LogLine::Level::kInfo,
             result.lost ? "the robot is lost: scans do not match the map" : "the robot is found");
    }
    if (damaged_told_ == 0) {
        const LogCounts counts = player.counts();
        damaged_told_ = counts.damaged_lines;
        if (damaged_told_ > 0) {
            tell(LogLine::Level::kWarning, "the recording is damaged, first: " + counts.first_damage);
        }
    }
}

}  // namespace crspf::view
