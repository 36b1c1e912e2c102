#include "platform/crspfd/watch_board.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "platform/crspfd/control_protocol.hpp"
#include "platform/crspfd/status_json.hpp"
#include "platform/files/base64.hpp"

namespace crspf {

namespace {

using Json = nlohmann::ordered_json;

Json event_json(const char* event) {
    return {{"version", kControlVersion}, {"event", event}};
}

std::string event_line(const Json& event) {
    return event.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json pose_json(const Pose2& P) {
    return {P.x_m, P.y_m, P.theta_rad};
}

void append(std::vector<std::uint8_t>& bytes, float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    for (unsigned shift = 0; shift < 32; shift += 8) {
        bytes.push_back(static_cast<std::uint8_t>((bits >> shift) & 0xFFU));
    }
}

/// x and y of each hit, little-endian.
std::string points_text(const WatchedScan& scan) {
    std::vector<std::uint8_t> bytes;
    bytes.reserve(std::size_t{8} * scan.count);
    for (std::size_t i = 0; i < scan.count; ++i) {
        append(bytes, scan.x_m[i]);
        append(bytes, scan.y_m[i]);
    }
    return to_base64(bytes);
}

std::string critical_text(const WatchedScan& scan) {
    const std::vector<std::uint8_t> bytes(scan.critical.begin(), scan.critical.begin() + scan.count);
    return to_base64(bytes);
}

std::string scan_line(const WatchedScan& scan, std::int64_t stamp_ns, const AnalyserParams& thresholds) {
    const ScanResult& result = scan.result;
    const Covariance3& covariance = result.shape.covariance;
    Json event = event_json("scan");
    event["stamp_ns"] = stamp_ns;
    event["P_map_base"] = pose_json(result.P_map_base);
    event["P_map_odom"] = pose_json(scan.P_map_odom);
    event["covariance"] = {covariance.xx, covariance.xy, covariance.yy, covariance.xt, covariance.yt, covariance.tt};
    event["M"] = result.M;
    event["m"] = result.m;
    event["thresholds"] = analyser_json(thresholds);
    event["matched"] = result.matched;
    event["result"] = result.result;
    event["draw"] = result.draw;
    event["lost"] = result.lost;
    event["degenerate"] = result.shape.degenerate;
    event["rays"] = result.rays;
    event["critical_rays"] = result.critical_rays;
    event["evaluations"] = result.evaluations;
    event["range_m"] = result.range_m;
    event["range_rad"] = result.range_rad;
    event["points"] = points_text(scan);
    event["critical"] = critical_text(scan);
    return event_line(event);
}

const char* level_name(WatchBoard::Level level) {
    switch (level) {
        case WatchBoard::Level::kDebug: return "debug";
        case WatchBoard::Level::kInfo: return "info";
        case WatchBoard::Level::kWarning: return "warning";
        case WatchBoard::Level::kError: break;
    }
    return "error";
}

}  // namespace

void WatchBoard::watched(bool by_somebody) {
    watched_ = by_somebody;
    if (!watched_) {
        scan_.reset();
        scan_line_ = {};
        status_line_ = {};
        map_.begin();
        map_begun_ = false;
    }
}

void WatchBoard::take_scan(const WatchedScan& scan, Duration utc_minus_stamp, const AnalyserParams& thresholds) {
    if (!watched_) {
        return;
    }
    if (scan_ == nullptr) {
        scan_ = std::make_unique<Scan>();
    }
    scan_->scan = scan;
    scan_->stamp_ns = (scan.result.stamp + utc_minus_stamp).ns;
    scan_->thresholds = thresholds;
    scan_line_.clear();
    ++scans_;
}

void WatchBoard::take_status(std::int64_t stamp_ns, const nlohmann::ordered_json& status) {
    if (!watched_) {
        return;
    }
    Json event = event_json("status");
    event["stamp_ns"] = stamp_ns;
    event["status"] = status;
    status_line_ = event_line(event);
    ++statuses_;
}

void WatchBoard::take_log(std::int64_t stamp_ns, Level level, std::string_view text) {
    if (log_.size() == kLogLines) {
        log_.pop_front();
    }
    log_.push_back({.stamp_ns = stamp_ns, .level = level, .text = std::string(text.substr(0, kLogTextMax))});
    ++logged_;
}

void WatchBoard::begin_map(double resolution_m) {
    if (watched_) {
        map_.begin();
        resolution_m_ = resolution_m;
        map_begun_ = true;
    }
}

void WatchBoard::take_tile(Cell corner, const TileCells& cells) {
    if (map_begun_) {
        map_.take(image_of(corner, cells));
    }
}

std::string WatchBoard::next(WatchCursor& cursor) {
    constexpr std::array kKinds{&WatchBoard::next_status, &WatchBoard::next_scan, &WatchBoard::next_tiles,
                                &WatchBoard::next_log};
    for (std::size_t i = 0; i < kKinds.size(); ++i) {
        const auto kind = kKinds[cursor.turn % kKinds.size()];
        cursor.turn = static_cast<std::uint8_t>((cursor.turn + 1U) % kKinds.size());
        if (std::string line = (this->*kind)(cursor); !line.empty()) {
            return line;
        }
    }
    return {};
}

std::string WatchBoard::next_status(WatchCursor& cursor) {
    return std::exchange(cursor.status, statuses_) == statuses_ ? std::string() : status_line_;
}

std::string WatchBoard::next_scan(WatchCursor& cursor) {
    if (scan_ == nullptr || std::exchange(cursor.scan, scans_) == scans_) {
        return {};
    }
    if (scan_line_.empty()) {
        scan_line_ = scan_line(scan_->scan, scan_->stamp_ns, scan_->thresholds);
    }
    return scan_line_;
}

std::string WatchBoard::next_tiles(WatchCursor& cursor) {
    if (!map_begun_ || cursor.change == map_.version()) {
        return {};
    }
    const bool fresh = map_.fresh_for(cursor.change);
    Json event = event_json("tiles");
    event["fresh"] = fresh;
    event["resolution_m"] = resolution_m_;
    Json& tiles = event["tiles"] = Json::array();
    while (tiles.size() < kTilesALine) {
        const TileImage* const tile = map_.next(cursor.change);
        if (tile == nullptr) {
            break;
        }
        tiles.push_back({{"corner", {tile->corner.x, tile->corner.y}}, {"cells", to_base64(tile->cells)}});
    }
    return event_line(event);
}

std::string WatchBoard::next_log(WatchCursor& cursor) {
    const std::uint64_t number = std::max(cursor.log, logged_ - log_.size());
    if (number == logged_) {
        return {};
    }
    cursor.log = number + 1;
    const LogEntry& entry = *(log_.end() - static_cast<std::ptrdiff_t>(logged_ - number));
    Json event = event_json("log");
    event["stamp_ns"] = entry.stamp_ns;
    event["level"] = level_name(entry.level);
    event["text"] = entry.text;
    return event_line(event);
}

}  // namespace crspf
