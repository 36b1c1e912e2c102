// What `crspf ctl` and crspfd say to each other: a line of JSON each way over a Unix socket. docs/service.md.
//
//   {"version": 1, "command": "set-pose", "pose": [1.0, 2.0, 90.0]}
//   {"version": 1, "ok": true, "result": {...}}      {"version": 1, "ok": false, "error": "..."}
//
// Who has asked to watch is sent lines without asking, as fast as he takes them: {"version": 1, "event": ...}.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/pose.hpp"

namespace crspf {

inline constexpr int kControlVersion = 1;
/// Of a request, its line end included. A peer that sends more is cut off.
inline constexpr std::size_t kRequestBytesMax = 4096;

struct ControlRequest {
    enum class Command : std::uint8_t {
        kStatus,
        kPose,
        kSaveMap,
        kLoadMap,
        kReset,
        kSetPose,
        kRelocalize,
        kRecordStart,
        kRecordStop,
        kReload,
        kLogLevel,
        kWatch,
    };
    Command command = Command::kStatus;
    Pose2 P_map_base;  ///< kSetPose
    std::string text;  ///< kLogLevel: trace, debug, info, warning or error; kLoadMap: absolute path of a YAML file
};

/// The request, or in `error` what is wrong with it. Whatever the bytes: no exception.
[[nodiscard]] std::optional<ControlRequest> parse_request(std::string_view line, std::string& error);

/// A line, its end included.
[[nodiscard]] std::string request_line(const ControlRequest& request);
[[nodiscard]] std::string result_line(const nlohmann::ordered_json& result);
[[nodiscard]] std::string error_line(std::string_view error);

}  // namespace crspf
