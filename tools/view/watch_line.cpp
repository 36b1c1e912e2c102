#include "tools/view/watch_line.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "platform/crspfd/control_protocol.hpp"
#include "platform/files/base64.hpp"

namespace crspf::view {

namespace {

using Json = nlohmann::ordered_json;

/// Deeper than the status document: what a service says is flat, and whoever walks through it need not fear for his
/// stack.
constexpr int kDepthMax = 16;
constexpr std::size_t kTilesMax = 64;
constexpr double kResolutionMax_m = 10.0;
constexpr std::array<std::pair<std::string_view, LogLine::Level>, 4> kLevels{{{"debug", LogLine::Level::kDebug},
                                                                              {"info", LogLine::Level::kInfo},
                                                                              {"warning", LogLine::Level::kWarning},
                                                                              {"error", LogLine::Level::kError}}};

/// The members of an object, each of the type that is asked for; what is wrong with the first that is not.
class Members {
 public:
    explicit Members(const Json& object) : object_(object) {}

    [[nodiscard]] bool good() const { return wrong_.empty(); }
    [[nodiscard]] const std::string& wrong() const { return wrong_; }
    void fail(std::string_view key) {
        if (good()) {
            wrong_ = key;
        }
    }

    bool flag(std::string_view key) {
        const Json* const value = find(key, &Json::is_boolean);
        return value != nullptr && value->get<bool>();
    }
    double number(std::string_view key) {
        const Json* const value = find(key, &Json::is_number);
        return value != nullptr ? finite(*value, key) : 0.0;
    }
    std::uint32_t count(std::string_view key) {
        const Json* const value = find(key, &Json::is_number_unsigned);
        const std::uint64_t number = value != nullptr ? value->get<std::uint64_t>() : 0;
        if (number > std::numeric_limits<std::uint32_t>::max()) {
            fail(key);
            return 0;
        }
        return static_cast<std::uint32_t>(number);
    }
    std::int64_t stamp_ns() {
        constexpr std::string_view kKey = "stamp_ns";
        const Json* const value = find(kKey, &Json::is_number_integer);
        return value != nullptr ? value->get<std::int64_t>() : 0;
    }
    std::string_view text(std::string_view key) {
        const Json* const value = find(key, &Json::is_string);
        return value != nullptr ? std::string_view(value->get_ref<const std::string&>()) : std::string_view();
    }
    template <std::size_t N>
    std::array<double, N> numbers(std::string_view key) {
        std::array<double, N> out{};
        const Json* const value = find(key, &Json::is_array);
        if (value != nullptr && value->size() == N) {
            std::transform(value->begin(), value->end(), out.begin(), [&](const Json& number) {
                return number.is_number() ? finite(number, key) : (fail(key), 0.0);
            });
        } else {
            fail(key);
        }
        return out;
    }
    const Json& list(std::string_view key) {
        static const Json nothing = Json::array();
        const Json* const value = find(key, &Json::is_array);
        return value != nullptr ? *value : nothing;
    }
    const Json& object(std::string_view key) {
        static const Json nothing = Json::object();
        const Json* const value = find(key, &Json::is_object);
        return value != nullptr ? *value : nothing;
    }
    std::vector<std::uint8_t> bytes(std::string_view key) {
        std::optional<std::vector<std::uint8_t>> bytes = from_base64(text(key));
        if (!bytes) {
            fail(key);
            return {};
        }
        return std::move(*bytes);
    }

 private:
    const Json* find(std::string_view key, bool (Json::*is_right)() const noexcept) {
        const auto found = object_.find(key);
        if (found == object_.end() || !((*found).*is_right)()) {
            fail(key);
            return nullptr;
        }
        return &*found;
    }
    double finite(const Json& number, std::string_view key) {
        const auto value = number.get<double>();
        if (!std::isfinite(value)) {
            fail(key);
            return 0.0;
        }
        return value;
    }

