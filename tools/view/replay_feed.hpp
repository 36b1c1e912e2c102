// A recording as a feed of events, played by the pipeline itself, a scan at a time.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "tools/crspf/replay_job.hpp"
#include "tools/view/replay_events.hpp"
#include "tools/view/run_events.hpp"

namespace crspf::view {

/// One owner. The job's rate, progress and on_result are not looked at: the pace is the caller's.
class ReplayFeed {
 public:
    /// Throws InputError: what cannot be opened.
    explicit ReplayFeed(ReplayJob job);

    /// Plays to the next scan, and tells of it. False at the end of the recording, of which it has told then. Throws
    /// InputError: a file that cannot be read on; a recording without a scan.
    bool step(const std::function<void(const RunEvent&)>& out);
    /// Again from the beginning.
    void restart();

    /// [s] since the first scan, by the recording's time.
    [[nodiscard]] double position_s() const { return events_->position_s(); }
    /// [s] Known once it was played to its end; until then share() tells how far it is.
    [[nodiscard]] std::optional<double> duration_s() const { return duration_s_; }
    /// How much of the recording has been read, 0 to 1.
    [[nodiscard]] double share() const { return player_->share(); }

 private:
    ReplayJob job_;
    std::unique_ptr<RunPlayer> player_;
    std::unique_ptr<ReplayEvents> events_;
    std::optional<double> duration_s_;
    bool scans_ = false;  ///< there was one
    bool ended_ = false;
};

}  // namespace crspf::view
