#include "tools/view/channels.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "platform/files/base64.hpp"
#include "tests/unit/view/view_events.hpp"
#include "tools/view/channel_schemas.hpp"

using namespace crspf::view;
using namespace crspf::view::test;
using nlohmann::json;

namespace {

/// What of the JSON schemas ours use: what is missing, or of another type, is named.
// NOLINTNEXTLINE(misc-no-recursion): as deep as our own schemas
std::string flaw(const json& schema, const json& value, const std::string& at = "message") {
    if (schema.contains("oneOf")) {
        const bool found = std::any_of(schema["oneOf"].begin(), schema["oneOf"].end(),
                                       [&value](const json& choice) { return choice["const"] == value; });
        return found ? "" : at + " is none of the choices";
    }
    const std::string type = schema["type"];
    const bool fits = type == "object"    ? value.is_object()
                      : type == "array"   ? value.is_array()
                      : type == "string"  ? value.is_string()
                      : type == "boolean" ? value.is_boolean()
                      : type == "integer" ? value.is_number_integer()
                                          : value.is_number();
    if (!fits) {
        return at + " is no " + type;
    }
    if (type == "integer" && schema.contains("minimum") && value < schema["minimum"]) {
        return at + " is too small";
    }
    if (type == "array") {
        for (const json& item : value) {
            if (std::string found = flaw(schema["items"], item, at + "[]"); !found.empty()) {
                return found;
            }
        }
    }
    if (type == "object") {
        for (const auto& [name, of] : schema["properties"].items()) {
            if (!value.contains(name)) {
                return std::string(at).append(".").append(name).append(" is missing");
            }
            if (std::string found = flaw(of, value[name], std::string(at).append(".").append(name)); !found.empty()) {
                return found;
            }
        }
    }
    return {};
}

std::shared_ptr<const Message> next(Channels& channels, Topic topic, std::uint64_t& cursor) {
    return channels.next(static_cast<std::size_t>(topic), cursor);
}

std::size_t count_waiting(Channels& channels, Topic topic) {
    std::uint64_t cursor = 0;
    std::size_t count = 0;
    while (next(channels, topic, cursor)) {
        ++count;
    }
    return count;
}

/// The first message that a newcomer gets.
json first(Channels& channels, Topic topic) {
    std::uint64_t cursor = 0;
    const auto message = next(channels, topic, cursor);
    REQUIRE(message);
    return json::parse(message->data);
}

StatusEvent status_at(std::int64_t stamp_ns) {
    return {.stamp_ns = stamp_ns, .status = {{"version", 1}, {"uptime_s", 3.5}, {"pose", {{"lost", false}}}}};
}

}  // namespace

TEST_CASE("channels: each topic once, and each message is what its schema says") {
    Channels channels;
    REQUIRE(channels.all().size() == kTopics);
    channels.take(TilesEvent{.fresh = true, .resolution_m = 0.05, .tiles = {tile_at(0, -1, 40)}});
    channels.take(scan_at(kStart_ns));
    channels.take(status_at(kStart_ns));
    channels.take(LogLine{.stamp_ns = kStart_ns, .level = LogLine::Level::kWarning, .text = "battery low"});
    std::set<std::string> topics;
    for (std::size_t i = 0; i < kTopics; ++i) {
        const ChannelInfo& info = channels.all()[i];
        topics.insert(info.topic);
        const json schema = json::parse(info.schema);
        CHECK(schema["title"] == info.schema_name);
        const json message = first(channels, static_cast<Topic>(i));
        CHECK(flaw(schema, message, info.topic).empty());
        // Control: without one of its properties it is not.
        json less = message;
        less.erase(schema["required"][0].get<std::string>());
        CHECK_FALSE(flaw(schema, less, info.topic).empty());
    }
    CHECK(topics.size() == kTopics);
}