    const Json& object_;
    std::string wrong_;
};

Pose2 pose_of(Members& members, std::string_view key) {
    const auto [x_m, y_m, theta_rad] = members.numbers<3>(key);
    return {.x_m = x_m, .y_m = y_m, .theta_rad = theta_rad};
}

AnalyserParams thresholds_of(Members& members) {
    Members inner(members.object("thresholds"));
    const AnalyserParams thresholds{.result_on = inner.number("result_on"),
                                    .result_off = inner.number("result_off"),
                                    .draw_on = inner.number("draw_on"),
                                    .draw_off = inner.number("draw_off")};
    if (!inner.good()) {
        members.fail("thresholds");
    }
    return thresholds;
}

float float_of(std::span<const std::uint8_t> little_endian) {
    std::uint32_t bits = 0;
    for (std::size_t i = 4; i-- > 0;) {
        bits = (bits << 8U) | little_endian[i];
    }
    return std::bit_cast<float>(bits);
}

std::vector<ScanEvent::Point> points_of(Members& members) {
    constexpr std::size_t kFloat = 4;
    const std::vector<std::uint8_t> bytes = members.bytes("points");
    const std::vector<std::uint8_t> critical = members.bytes("critical");
    if (bytes.size() != critical.size() * 2 * kFloat || critical.size() > capacity::kBeams) {
        members.fail("points");
        return {};
    }
    std::vector<ScanEvent::Point> points;
    points.reserve(critical.size());
    for (std::size_t i = 0; i < critical.size(); ++i) {
        const auto floats = std::span(bytes).subspan(i * 2 * kFloat, 2 * kFloat);
        const ScanEvent::Point point{
            .x_m = float_of(floats.first(kFloat)), .y_m = float_of(floats.last(kFloat)), .critical = critical[i] != 0};
        if (!std::isfinite(point.x_m) || !std::isfinite(point.y_m)) {
            members.fail("points");
            return {};
        }
        points.push_back(point);
    }
    return points;
}

ScanEvent scan_of(Members& members) {
    ScanEvent scan;
    scan.stamp_ns = members.stamp_ns();
    scan.P_map_base = pose_of(members, "P_map_base");
    scan.P_map_odom = pose_of(members, "P_map_odom");
    const auto [xx, xy, yy, xt, yt, tt] = members.numbers<6>("covariance");
    scan.covariance = {.xx = xx, .xy = xy, .yy = yy, .xt = xt, .yt = yt, .tt = tt};
    scan.M = members.number("M");
    scan.m = members.number("m");
    scan.thresholds = thresholds_of(members);
    scan.matched = members.flag("matched");
    scan.result = members.flag("result");
    scan.draw = members.flag("draw");
    scan.lost = members.flag("lost");
    scan.degenerate = members.flag("degenerate");
    scan.rays = members.count("rays");
    scan.critical_rays = members.count("critical_rays");
    scan.evaluations = members.count("evaluations");
    scan.range_m = members.number("range_m");
    scan.range_rad = members.number("range_rad");
    scan.points = points_of(members);
    return scan;
}

/// None where it is no tile of a map.
std::optional<TileImage> tile_of(const Json& json) {
    if (!json.is_object()) {
        return std::nullopt;
    }
    Members members(json);
    const auto [x, y] = members.numbers<2>("corner");
    const std::vector<std::uint8_t> cells = members.bytes("cells");
    const auto is_corner = [](double v) {
        return std::abs(v) <= TileGeometry::kHalf && v < TileGeometry::kHalf &&
               std::fmod(v, TileGeometry::kSide) == 0.0;
    };
    if (!members.good() || !is_corner(x) || !is_corner(y) || cells.size() != TileGeometry::kCells ||
        !std::all_of(cells.begin(), cells.end(), [](std::uint8_t c) { return c <= 100 || c == TileImage::kUnseen; })) {
        return std::nullopt;
    }
    TileImage tile{.corner = {.x = static_cast<std::int32_t>(x), .y = static_cast<std::int32_t>(y)}, .cells = {}};
    std::copy(cells.begin(), cells.end(), tile.cells.begin());
    return tile;
}

TilesEvent tiles_of(Members& members) {
    TilesEvent event{.fresh = members.flag("fresh"), .resolution_m = members.number("resolution_m"), .tiles = {}};
    if (!(event.resolution_m > 0.0 && event.resolution_m <= kResolutionMax_m)) {
        members.fail("resolution_m");
    }
    const Json& list = members.list("tiles");
    if (list.size() > kTilesMax) {
        members.fail("tiles");
        return event;
    }
    event.tiles.reserve(list.size());
    for (const Json& json : list) {
        const std::optional<TileImage> tile = tile_of(json);
        if (!tile) {
            members.fail("tiles");
            return event;
        }
        event.tiles.push_back(*tile);
    }
    return event;
}

LogLine log_of(Members& members) {
    LogLine line{
        .stamp_ns = members.stamp_ns(), .level = LogLine::Level::kInfo, .text = std::string(members.text("text"))};
    const std::string_view name = members.text("level");
    const auto* const known =
        std::find_if(kLevels.begin(), kLevels.end(), [name](const auto& level) { return level.first == name; });
    if (known == kLevels.end()) {
        members.fail("level");
        return line;
    }
    line.level = known->second;
    return line;
}

/// None: `name` is no event's.
std::optional<RunEvent> event_of(std::string_view name, Members& members) {
    if (name == "scan") {
        return scan_of(members);
    }
    if (name == "tiles") {
        return tiles_of(members);
    }
    if (name == "status") {
        return StatusEvent{.stamp_ns = members.stamp_ns(), .status = members.object("status")};
    }
    if (name == "log") {
        return log_of(members);
    }
    return std::nullopt;
}

WatchLine bad(std::string text) {
    return {.kind = WatchLine::Kind::kBad, .event = {}, .text = std::move(text)};
}

/// The answer to the request to watch.
WatchLine answer_of(const Json& json) {
    Members members(json);
    const bool granted = members.flag("ok");
    if (granted) {
        return {.kind = WatchLine::Kind::kWelcome, .event = {}, .text = {}};
    }
    std::string error(members.text("error"));
    return members.good() ? WatchLine{.kind = WatchLine::Kind::kRefusal, .event = {}, .text = std::move(error)}
                          : bad(members.wrong() + ": is missing or wrong");
}

}  // namespace

WatchLine parse_watch_line(std::string_view line) {
    bool too_deep = false;
    const Json json = Json::parse(
        line,
        [&too_deep](int depth, Json::parse_event_t /*event*/, const Json& /*value*/) {
            too_deep = too_deep || depth > kDepthMax;
            return !too_deep;
        },
        false);
    if (too_deep || !json.is_object()) {
        return bad("is no JSON object");
    }
    Members members(json);
    if (members.count("version") != kControlVersion || !members.good()) {
        return bad("version: crspf and crspfd must be of one release");
    }
    if (json.contains("ok")) {
        return answer_of(json);
    }
    std::optional<RunEvent> event = event_of(members.text("event"), members);
    if (!event || !members.good()) {
        return bad((members.good() ? "event" : members.wrong()) + ": is missing or wrong");
    }
    return {.kind = WatchLine::Kind::kEvent, .event = std::move(*event), .text = {}};
}

}  // namespace crspf::view
