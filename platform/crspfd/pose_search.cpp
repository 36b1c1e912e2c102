#include "platform/crspfd/pose_search.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>

#include "core/base/trig.hpp"
#include "platform/files/input_error.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "platform/service/map_image.hpp"

namespace crspf {

namespace {

constexpr std::uint64_t kSlice = 1'000'000;  ///< some milliseconds of work

int percent(double share) {
    return static_cast<int>(std::lround(100.0 * share));
}

std::string words_of(const Relocalization& found, double seconds) {
    std::array<char, 200> text{};
    switch (found.verdict) {
        case PlaceVerdict::kUnfinished:
        case PlaceVerdict::kNoAnswer:
            std::snprintf(text.data(), text.size(),
                          "no answer: no map, too few hits in the scan (%u), or not done in time (%.1f s)", found.hits,
                          seconds);
            break;
        case PlaceVerdict::kNotFound:
            std::snprintf(text.data(), text.size(), "not found: no place explains more than %d %% of the scan",
                          percent(found.share));
            break;
        case PlaceVerdict::kAmbiguous:
            std::snprintf(text.data(), text.size(), "ambiguous: two places explain %d %% and %d %% of the scan",
                          percent(found.share), percent(found.runner_up));
            break;
        case PlaceVerdict::kFound:
            std::snprintf(
                text.data(), text.size(),
                "found at %.2f m, %.2f m, %.1f deg: it explains %d %% of the scan, the next best place %d %%; "
                "%.2f s",
                found.P_map_base.x_m, found.P_map_base.y_m, degrees(found.P_map_base.theta_rad), percent(found.share),
                percent(found.runner_up), seconds);
            break;
    }
    return text.data();
}

}  // namespace

const char* verdict_name(PlaceVerdict verdict) {
    switch (verdict) {
        case PlaceVerdict::kUnfinished:  // in its time
        case PlaceVerdict::kNoAnswer: break;
        case PlaceVerdict::kNotFound: return "not found";
        case PlaceVerdict::kAmbiguous: return "ambiguous";
        case PlaceVerdict::kFound: return "found";
    }
    return "no answer";
}

PoseSearch::~PoseSearch() {
    give_up_ = true;  // the future's end waits for the thread's
}

std::uint64_t PoseSearch::ask() {
    asked_ = true;
    // A search that is on may have begun before what the asker knows of: the next one answers.
    return state_.searches + (state_.searching ? 2 : 1);
}

std::optional<FilterCommand> PoseSearch::turn(Stamp now, bool lost, const std::function<GridMap()>& copy_map,
                                              std::vector<ServiceEvent>& events) {
    if (search_.valid()) {
        if (search_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
            return std::nullopt;
        }
        ended_ = now;
        return conclude(search_.get(), lost, events);
    }
    const bool due = when_lost_ && lost && (!ended_ || now - *ended_ > kPause);
    if (!asked_ && !due) {
        exchange_.scans_wanted = false;
        return std::nullopt;
    }
    if (!exchange_.scans_wanted.exchange(true)) {
        exchange_.seen.update();  // one of an earlier time may lie there
        wanted_ = now;
        return std::nullopt;
    }
    if (!exchange_.seen.update()) {
        if (asked_ && now - wanted_ > kScanMax) {
            asked_ = false;
            ended_ = now;
            end({}, "no answer: no scan has come", events);
        }
        return std::nullopt;
    }
    exchange_.scans_wanted = false;
    try {
        begin(copy_map(), exchange_.seen.value());
        by_request_ = std::exchange(asked_, false);
    } catch (const InputError& e) {
        ended_ = now;
        events.push_back({.bad = true, .text = std::string("the robot is not looked for: ") + e.what()});
    }
    return std::nullopt;
}

void PoseSearch::begin(GridMap map, const SeenScan& seen) {
    search_ = std::async(
        std::launch::async,
        [this, map = std::move(map), seen = std::make_shared<const SeenScan>(seen)] { return search(map, *seen); });
    state_.searching = true;
}

PoseSearch::Result PoseSearch::search(const GridMap& map, const SeenScan& seen) const {
    const Stamp begin = monotonic_now();
    const std::vector<Evidence> cells = evidence_of(map);
    const MapView view = view_of(map, cells);
    const auto relocalizer = std::make_unique<Relocalizer>(RelocalizationParams{});
    std::vector<std::uint8_t> memory(relocalizer->bytes_needed(view));
    Result result{.found = {}, .P_odom_base = seen.P_odom_base, .seconds = 0.0};
    if (relocalizer->load(view, memory)) {
        relocalizer->begin(seen.points);
        while (!give_up_ && monotonic_now() - begin < kSearchMax && !relocalizer->step(kSlice)) {
        }
        result.found = relocalizer->result();
    }
    result.seconds = (monotonic_now() - begin).seconds();
    return result;
}

std::optional<FilterCommand> PoseSearch::conclude(const Result& result, bool lost, std::vector<ServiceEvent>& events) {
    end(result, words_of(result.found, result.seconds), events);
    // It may have found its way meanwhile.
    if (result.found.verdict != PlaceVerdict::kFound || !(lost || by_request_)) {
        return std::nullopt;
    }
    return FilterCommand{.P_map_base = result.found.P_map_base, .P_odom_base = result.P_odom_base};
}

void PoseSearch::end(const Result& result, std::string words, std::vector<ServiceEvent>& events) {
    const bool found = result.found.verdict == PlaceVerdict::kFound;
    events.push_back({.bad = !found, .text = "the robot was looked for in the map: " + words});
    state_ = {.searching = false,
              .searches = state_.searches + 1,
              .found = state_.found + (found ? 1 : 0),
              .last = result.found,
              .last_s = result.seconds,
              .last_words = std::move(words)};
}

}  // namespace crspf