TEST_CASE("channels: the poses of a scan, in three frames") {
    Channels channels;
    channels.take(scan_at(kStart_ns + 42, 1.5));
    const json pose = first(channels, Topic::kPose);
    CHECK(pose["timestamp"] == json{{"sec", 1'700'000'000}, {"nsec", 42}});
    CHECK(pose["pose"]["position"] == json{{"x", 1.5}, {"y", -2.0}, {"z", 0.0}});
    CHECK(pose["pose"]["orientation"]["z"].get<double>() == Approx(0.24740395925));
    // Foxglove puts map -> odom -> base_link together again.
    const json tf = first(channels, Topic::kTf)["transforms"];
    REQUIRE(tf.size() == 2);
    CHECK(tf[0]["parent_frame_id"] == "map");
    CHECK(tf[0]["child_frame_id"] == tf[1]["parent_frame_id"]);
    CHECK(tf[1]["child_frame_id"] == "base_link");
    const auto pose_of = [](const json& t) {
        return crspf::Pose2{.x_m = t["translation"]["x"],
                            .y_m = t["translation"]["y"],
                            .theta_rad = 2.0 * crspf::arc_tan2(t["rotation"]["z"], t["rotation"]["w"])};
    };
    const crspf::Pose2 together = pose_of(tf[0]) * pose_of(tf[1]);
    CHECK(together.x_m == Approx(1.5));
    CHECK(together.y_m == Approx(-2.0));
    CHECK(together.theta_rad == Approx(0.5));
    const json match = first(channels, Topic::kMatch);
    CHECK(match["covariance"] == json({1.0, 2.0, 3.0, 4.0, 5.0, 6.0}));
}

TEST_CASE("channels: points of a scan as packed floats, a scan without points says nothing of them") {
    Channels channels;
    ScanEvent scan = scan_at(kStart_ns);
    channels.take(scan);
    const json cloud = first(channels, Topic::kScan);
    const auto bytes = crspf::from_base64(cloud["data"].get<std::string>());
    REQUIRE(bytes);
    const std::size_t stride = cloud["point_stride"];
    REQUIRE(bytes->size() == 2 * stride);
    const auto float_at = [&](std::size_t at) {
        float value = 0.0F;
        std::memcpy(&value, bytes->data() + at, sizeof value);
        return value;
    };
    const auto offset = [&](const char* name) {
        for (const json& field : cloud["fields"]) {
            if (field["name"] == name) {
                return field["offset"].get<std::size_t>();
            }
        }
        return std::size_t{999};
    };
    CHECK(float_at(offset("x")) == 1.5F);
    CHECK(float_at(stride + offset("y")) == 2.0F);
    CHECK((*bytes)[offset("critical")] == 0);
    CHECK((*bytes)[stride + offset("critical")] == 1);

    std::uint64_t cursor = 0;
    REQUIRE(next(channels, Topic::kScan, cursor));
    scan.points.clear();
    channels.take(scan);
    CHECK_FALSE(next(channels, Topic::kScan, cursor));
}

TEST_CASE("channels: readers have cursors of their own, a slow one gets the newest, and what is bounded stays so") {
    Channels channels;
    std::uint64_t quick = 0;
    std::uint64_t slow = 0;
    constexpr int kScans = 700;
    for (int i = 0; i < kScans; ++i) {
        channels.take(scan_at(kStart_ns + i, i));
        channels.take(LogLine{.stamp_ns = i, .level = LogLine::Level::kInfo, .text = std::to_string(i)});
        const auto message = next(channels, Topic::kPose, quick);
        REQUIRE(message);
        CHECK(message->stamp_ns == kStart_ns + i);
        CHECK_FALSE(next(channels, Topic::kPose, quick));
    }
    const auto newest = next(channels, Topic::kPose, slow);
    REQUIRE(newest);
    CHECK(newest->stamp_ns == kStart_ns + kScans - 1);
    CHECK_FALSE(next(channels, Topic::kPose, slow));
    CHECK(first(channels, Topic::kMatch)["x_m"] == kScans - 600);
    CHECK(count_waiting(channels, Topic::kMatch) == 600);
    CHECK(first(channels, Topic::kLog)["message"] == std::to_string(kScans - 200));
    CHECK(count_waiting(channels, Topic::kLog) == 200);
    CHECK(count_waiting(channels, Topic::kTf) == 1);
}

TEST_CASE("channels: path and map come once a second, and at once when nothing more is to come") {
    Channels channels;
    std::uint64_t path = 0;
    std::uint64_t map = 0;
    const auto news = [&](std::int64_t stamp_ns, double x_m) {
        channels.take(TilesEvent{.resolution_m = 0.05, .tiles = {tile_at(static_cast<std::int32_t>(x_m), 0, 0)}});
        channels.take(scan_at(stamp_ns, x_m));
        const bool path_came = next(channels, Topic::kPath, path) != nullptr;
        const bool map_came = next(channels, Topic::kMap, map) != nullptr;
        CHECK(path_came == map_came);
        return map_came;
    };
    CHECK(news(kStart_ns, 0.0));
    CHECK_FALSE(news(kStart_ns + kSecond_ns / 2, 1.0));
    CHECK(news(kStart_ns + kSecond_ns, 2.0));
    CHECK_FALSE(news(kStart_ns + kSecond_ns * 3 / 2, 3.0));
    channels.take(AwayEvent{.away = true, .why = "over"});
    const auto last_path = next(channels, Topic::kPath, path);
    const auto last_map = next(channels, Topic::kMap, map);
    REQUIRE(last_path);
    REQUIRE(last_map);
    CHECK(json::parse(last_path->data)["poses"].size() == 4);
    CHECK(json::parse(last_map->data)["column_count"] == 4 * 64);
    const json status = first(channels, Topic::kStatus);
    CHECK(status["away"] == true);
    CHECK(status["why"] == "over");
    CHECK_FALSE(next(channels, Topic::kMap, map));  // no change, no message
}

TEST_CASE("channels: tiles that come before anything with a stamp wait for it") {
    Channels channels;
    channels.take(TilesEvent{.fresh = true, .resolution_m = 0.05, .tiles = {tile_at(0, 0, 40)}});
    std::uint64_t cursor = 0;
    for (const Topic topic : {Topic::kMapTiles, Topic::kMap, Topic::kPath}) {
        CHECK_FALSE(next(channels, topic, cursor));
    }
    channels.take(scan_at(kStart_ns));
    for (const Topic topic : {Topic::kMapTiles, Topic::kMap, Topic::kPath}) {
        CHECK(first(channels, topic)["timestamp"]["sec"] == kStart_ns / kSecond_ns);
    }
}

TEST_CASE("channels: where time runs back or the map is another one, path and match values of before are forgotten") {
    Channels channels;
    for (int i = 0; i < 10; ++i) {
        channels.take(scan_at(kStart_ns + i * kSecond_ns, i));
    }
    std::uint64_t cursor = 0;
    while (next(channels, Topic::kMatch, cursor)) {
    }
    channels.take(scan_at(kStart_ns, 77.0));
    CHECK(count_waiting(channels, Topic::kMatch) == 1);
    CHECK(first(channels, Topic::kPath)["poses"].size() == 1);
    const auto message = next(channels, Topic::kMatch, cursor);  // the cursor of before goes on
    REQUIRE(message);
    CHECK(json::parse(message->data)["x_m"] == 77.0);
    channels.take(TilesEvent{.fresh = true, .resolution_m = 0.05, .tiles = {}});
    channels.take(AwayEvent{});
    CHECK(first(channels, Topic::kPath)["poses"].empty());
}

TEST_CASE("channels: diagnostics once a second, a status with bytes that are no text is told all the same") {
    Channels channels;
    channels.take(status_at(kStart_ns));
    StatusEvent odd = status_at(kStart_ns + kSecond_ns / 2);
    odd.status["map"] = {{"problem", "caf\xe9"}};
    channels.take(odd);
    CHECK(first(channels, Topic::kStatus)["map"]["problem"] == "caf\xEF\xBF\xBD");
    std::uint64_t cursor = 0;
    REQUIRE(next(channels, Topic::kDiagnostics, cursor));
    CHECK_FALSE(next(channels, Topic::kDiagnostics, cursor));
    channels.take(status_at(kStart_ns + kSecond_ns));
    CHECK(next(channels, Topic::kDiagnostics, cursor));
    channels.take(StatusEvent{.stamp_ns = kStart_ns + 3 * kSecond_ns, .status = json::array({1, 2})});
    CHECK(first(channels, Topic::kStatus)["timestamp"]["sec"] == 1'700'000'003);
}

TEST_CASE("channels: numbers that are none do not spoil a message") {
    Channels channels;
    ScanEvent scan = scan_at(-5);
    scan.M = std::numeric_limits<double>::quiet_NaN();
    scan.P_map_base.x_m = std::numeric_limits<double>::infinity();
    channels.take(scan);
    CHECK(first(channels, Topic::kMatch)["M"].is_null());
    CHECK(first(channels, Topic::kMatch)["timestamp"]["sec"] == 0);
    channels.take(AwayEvent{});
    CHECK(count_waiting(channels, Topic::kPath) == 0);
}
