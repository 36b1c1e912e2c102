#include "tools/view/diagnostics.hpp"

#include <cstdint>
#include <string>
#include <string_view>

#include "tools/view/status_parts.hpp"

namespace crspf::view {
namespace {

// diagnostic_msgs/DiagnosticStatus.
enum class DiagnosticLevel : std::uint8_t { kOk, kWarn, kError, kStale };

struct Judgement {
    DiagnosticLevel level = DiagnosticLevel::kOk;
    std::string words = "ok";
};

/// A plain value, as key and value; nothing of others.
void append_value(const std::string& key, const Json& value, Json& values) {
    if (!value.is_structured()) {
        values.push_back({{"key", key}, {"value", value.is_string() ? value.get<std::string>() : value.dump()}});
    }
}

/// Its plain values, and those of the objects in it.
void append_values(const Json& json, Json& values) {
    for (const auto& [key, value] : json.items()) {
        append_value(key, value, values);
        if (value.is_object()) {
            for (const auto& [inner, inner_value] : value.items()) {
                append_value(std::string(key).append(".").append(inner), inner_value, values);
            }
        }
    }
}

void add_status(Json& all, const std::string& name, const Judgement& verdict, const Json& of) {
    Json values = Json::array();
    if (of.is_object()) {
        append_values(of, values);
    }
    all.push_back({{"level", static_cast<int>(verdict.level)},
                   {"name", name},
                   {"message", verdict.words},
                   {"hardware_id", text_at(of, "port")},
                   {"values", values}});
}

Judgement of_source(const Json& source) {
    const std::string state = text_at(source, "state");
    if (state == "failed") {
        return {.level = DiagnosticLevel::kError,
                .words = text_at(source, "says").empty() ? state : text_at(source, "says")};
    }
    if (state == "stale") {
        return {.level = DiagnosticLevel::kStale, .words = state};
    }
    return {.level = state.empty() || state == "ok" ? DiagnosticLevel::kOk : DiagnosticLevel::kWarn,
            .words = state.empty() ? "ok" : state};
}

Judgement of_thread(const Json& thread) {
    if (says(thread, "alive", false)) {
        return {.level = DiagnosticLevel::kError, .words = "its loop does not turn"};
    }
    return number_at(thread, "misses") > 0.0
               ? Judgement{.level = DiagnosticLevel::kWarn, .words = "deadlines were missed"}
               : Judgement{};
}

Judgement of_pose(const Json& pose) {
    if (says(pose, "lost", true)) {
        return {.level = DiagnosticLevel::kError, .words = "lost"};
    }
    return says(pose, "degenerate", true)
               ? Judgement{.level = DiagnosticLevel::kWarn, .words = "a direction is not seen"}
               : Judgement{};
}

Judgement of_map(const Json& map) {
    if (const std::string problem = text_at(map, "problem"); !problem.empty()) {
        return {.level = DiagnosticLevel::kError, .words = problem};
    }
    return number_at(map, "refused") > 0.0 ? Judgement{.level = DiagnosticLevel::kWarn, .words = "the map is full"}
                                           : Judgement{};
}

Judgement of_output(const Json& output) {
    if (text_at(output, "interface").empty()) {
        return {.level = DiagnosticLevel::kOk, .words = "no bus is configured"};
    }
    if (says(output, "bus_open", false)) {
        const std::string error = text_at(output, "bus_error");
        return {.level = DiagnosticLevel::kError, .words = error.empty() ? "the bus is not open" : error};
    }
    return number_at(output, "unsent") > 0.0
               ? Judgement{.level = DiagnosticLevel::kWarn, .words = "poses were given up"}
               : Judgement{};
}

}  // namespace

Json diagnostics_of(const StatusEvent& status) {
    const Json& document = status.status;
    Json all = Json::array();
    for (const Json& source : part_of(document, "sources")) {
        add_status(all, "source " + text_at(source, "name"), of_source(source), source);
    }
    for (const Json& thread : part_of(document, "threads")) {
        add_status(all, "thread " + text_at(thread, "name"), of_thread(thread), thread);
    }
    const auto add_part = [&](const char* name, Judgement (*judge)(const Json&)) {
        if (const Json& found = part_of(document, name); found.is_object()) {
            add_status(all, name, judge(found), found);
        }
    };
    add_part("pose", of_pose);
    add_part("map", of_map);
    add_part("output", of_output);
    return {{"header", {{"stamp", time_of(status.stamp_ns)}, {"frame_id", ""}}}, {"status", all}};
}

}  // namespace crspf::view
