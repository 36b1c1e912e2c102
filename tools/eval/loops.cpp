#include "tools/eval/loops.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>

#include "platform/files/input_error.hpp"

namespace crspf::eval {
namespace {

/// A scan at which the walk along the trajectory stops.
struct Station {
    std::size_t scan;
    Pose2 P_map_base;
    double path_m;  ///< from the start; standing still adds nothing, however the poses tremble
};

double distance_m(const Pose2& a, const Pose2& b) {
    return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m);
}

double turn_rad(const Pose2& a, const Pose2& b) {
    return std::abs(wrap_angle(a.theta_rad - b.theta_rad));
}

std::vector<Station> walk(const std::vector<TimedPose>& trajectory) {
    constexpr double kStep_m = 0.25;
    constexpr double kStep_rad = radians(10.0);
    std::vector<Station> stations;
    for (std::size_t i = 0; i < trajectory.size(); ++i) {
        const Pose2& pose = trajectory[i].P_map_base;
        if (stations.empty()) {
            stations.push_back({.scan = i, .P_map_base = pose, .path_m = 0.0});
            continue;
        }
        const Station& last = stations.back();
        const double moved_m = distance_m(pose, last.P_map_base);
        if (moved_m >= kStep_m || turn_rad(pose, last.P_map_base) >= kStep_rad) {
            stations.push_back({.scan = i, .P_map_base = pose, .path_m = last.path_m + moved_m});
        }
    }
    return stations;
}

/// Compares all stations with all others: at 25 cm a step that is nothing beside the alignments, up to tens of km.
class Walk {
 public:
    Walk(const std::vector<TimedPose>& trajectory, const LoopOptions& options)
        : stations_(walk(trajectory)), options_(options) {}

    [[nodiscard]] const std::vector<Station>& stations() const { return stations_; }

    /// The earlier visit that lies best for an alignment.
    [[nodiscard]] std::optional<std::size_t> earlier_visit(std::size_t later) const {
        return best_of(later, [](const Station& /*unused*/) { return true; });
    }

    /// Another stop of the same visit as `earlier`, so with another view.
    [[nodiscard]] std::optional<std::size_t> second_view(std::size_t later, std::size_t earlier) const {
        constexpr double kSameVisit_m = 2.0;
        return best_of(later, [&first = stations_[earlier]](const Station& s) {
            return s.scan != first.scan && std::abs(s.path_m - first.path_m) <= kSameVisit_m;
        });
    }

 private:
    template <typename Admitted>
    std::optional<std::size_t> best_of(std::size_t later, Admitted admitted) const {
        const Station& here = stations_[later];
        std::optional<std::size_t> best;
        double least = 2.0;  // above what any place within both limits has
        for (std::size_t i = 0; here.path_m - stations_[i].path_m >= options_.least_path_m; ++i) {
            const double far = distance_m(here.P_map_base, stations_[i].P_map_base) / options_.nearby_m;
            if (far > 1.0 || !admitted(stations_[i])) {
                continue;
            }
            const double turned = turn_rad(here.P_map_base, stations_[i].P_map_base) / options_.turn_max_rad;
            if (turned <= 1.0 && far + turned < least) {
                least = far + turned;
                best = i;
            }
        }
        return best;
    }

    std::vector<Station> stations_;
    LoopOptions options_;
};

/// One stop on known ground.
struct Revisit {
    std::size_t earlier;  ///< stations
    std::size_t later;
    AlignmentVerdict verdict = AlignmentVerdict::kTooFewPoints;
    bool confirmed = false;
    double position_m = 0.0;
    double heading_deg = 0.0;
};

/// What the trajectory says of the later station seen from the earlier one, less what the scans say.
struct Discrepancy {
    AlignmentVerdict verdict = AlignmentVerdict::kTooFewPoints;
    Pose2 error;  ///< seen along the axes of the map
};

class Measure {
 public:
    Measure(const std::vector<LoggedScan>& scans, const Walk& walk, const LoopOptions& options)
        : scans_(scans), walk_(walk), options_(options) {}

    [[nodiscard]] Revisit operator()(std::size_t earlier, std::size_t later) const {
        Revisit revisit{.earlier = earlier, .later = later};
        const Discrepancy first = discrepancy(earlier, later);
        revisit.verdict = first.verdict;
        if (first.verdict != AlignmentVerdict::kGood) {
            return revisit;
        }
        // A wrong alignment is worse than none: a second view must say the same.
        const std::optional<std::size_t> other = walk_.second_view(later, earlier);
        if (!other) {
            return revisit;
        }
        const Discrepancy second = discrepancy(*other, later);
        constexpr double kAgree_m = 0.1;
        constexpr double kAgree_rad = radians(2.0);
        revisit.confirmed = second.verdict == AlignmentVerdict::kGood &&
                            distance_m(first.error, second.error) <= kAgree_m &&
                            turn_rad(first.error, second.error) <= kAgree_rad;
        revisit.position_m = std::hypot(first.error.x_m, first.error.y_m);
        revisit.heading_deg = std::abs(degrees(first.error.theta_rad));
        return revisit;
    }

