// The service's status and the view's own counters in Prometheus' text format (version 0.0.4).
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tools/view/hub.hpp"
#include "tools/view/web_server.hpp"

namespace crspf::view {

// NOLINTNEXTLINE(bugprone-exception-escape): nlohmann::json, whose move throws nothing, although it calls what may
struct MetricsInput {
    bool up = false;                ///< the service, or the replay, is there
    nlohmann::ordered_json status;  ///< its newest status (docs/service.md); what is absent in it is left out
    HubCounters hub;
    WebCounters web;
};

[[nodiscard]] std::string metrics_text(const MetricsInput& input);

}  // namespace crspf::view
