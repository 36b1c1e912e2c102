// Plays a recording at a pace that can be changed: pause, speed, position.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "core/base/time.hpp"
#include "tools/view/replay_feed.hpp"
#include "tools/view/run_events.hpp"

namespace crspf::view {

/// One owner. Does not wait and reads no clock but to bound a turn: the caller says what time it is.
class ReplayPlayer {
 public:
    using Out = std::function<void(const RunEvent&)>;
    static constexpr double kSpeedMin = 0.1;
    static constexpr double kSpeedMax = 100.0;

    /// Plays the first scan. Throws InputError: what cannot be opened or played.
    ReplayPlayer(ReplayFeed& feed, double speed, const Out& out);

    /// Plays what is due at `now`, for at most `work`; so that a position far away is reached turn by turn.
    void turn(Stamp now, Duration work, const Out& out);

    /// {paused?, speed?, position_s?}. Empty: it is done as of the next turn; else what is wrong with it.
    [[nodiscard]] std::string ask(const nlohmann::json& request);

 private:
    void step(const Out& out);
    void tell(const Out& out);
    [[nodiscard]] nlohmann::ordered_json said() const;

    ReplayFeed& feed_;
    double speed_;
    bool paused_ = false;
    bool ended_ = false;
    std::optional<double> sought_s_;  ///< a position on the way to which nothing is shown but the map
    std::optional<Stamp> anchor_;     ///< at this time ...
    double anchor_s_ = 0.0;           ///< ... it is at this position; none: begins with the next turn
    bool news_ = true;                ///< what was asked for has not been told yet
    Stamp told_;
    StatusEvent status_;  ///< the recording's last
};

}  // namespace crspf::view
