#include "tools/eval/stamp_index.hpp"

#include <algorithm>
#include <cmath>

namespace crspf::eval {

StampIndex::StampIndex(const std::vector<TimedPose>& trajectory) {
    by_stamp_.reserve(trajectory.size());
    for (std::size_t i = 0; i < trajectory.size(); ++i) {
        by_stamp_.push_back({.stamp_s = trajectory[i].stamp_s, .place = i});
    }
    std::stable_sort(by_stamp_.begin(), by_stamp_.end(),
                     [](const Entry& a, const Entry& b) { return a.stamp_s < b.stamp_s; });
    const auto end = std::unique(by_stamp_.begin(), by_stamp_.end(),
                                 [](const Entry& a, const Entry& b) { return a.stamp_s == b.stamp_s; });
    by_stamp_.erase(end, by_stamp_.end());
}

std::optional<std::size_t> StampIndex::nearest(double stamp_s, double max_gap_s) const {
    if (by_stamp_.empty()) {
        return std::nullopt;
    }
    auto best = std::lower_bound(by_stamp_.begin(), by_stamp_.end(), stamp_s,
                                 [](const Entry& e, double stamp) { return e.stamp_s < stamp; });
    if (best == by_stamp_.end() ||
        (best != by_stamp_.begin() && stamp_s - std::prev(best)->stamp_s <= best->stamp_s - stamp_s)) {
        --best;
    }
    if (!(std::abs(best->stamp_s - stamp_s) <= max_gap_s)) {
        return std::nullopt;
    }
    return best->place;
}

}  // namespace crspf::eval
