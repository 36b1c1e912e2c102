#include "tools/view/replay_feed.hpp"

#include <utility>

namespace crspf::view {

ReplayFeed::ReplayFeed(ReplayJob job) : job_(std::move(job)) {
    restart();
}

void ReplayFeed::restart() {
    player_.reset();  // the pipeline is large: not two of them
    player_ = std::make_unique<RunPlayer>(job_);
    events_ = std::make_unique<ReplayEvents>(player_->config());
    scans_ = ended_ = false;
}

bool ReplayFeed::step(const std::function<void(const RunEvent&)>& out) {
    while (player_->next() != nullptr) {
        if (const std::optional<ScanResult> result = player_->play()) {
            scans_ = true;
            events_->on_scan(*player_, *result, out);
            return true;
        }
    }
    if (!scans_) {
        throw player_->without_scans();
    }
    if (!std::exchange(ended_, true)) {
        duration_s_ = events_->position_s();
        events_->on_end(*player_, out);
    }
    return false;
}

}  // namespace crspf::view
