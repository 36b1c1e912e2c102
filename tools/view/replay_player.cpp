#include "tools/view/replay_player.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <variant>

#include "platform/files/input_error.hpp"
#include "platform/linux/monotonic_clock.hpp"

namespace crspf::view {
namespace {

constexpr Duration kTellEvery{250'000'000};

bool number_within(const nlohmann::json& value, double low, double high) {
    return value.is_number() && value.get<double>() >= low && value.get<double>() <= high;
}

RunEvent without_points(ScanEvent scan) {
    scan.points.clear();
    return scan;
}

}  // namespace

ReplayPlayer::ReplayPlayer(ReplayFeed& feed, double speed, const Out& out) : feed_(feed), speed_(speed) {
    step(out);
}

void ReplayPlayer::turn(Stamp now, Duration work, const Out& out) {
    const Stamp end = monotonic_now() + work;
    if (sought_s_ && feed_.position_s() > *sought_s_) {
        feed_.restart();
        ended_ = false;
        step(out);
    }
    if (!anchor_) {
        anchor_ = now;
        anchor_s_ = feed_.position_s();
    }
    const double due_s = sought_s_ ? *sought_s_ : anchor_s_ + speed_ * (now - *anchor_).seconds();
    bool behind = false;
    while ((!paused_ || sought_s_) && !ended_ && feed_.position_s() < due_s) {
        if (behind = monotonic_now() >= end; behind) {
            break;
        }
        step(out);
    }
    if (behind && !sought_s_) {
        anchor_.reset();  // it cannot be played so fast: no debt is run up
    }
    if (!behind && sought_s_) {
        sought_s_.reset();
        anchor_ = now;
        anchor_s_ = feed_.position_s();
        news_ = true;
    }
    if (news_ || now - told_ >= kTellEvery) {
        told_ = now;
        tell(out);
    }
}

std::string ReplayPlayer::ask(const nlohmann::json& request) {
    constexpr double kLongest_s = 1e7;
    const auto paused = request.find("paused");
    const auto speed = request.find("speed");
    const auto position = request.find("position_s");
    if (paused != request.end() && !paused->is_boolean()) {
        return "paused: true or false";
    }
    if (speed != request.end() && !number_within(*speed, kSpeedMin, kSpeedMax)) {
        return fmt::format("speed: {} to {}", kSpeedMin, kSpeedMax);
    }
    if (position != request.end() && !number_within(*position, 0.0, kLongest_s)) {
        return "position_s: seconds from the beginning";
    }
    paused_ = paused != request.end() ? paused->get<bool>() : paused_;
    speed_ = speed != request.end() ? speed->get<double>() : speed_;
    if (position != request.end()) {
        sought_s_ = position->get<double>();
    } else if (ended_ && paused != request.end() && !paused_) {
        sought_s_ = 0.0;  // play, at the end: again
    }
    anchor_.reset();
    news_ = true;
    return {};
}

void ReplayPlayer::step(const Out& out) {
    const auto pass = [&](const RunEvent& event) {
        if (const auto* const status = std::get_if<StatusEvent>(&event)) {
            status_ = *status;  // told with what this player adds
        } else if (const auto* const scan = std::get_if<ScanEvent>(&event);
                   scan != nullptr && sought_s_ && feed_.position_s() < *sought_s_) {
            out(without_points(*scan));  // but the last one is to be seen
        } else {
            out(event);
        }
    };
    try {
        ended_ = !feed_.step(pass);
    } catch (const InputError& e) {
        if (!status_.status.is_object()) {
            throw;  // nothing has been played yet: the command's error
        }
        out(LogLine{.stamp_ns = status_.stamp_ns, .level = LogLine::Level::kError, .text = e.what()});
        ended_ = true;
    }
    if (ended_) {
        sought_s_.reset();
        news_ = true;
    }
}

nlohmann::ordered_json ReplayPlayer::said() const {
    const double share = feed_.share();
    const double estimate_s = share > 0.0 ? feed_.position_s() / share : feed_.position_s();
    return {{"position_s", feed_.position_s()},
            {"duration_s", feed_.duration_s().value_or(estimate_s)},
            {"duration_known", feed_.duration_s().has_value()},
            {"speed", speed_},
            {"paused", paused_},
            {"seeking", sought_s_.has_value()},
            {"ended", ended_}};
}

void ReplayPlayer::tell(const Out& out) {
    news_ = false;
    StatusEvent status = status_;
    status.status["replay"] = said();
    out(status);
}

}  // namespace crspf::view
