// How a robot is, of all that its service has said: a word, and the document that a fleet's manager keeps of it.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/time.hpp"
#include "tools/view/run_events.hpp"

namespace crspf::mqtt {

class RobotHealth {
 public:
    /// Without a scan for so long it is in the state "No scans", as on the view's page.
    static constexpr Duration kScansMax{1'500'000'000};

    RobotHealth();

    void take(const view::ScanEvent& scan, Stamp now);
    void take(const view::StatusEvent& status);
    void take(const view::AwayEvent& event);

    /// Anything has been said yet: that there is no service, for one.
    [[nodiscard]] bool known() const { return known_; }
    [[nodiscard]] bool scans_come(Stamp now) const { return scanned_ && now - scan_at_ <= kScansMax; }

    /// The view's words (docs/view.md): "Tracking", "LOST", "Service away" ...
    [[nodiscard]] const char* word(Stamp now) const;
    /// What a change of which is told at once: word, reason, sensors' states.
    [[nodiscard]] nlohmann::ordered_json gist(Stamp now) const;
    /// The whole (docs/mqtt.md). Of a service that is away nothing but that: what is old would pass for new.
    [[nodiscard]] nlohmann::ordered_json payload(Stamp now, std::int64_t utc_ns, const std::string& version) const;

 private:
    bool known_ = false;
    bool away_ = false;
    std::string why_;
    nlohmann::ordered_json status_;
    bool service_lost_ = false;
    bool scanned_ = false;
    Stamp scan_at_;
    bool scan_lost_ = false;
    bool degenerate_ = false;
    bool matched_ = false;
};

}  // namespace crspf::mqtt
