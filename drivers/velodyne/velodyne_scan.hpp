// A planar scan out of a revolution: one ring of it.
#pragma once

#include <cstdint>

#include "core/base/samples.hpp"
#include "drivers/velodyne/velodyne_cloud.hpp"
#include "drivers/velodyne/velodyne_models.hpp"
#include "drivers/velodyne/velodyne_params.hpp"

namespace crspf {

/// Each beam takes the nearest column to its middle; of two returns the last, which sees through rain and glass. Ranges
/// are along the ground: a ring of one degree is a cone. Beams between which no column was measured are kInvalid. The
/// sensor turns clockwise, scans are counter-clockwise: beam 0 was measured last, and time_per_beam_s is negative.
/// Wait-free. One owner.
class VelodyneScanner {
 public:
    VelodyneScanner(const VelodyneScanParams& params, VelodyneModel model, const VelodyneCalibration& calibration);

    /// False, and `out` without beams, for a revolution that is not complete or of another model.
    /// @param cut_rad where the revolution began: VelodyneParams::cut_rad
    [[nodiscard]] bool scan(const VelodyneCloud& cloud, double cut_rad, Scan& out);

    [[nodiscard]] std::uint32_t laser() const { return laser_; }

 private:
    VelodyneModel model_;
    std::uint32_t beams_;
    std::uint32_t laser_;
    double firing_s_;
    double rotation_rad_;
    /// How far the column that a beam took lies from its middle, in beams.
    std::array<float, capacity::kBeams> aside_{};
};

}  // namespace crspf
