// The way that the robot went, bounded however far it goes.
#pragma once

#include <cstddef>
#include <vector>

#include "core/base/pose.hpp"

namespace crspf::view {

/// Poses 10 cm from each other; where there are kPosesMax, every other one goes, and the distance doubles.
class PathKeeper {
 public:
    static constexpr std::size_t kPosesMax = 5000;
    static constexpr double kSpacing_m = 0.1;

    /// True where the pose was kept. One that is not finite is not.
    bool add(const Pose2& P_map_base);
    void clear();
    [[nodiscard]] const std::vector<Pose2>& poses() const { return poses_; }

 private:
    std::vector<Pose2> poses_;
    double spacing_m_ = kSpacing_m;
};

}  // namespace crspf::view
