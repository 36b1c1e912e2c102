#include "tools/mqtt/robot_health.hpp"

#include "tools/view/status_parts.hpp"
#include "tools/view/troubles.hpp"

namespace crspf::mqtt {

using Json = nlohmann::ordered_json;

RobotHealth::RobotHealth() = default;  // not in the class, where it would promise not to throw

void RobotHealth::take(const view::ScanEvent& scan, Stamp now) {
    scanned_ = true;
    scan_at_ = now;
    scan_lost_ = scan.lost;
    degenerate_ = scan.degenerate;
    matched_ = scan.matched;
}

void RobotHealth::take(const view::StatusEvent& status) {
    known_ = true;
    away_ = false;
    status_ = status.status;
    service_lost_ = view::says(view::part_of(status_, "pose"), "lost", true);
}

void RobotHealth::take(const view::AwayEvent& event) {
    if (!event.away) {
        return;  // its first status tells that it is back, and how it is
    }
    known_ = away_ = true;
    why_ = event.why;
    status_ = nullptr;
    scanned_ = scan_lost_ = service_lost_ = false;
}

const char* RobotHealth::word(Stamp now) const {
    if (away_) {
        return "Service away";
    }
    if (scan_lost_ || service_lost_) {
        return "LOST";
    }
    if (!scanned_) {
        return "Waiting for a scan";
    }
    if (!scans_come(now)) {
        return "No scans";
    }
    if (degenerate_) {
        return "One direction unseen";
    }
    return matched_ ? "Tracking" : "Odometry only";
}

Json RobotHealth::gist(Stamp now) const {
    Json gist = Json::array({word(now), away_ ? why_ : ""});
    for (const Json& source : view::part_of(status_, "sources")) {
        gist.push_back(view::text_at(source, "name"));
        gist.push_back(view::text_at(source, "state"));
    }
    return gist;
}

Json RobotHealth::payload(Stamp now, std::int64_t utc_ns, const std::string& version) const {
    Json payload{{"stamp_ns", utc_ns}, {"state", word(now)}, {"service", !away_}, {"why", away_ ? why_ : ""}};
    Json versions{{"crspf", version}};
    if (!away_) {
        const Json& pose = view::part_of(status_, "pose");
        const Json& map = view::part_of(status_, "map");
        payload["uptime_s"] = view::part_of(status_, "uptime_s");
        payload["M"] = view::part_of(pose, "M");
        payload["result"] = view::says(pose, "result", true);
        Json sensors = Json::array();
        for (const Json& source : view::part_of(status_, "sources")) {
            sensors.push_back({{"name", view::text_at(source, "name")},
                               {"state", view::text_at(source, "state")},
                               {"says", view::text_at(source, "says")}});
        }
        payload["sensors"] = sensors;
        payload["map"] = {{"tiles", view::part_of(map, "tiles")}, {"tiles_max", view::part_of(map, "tiles_max")}};
        payload["counters"] = view::troubles_of(status_);
        versions["status"] = view::part_of(status_, "version");
    }
    payload["versions"] = versions;
    return payload;
}

}  // namespace crspf::mqtt
