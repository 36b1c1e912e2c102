// Global relocalisation: a robot that is lost is looked for in the whole map, beside the real-time threads.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "core/base/time.hpp"
#include "core/slam/relocalization.hpp"
#include "platform/crspfd/exchange.hpp"
#include "platform/crspfd/service_event.hpp"
#include "platform/files/grid_map.hpp"

namespace crspf {

/// "found", "ambiguous", "not found" or "no answer".
[[nodiscard]] const char* verdict_name(PlaceVerdict verdict);

struct PoseSearchState {
    bool searching = false;
    std::uint64_t searches = 0;  ///< that have come to their end
    std::uint64_t found = 0;
    Relocalization last;     ///< of them
    double last_s = 0.0;     ///< [s] that it took
    std::string last_words;  ///< how it ended
};

/// The control thread's. A search has an ordinary thread of its own, is bounded in time, and waits for nobody.
class PoseSearch {
 public:
    static constexpr Duration kSearchMax{10'000'000'000};
    static constexpr Duration kScanMax{2'000'000'000};  ///< waited for a scan to search with
    static constexpr Duration kPause{2'000'000'000};    ///< between two searches for a robot that stays lost

    /// @param when_lost also without being asked
    PoseSearch(Exchange& exchange, bool when_lost) : exchange_(exchange), when_lost_(when_lost) {}
    PoseSearch(const PoseSearch&) = delete;
    PoseSearch& operator=(const PoseSearch&) = delete;
    /// A search that is on is given up.
    ~PoseSearch();

    /// Somebody wants to know.
    /// @return the value of PoseSearchState::searches when the answer is there
    std::uint64_t ask();
    /// Goes on: asks for a scan, begins, takes the result.
    /// @param lost by the filter's last word
    /// @param copy_map called when a search begins; may throw InputError
    /// @return the robot's place, when it was found
    std::optional<FilterCommand> turn(Stamp now, bool lost, const std::function<GridMap()>& copy_map,
                                      std::vector<ServiceEvent>& events);

    [[nodiscard]] const PoseSearchState& state() const { return state_; }

 private:
    struct Result {
        Relocalization found;
        Pose2 P_odom_base;
        double seconds = 0.0;
    };

    void begin(GridMap map, const SeenScan& seen);
    [[nodiscard]] Result search(const GridMap& map, const SeenScan& seen) const;
    void end(const Result& result, std::string words, std::vector<ServiceEvent>& events);
    std::optional<FilterCommand> conclude(const Result& result, bool lost, std::vector<ServiceEvent>& events);

    Exchange& exchange_;
    bool when_lost_;
    bool asked_ = false;
    bool by_request_ = false;  ///< the search that is on
    Stamp wanted_;             ///< a scan, since
    std::optional<Stamp> ended_;
    PoseSearchState state_;
    std::atomic<bool> give_up_{false};
    std::future<Result> search_;
};

}  // namespace crspf
