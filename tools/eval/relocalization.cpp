#include "tools/eval/relocalization.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <string>
#include <utility>

#include "core/base/rng.hpp"
#include "core/slam/place_check.hpp"
#include "core/slam/relocalization.hpp"
#include "core/slam/sparse_scan.hpp"
#include "platform/files/input_error.hpp"
#include "platform/service/map_image.hpp"
#include "tools/eval/logged_scans.hpp"

namespace crspf::eval {
namespace {

double processor_time_s() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// `count` different places of `size`.
std::vector<bool> chosen(std::size_t size, std::size_t count, std::uint64_t seed) {
    std::vector<bool> out(size, false);
    Rng rng(seed);
    for (std::size_t left = std::min(count, size); left > 0;) {
        const std::size_t at = rng.next() % size;
        if (!out[at]) {
            out[at] = true;
            --left;
        }
    }
    return out;
}

/// The errors of one report, scan by scan.
class Tally {
 public:
    explicit Tally(const RelocalizationOptions& options) : options_(options) {}

    /// @param share_at_truth of the scan that the truth explains
    void add(const Relocalization& found, const Pose2& truth, double share_at_truth, double time_s) {
        ++report_.scans;
        time_s_.push_back(time_s);
        const double error_m = std::hypot(found.P_map_base.x_m - truth.x_m, found.P_map_base.y_m - truth.y_m);
        const double error_deg = degrees(std::abs(wrap_angle(found.P_map_base.theta_rad - truth.theta_rad)));
        const bool right = error_m <= options_.right_m && error_deg <= options_.right_deg;
        switch (found.verdict) {
            case PlaceVerdict::kUnfinished:
            case PlaceVerdict::kNoAnswer: ++report_.no_answer; return;
            case PlaceVerdict::kNotFound: ++report_.not_found; break;
            case PlaceVerdict::kAmbiguous:
                ++report_.ambiguous;
                report_.ambiguous_right += right ? 1 : 0;
                break;
            case PlaceVerdict::kFound:
                ++(right ? report_.right : report_.wrong);
                if (right) {
                    position_m_.push_back(error_m);
                    heading_deg_.push_back(error_deg);
                } else {
                    wrong_share_.push_back(found.share);
                    wrong_at_truth_.push_back(share_at_truth);
                }
                break;
        }
        share_.push_back(found.share);
        runner_up_.push_back(found.runner_up);
    }

    [[nodiscard]] RelocalizationReport finish() {
        report_.share = summarise(std::move(share_));
        report_.runner_up = summarise(std::move(runner_up_));
        report_.wrong_share = summarise(std::move(wrong_share_));
        report_.wrong_at_truth = summarise(std::move(wrong_at_truth_));
        report_.position_m = summarise(std::move(position_m_));
        report_.heading_deg = summarise(std::move(heading_deg_));
        report_.time_s = summarise(std::move(time_s_));
        return report_;
    }

 private:
    RelocalizationOptions options_;
    RelocalizationReport report_;
    std::vector<double> share_;
    std::vector<double> runner_up_;
    std::vector<double> wrong_share_;
    std::vector<double> wrong_at_truth_;
    std::vector<double> position_m_;
    std::vector<double> heading_deg_;
    std::vector<double> time_s_;
};

}  // namespace

RelocalizationReport relocalize(const GridMap& map, const std::vector<std::filesystem::path>& logs,
                                const Config& config, const std::vector<TimedPose>& trajectory,
                                const RelocalizationOptions& options) {
    const std::vector<Evidence> cells = evidence_of(map);
    const MapView view = view_of(map, cells);
    const RelocalizationParams params;
    const auto relocalizer = std::make_unique<Relocalizer>(params);
    std::vector<std::uint8_t> memory(relocalizer->bytes_needed(view));
    const double load_began_s = processor_time_s();
    if (!relocalizer->load(view, memory)) {
        throw InputError("the map has " + std::to_string(map.width) + " x " + std::to_string(map.height) +
                         " cells; a search needs a map");
    }
    const double load_s = processor_time_s() - load_began_s;

    const std::vector<bool> wanted = chosen(trajectory.size(), options.scans, options.seed);
    Tally tally(options);
    const auto hits = std::make_unique<SparseScan>();
    const Pose2 P_corner_map = inverse(view.P_map_corner);
    std::size_t scans = 0;
    for_each_scan(logs, config, [&](double, const ScanPoints& points) {
        const std::size_t i = scans++;
        if (i >= trajectory.size() || !wanted[i]) {
            return;  // a trajectory that is too short: said below
        }
        const double began_s = processor_time_s();
        relocalizer->begin(points);
        constexpr std::uint64_t kSlice = 100'000;
        while (!relocalizer->step(kSlice)) {
        }
        const double time_s = processor_time_s() - began_s;
        const Pose2& truth = trajectory[i].P_map_base;
        hits->take(points, params.cell_m);
        const double share_at_truth =
            PlaceCheck(view, *hits, params.tolerance_m).share(P_corner_map * truth * points.P_base_first_lidar);
        tally.add(relocalizer->result(), truth, share_at_truth, time_s);
    });
    if (scans != trajectory.size()) {
        throw InputError("the trajectory has " + std::to_string(trajectory.size()) + " poses, the logs have " +
                         std::to_string(scans) +
                         " scans; give all logs of the run, in order, and a trajectory with one pose a scan");
    }
    RelocalizationReport report = tally.finish();
    report.load_s = load_s;
    report.memory_bytes = memory.size();
    return report;
}

}  // namespace crspf::eval
