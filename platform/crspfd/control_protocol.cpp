#include "platform/crspfd/control_protocol.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/trig.hpp"

namespace crspf {

namespace {

using Command = ControlRequest::Command;

constexpr std::array<std::pair<std::string_view, Command>, 12> kCommands{{{"status", Command::kStatus},
                                                                          {"pose", Command::kPose},
                                                                          {"save-map", Command::kSaveMap},
                                                                          {"load-map", Command::kLoadMap},
                                                                          {"reset", Command::kReset},
                                                                          {"set-pose", Command::kSetPose},
                                                                          {"relocalize", Command::kRelocalize},
                                                                          {"record-start", Command::kRecordStart},
                                                                          {"record-stop", Command::kRecordStop},
                                                                          {"reload", Command::kReload},
                                                                          {"log-level", Command::kLogLevel},
                                                                          {"watch", Command::kWatch}}};
constexpr std::array<std::string_view, 5> kLevels{"trace", "debug", "info", "warning", "error"};

/// Farther than any map reaches.
constexpr double kFar_m = 1e5;

bool read_pose(const nlohmann::json& json, Pose2& pose) {
    const auto is_number = [](const nlohmann::json& v) { return v.is_number(); };
    if (!json.is_array() || json.size() != 3 || !std::all_of(json.begin(), json.end(), is_number)) {
        return false;
    }
    const auto x_m = json[0].get<double>();
    const auto y_m = json[1].get<double>();
    const auto heading_deg = json[2].get<double>();
    if (!(std::abs(x_m) < kFar_m && std::abs(y_m) < kFar_m && std::abs(heading_deg) <= 360.0)) {
        return false;
    }
    pose = {.x_m = x_m, .y_m = y_m, .theta_rad = wrap_angle(radians(heading_deg))};
    return true;
}

std::string names() {
    std::string out;
    for (const auto& [name, command] : kCommands) {
        out.append(out.empty() ? "" : ", ").append(name);
    }
    return out;
}

}  // namespace

std::optional<ControlRequest> parse_request(std::string_view line, std::string& error) {
    const nlohmann::json json = nlohmann::json::parse(line, nullptr, false);
    if (!json.is_object()) {
        error = "a request is a line with a JSON object";
        return std::nullopt;
    }
    const auto version = json.find("version");
    if (version == json.end() || !version->is_number_integer() || *version != kControlVersion) {
        error = "version: this service speaks version " + std::to_string(kControlVersion) +
                "; crspf and crspfd must be of one release";
        return std::nullopt;
    }
    const auto name = json.find("command");
    const auto* const known = std::find_if(kCommands.begin(), kCommands.end(), [&](const auto& c) {
        return name != json.end() && name->is_string() && name->template get_ref<const std::string&>() == c.first;
    });
    if (known == kCommands.end()) {
        error = "command: is none of " + names();
        return std::nullopt;
    }
    ControlRequest request;
    request.command = known->second;
    if (request.command == Command::kSetPose) {
        const auto pose = json.find("pose");
        if (pose == json.end() || !read_pose(*pose, request.P_map_base)) {
            error = "pose: three numbers, x [m], y [m], heading [deg] in the map frame";
            return std::nullopt;
        }
    }
    const auto text_of = [&json](const char* key) {
        const auto text = json.find(key);
        return text != json.end() && text->is_string() ? text->get<std::string>() : std::string();
    };
    if (request.command == Command::kLogLevel) {
        request.text = text_of("level");
        if (std::find(kLevels.begin(), kLevels.end(), request.text) == kLevels.end()) {
            error = "level: one of trace, debug, info, warning, error";
            return std::nullopt;
        }
    }
    if (request.command == Command::kLoadMap) {
        request.text = text_of("path");
        if (request.text.empty() || request.text.front() != '/' || request.text.find('\0') != std::string::npos) {
            error = "path: the absolute path of a map's YAML file";
            return std::nullopt;
        }
    }
    return request;
}

std::string request_line(const ControlRequest& request) {
    const auto* const known =
        std::find_if(kCommands.begin(), kCommands.end(), [&](const auto& c) { return c.second == request.command; });
    nlohmann::ordered_json json{{"version", kControlVersion}, {"command", known->first}};
    if (request.command == Command::kSetPose) {
        json["pose"] = {request.P_map_base.x_m, request.P_map_base.y_m, degrees(request.P_map_base.theta_rad)};
    }
    if (request.command == Command::kLogLevel) {
        json["level"] = request.text;
    }
    if (request.command == Command::kLoadMap) {
        json["path"] = request.text;
    }
    return json.dump() + "\n";
}

std::string result_line(const nlohmann::ordered_json& result) {
    const nlohmann::ordered_json json{{"version", kControlVersion}, {"ok", true}, {"result", result}};
    return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::string error_line(std::string_view error) {
    const nlohmann::ordered_json json{{"version", kControlVersion}, {"ok", false}, {"error", error}};
    return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace crspf
