#include "tools/view/troubles.hpp"

#include <array>
#include <string>
#include <utility>

#include "tools/view/status_parts.hpp"

namespace crspf::view {
namespace {

/// As the page has them (page/panel.js).
constexpr std::array<std::pair<const char*, const char*>, 24> kTroubles{{
    {"filter", "skipped"},
    {"filter", "undrawn"},
    {"filter", "lost"},
    {"filter", "degenerate"},
    {"filter", "too_few_rays"},
    {"filter", "outside_map"},
    {"odometry", "not_finite"},
    {"odometry", "ran_back"},
    {"odometry", "gaps"},
    {"odometry", "implausible"},
    {"odometry", "lost_to_full_rings"},
    {"map", "refused"},
    {"map", "problem"},
    {"map", "tiles_lost"},
    {"output", "lost"},
    {"output", "jumps"},
    {"output", "unsent"},
    {"output", "bus_error"},
    {"output", "bus_offs"},
    {"output", "send_timeouts"},
    {"output", "queue_full"},
    {"recording", "lost"},
    {"recording", "unrecorded"},
    {"recording", "problem"},
}};

}  // namespace

nlohmann::ordered_json troubles_of(const nlohmann::ordered_json& status) {
    nlohmann::ordered_json found = nlohmann::ordered_json::object();
    for (const auto& [group, name] : kTroubles) {
        const nlohmann::ordered_json& part = part_of(status, group);
        if (number_at(part, name) > 0.0 || !text_at(part, name).empty()) {
            found[std::string(group) + "." + name] = part_of(part, name);
        }
    }
    return found;
}

}  // namespace crspf::view
