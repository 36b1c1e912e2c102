#include "tools/sim/sweep.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace crspf::sim {
namespace {

class PlanarSweep final : public Sweep {
 public:
    PlanarSweep(const World& world, const SimulationParams& params)
        : world_(&world),
          lidar_(params.lidar, params.seed),
          P_base_lidar_(params.P_base_lidar),
          time_per_beam_s_(params.lidar.time_per_beam_s()),
          origin_us_(params.start_us) {}

    void advance(const Motion& motion, double start_s, double length_s, const Movers& movers) override {
        for (;;) {
            const double scan_s = static_cast<double>(stamp_us_) * 1e-6;
            const double into_step_s = scan_s + beam_ * time_per_beam_s_ - start_s;
            if (into_step_s >= length_s) {
                return;
            }
            const Pose2 P_world_base = motion.pose_at(into_step_s);
            if (beam_ == 0) {
                truth_.push_back(
                    {.stamp_s = static_cast<double>(origin_us_) * 1e-6 + scan_s, .P_map_base = P_world_base});
                scan_ = {.stamp_us = origin_us_ + stamp_us_,
                         .counts = motion.counts_at(into_step_s),
                         .range_mm = std::vector<int>(lidar_.model().beams)};
            }
            scan_.range_mm[beam_] = lidar_.read_mm(*world_, movers, P_world_base * P_base_lidar_, beam_);
            if (++beam_ == lidar_.model().beams) {
                finished_.push_back(std::move(scan_));
                beam_ = 0;
                stamp_us_ = to_us(static_cast<double>(++scans_) / lidar_.model().scan_rate_hz);
            }
        }
    }

    void deliver(LogWriter& writer, std::string& out) override {
        for (const ScanRecord& scan : finished_) {
            writer.scan(scan, out);
        }
        finished_.clear();
    }

    [[nodiscard]] std::vector<TimedPose> truth() const override { return {truth_.begin(), truth_.begin() + scans_}; }

 private:
    const World* world_;
    Lidar lidar_;
    Pose2 P_base_lidar_;
    double time_per_beam_s_;
    std::int64_t origin_us_;     ///< stamp of the drive's start
    std::ptrdiff_t scans_ = 0;   ///< finished
    std::int64_t stamp_us_ = 0;  ///< of the present scan, since the drive's start
    std::uint32_t beam_ = 0;     ///< next to be measured
    ScanRecord scan_;
    std::vector<ScanRecord> finished_;
    std::vector<TimedPose> truth_;
};

}  // namespace

std::unique_ptr<Sweep> planar_sweep(const World& world, const SimulationParams& params) {
    return std::make_unique<PlanarSweep>(world, params);
}

}  // namespace crspf::sim
