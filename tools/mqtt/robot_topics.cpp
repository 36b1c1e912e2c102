#include "tools/mqtt/robot_topics.hpp"

#include <variant>

#include "platform/files/input_error.hpp"
#include "tools/mqtt/payloads.hpp"

namespace crspf::mqtt {
namespace {

/// What subscribers' patterns, and brokers themselves, have a meaning of their own for.
void demand_topic(const char* option, const std::string& text, const char* forbidden) {
    constexpr std::size_t kLongest = 128;
    const bool control = text.find_first_of(std::string("\0\t\n\r", 4)) != std::string::npos;
    if (text.empty() || text.size() > kLongest || text.front() == '$' || text.front() == '/' || text.back() == '/' ||
        control || text.find_first_of(forbidden) != std::string::npos) {
        throw InputError(std::string(option) + " \"" + text +
                         "\": cannot stand in a topic; 1 to 128 characters, none of " + forbidden +
                         ", and no $ or / at its beginning");
    }
}

}  // namespace

RobotTopics::RobotTopics(TopicOptions options, Moment begun)
    : options_(std::move(options)), pose_pace_(Duration::from_seconds(1.0 / options_.pose_hz)), log_ns_(begun.utc_ns) {
    demand_topic("--prefix", options_.prefix, "+#");
    demand_topic("--robot", options_.robot, "+#/");
}

std::string RobotTopics::topic(const std::string& leaf) const {
    return options_.prefix + "/" + options_.robot + "/" + leaf;
}

Publication RobotTopics::kept(const std::string& leaf, const nlohmann::ordered_json& payload) const {
    return {.topic = topic(leaf), .payload = text_of(payload), .acknowledged = true, .retained = true};
}

Publication RobotTopics::online(bool yes) const {
    return kept("online", yes);
}

void RobotTopics::take(const view::RunEvent& event, Moment moment) {
    if (const auto* const scan = std::get_if<view::ScanEvent>(&event)) {
        health_.take(*scan, moment.now);
        pose_ = pose_of_scan(*scan);
    } else if (const auto* const status = std::get_if<view::StatusEvent>(&event)) {
        health_.take(*status);
        if (!health_.scans_come(moment.now)) {
            pose_ = pose_of_status(*status);
        }
    } else if (const auto* const away = std::get_if<view::AwayEvent>(&event)) {
        health_.take(*away);
    } else if (const auto* const tiles = std::get_if<view::TilesEvent>(&event)) {
        if (tiles->fresh || tiles_.version() == 0) {
            constexpr std::int64_t kMillisecond_ns = 1'000'000;  // so that it is a whole number in JavaScript, too
            map_id_ = moment.utc_ns / kMillisecond_ns;
        }
        tiles_.take(*tiles);
    } else if (const auto* const line = std::get_if<view::LogLine>(&event)) {
        take_log(*line);
    }
}

void RobotTopics::take_log(const view::LogLine& line) {
    if (line.level < view::LogLine::Level::kWarning || line.stamp_ns <= log_ns_) {
        return;
    }
    log_ns_ = line.stamp_ns;
    log_.push_back(log_payload(line));
    if (log_.size() > kLogMax) {
        log_.pop_front();
        ++log_lost_;
    }
}

void RobotTopics::begin() {
    online_told_ = false;
    gist_told_ = nullptr;
    reader_ = reads_until_ = 0;
}

std::optional<Publication> RobotTopics::next(Moment moment) {
    if (!online_told_) {
        online_told_ = true;
        return online(true);
    }
    if (auto found = next_health(moment)) {
        return found;
    }
    if (auto found = next_pose(moment.now)) {
        return found;
    }
    if (auto found = next_log()) {
        return found;
    }
    return next_map(moment.now);
}

std::optional<Publication> RobotTopics::next_health(Moment moment) {
    if (!health_.known()) {
        return std::nullopt;
    }
    nlohmann::ordered_json gist = health_.gist(moment.now);
    const bool changed = gist != gist_told_ && (gist_told_.is_null() || health_change_pace_.due(moment.now));
    if (!changed && !health_pace_.due(moment.now)) {
        return std::nullopt;
    }
    gist_told_ = std::move(gist);
    health_pace_.done(moment.now);
    health_change_pace_.done(moment.now);
    nlohmann::ordered_json payload = health_.payload(moment.now, moment.utc_ns, options_.version);
    if (log_lost_ > 0) {
        payload["counters"]["mqtt.log_lost"] = log_lost_;
    }
    return kept("health", payload);
}

std::optional<Publication> RobotTopics::next_pose(Stamp now) {
    if (pose_.is_null() || !pose_pace_.due(now)) {
        return std::nullopt;
    }
    pose_pace_.done(now);
    return Publication{.topic = topic("pose"), .payload = text_of(std::exchange(pose_, nullptr))};
}

std::optional<Publication> RobotTopics::next_log() {
    if (log_.empty()) {
        return std::nullopt;
    }
    Publication line{.topic = topic("log"), .payload = text_of(log_.front()), .acknowledged = true};
    log_.pop_front();
    return line;
}

std::optional<Publication> RobotTopics::next_map(Stamp now) {
    const ShownMap& map = tiles_.map();
    if (map.fresh_for(reader_)) {
        old_.merge(at_broker_);
        at_broker_.clear();
        reads_until_ = map.version();
        map_pace_.done(now);
        return kept("map", map_payload(map_id_, tiles_.resolution_m()));
    }
    if (reader_ >= reads_until_) {
        if (!map_pace_.due(now)) {
            return std::nullopt;
        }
        if (map.version() == reader_) {
            return next_old_tile();
        }
        reads_until_ = map.version();
        map_pace_.done(now);
    }
    const TileImage* const image = map.next(reader_);
    if (image == nullptr) {
        reader_ = reads_until_;
        return std::nullopt;
    }
    const TileName name{image->corner.x / TileGeometry::kSide, image->corner.y / TileGeometry::kSide};
    at_broker_.insert(name);
    old_.erase(name);
    return kept("map/" + std::to_string(name.first) + "/" + std::to_string(name.second),
                tile_payload(map_id_, tiles_.resolution_m(), *image));
}

std::optional<Publication> RobotTopics::next_old_tile() {
    if (old_.empty()) {
        return std::nullopt;
    }
    const TileName name = old_.extract(old_.begin()).value();
    Publication nothing = kept("map/" + std::to_string(name.first) + "/" + std::to_string(name.second), nullptr);
    nothing.payload.clear();
    return nothing;
}

}  // namespace crspf::mqtt