 private:
    [[nodiscard]] Discrepancy discrepancy(std::size_t earlier, std::size_t later) const {
        const Station& from = walk_.stations()[earlier];
        const Station& to = walk_.stations()[later];
        const Pose2 P_earlier_later = inverse(from.P_map_base) * to.P_map_base;
        const ScanAlignment found =
            align_scans(scans_[from.scan].hits, scans_[to.scan].hits, P_earlier_later, options_.window);
        const Pose2 P_map_aligned = from.P_map_base * found.P_reference_scan;
        return {.verdict = found.verdict,
                .error = {.x_m = to.P_map_base.x_m - P_map_aligned.x_m,
                          .y_m = to.P_map_base.y_m - P_map_aligned.y_m,
                          .theta_rad = wrap_angle(to.P_map_base.theta_rad - P_map_aligned.theta_rad)}};
    }

    const std::vector<LoggedScan>& scans_;
    const Walk& walk_;
    const LoopOptions& options_;
};

/// The stretch [begin, end) of revisits as one loop's end.
LoopEnd loop_end(const std::vector<Revisit>& revisits, std::size_t begin, std::size_t end,
                 const std::vector<Station>& stations, const std::vector<TimedPose>& trajectory,
                 const LoopOptions& options) {
    const auto path_m = [&](std::size_t revisit) { return stations[revisits[revisit].later].path_m; };
    std::size_t first = end;
    LoopEnd loop;
    loop.revisits = end - begin;
    for (std::size_t i = begin; i < end; ++i) {
        const Revisit& revisit = revisits[i];
        if (!revisit.confirmed) {
            continue;
        }
        ++loop.measured;
        first = std::min(first, i);
        if (path_m(i) - path_m(first) <= options.end_m) {
            loop.position_m = std::max(loop.position_m, revisit.position_m);
            loop.heading_deg = std::max(loop.heading_deg, revisit.heading_deg);
        }
    }
    const std::size_t shown = first < end ? first : begin;
    const Station& earlier = stations[revisits[shown].earlier];
    const Station& later = stations[revisits[shown].later];
    loop.earlier_stamp_s = trajectory[earlier.scan].stamp_s;
    loop.later_stamp_s = trajectory[later.scan].stamp_s;
    loop.P_map_later = later.P_map_base;
    loop.length_m = later.path_m - earlier.path_m;
    loop.late_m = path_m(shown) - path_m(begin);
    return loop;
}

}  // namespace

void require_pose_per_scan(const std::vector<LoggedScan>& scans, const std::vector<TimedPose>& trajectory,
                           const std::filesystem::path& file) {
    if (scans.size() != trajectory.size()) {
        throw InputError(file.string() + ": " + std::to_string(trajectory.size()) + " poses for " +
                         std::to_string(scans.size()) +
                         " scans; give all logs of the run, in order, and a trajectory with one pose a scan");
    }
    constexpr double kEqual_s = 1e-3;
    for (std::size_t i = 0; i < scans.size(); ++i) {
        if (!(std::abs(scans[i].stamp_s - trajectory[i].stamp_s) <= kEqual_s)) {
            std::ostringstream text;
            text << std::fixed << std::setprecision(6) << file.string() << ": pose " << i + 1 << " has the stamp "
                 << trajectory[i].stamp_s << ", scan " << i + 1 << " of the logs " << scans[i].stamp_s
                 << "; is it the trajectory of this run?";
            throw InputError(text.str());
        }
    }
}

LoopErrors loop_errors(const std::vector<LoggedScan>& scans, const std::vector<TimedPose>& trajectory,
                       const LoopOptions& options) {
    if (scans.size() != trajectory.size()) {
        throw std::invalid_argument("loop_errors: one pose a scan");
    }
    const Walk walk(trajectory, options);
    const std::vector<Station>& stations = walk.stations();
    const Measure measure(scans, walk, options);
    std::vector<Revisit> revisits;
    for (std::size_t later = 0; later < stations.size(); ++later) {
        if (const auto earlier = walk.earlier_visit(later)) {
            revisits.push_back(measure(*earlier, later));
        }
    }

    LoopErrors errors;
    errors.revisits = revisits.size();
    std::vector<double> position_m;
    std::vector<double> heading_deg;
    for (const Revisit& revisit : revisits) {
        ++errors.verdicts.at(static_cast<std::size_t>(revisit.verdict));
        if (revisit.confirmed) {
            position_m.push_back(revisit.position_m);
            heading_deg.push_back(revisit.heading_deg);
        } else if (revisit.verdict == AlignmentVerdict::kGood) {
            ++errors.unconfirmed;
        }
    }
    errors.position_m = summarise(std::move(position_m));
    errors.heading_deg = summarise(std::move(heading_deg));

    // A stretch may pause where the robot turns or dodges; new ground is longer.
    constexpr double kNewGround_m = 5.0;
    for (std::size_t begin = 0; begin < revisits.size();) {
        std::size_t end = begin + 1;
        while (end < revisits.size() &&
               stations[revisits[end].later].path_m - stations[revisits[end - 1].later].path_m < kNewGround_m) {
            ++end;
        }
        errors.ends.push_back(loop_end(revisits, begin, end, stations, trajectory, options));
        begin = end;
    }
    return errors;
}

}  // namespace crspf::eval
