// The sums over rays from which the climbs to the optimum take their steps: the match on the interpolated field, and
// how it changes with the pose.
#pragma once

#include <array>
#include <cstdint>

#include "config/capacities.hpp"
#include "core/slam/match_field.hpp"

namespace crspf {

/// The rays of a scan, by ray. Frame: base_link. Filled up with rays of weight 0 to whole blocks of kLanes.
struct RayTable {
    static constexpr std::uint32_t kLanes = 8;
    /// Columns a power of two apart would fight for the same lines of the cache.
    using PerRay = std::array<float, capacity::kBeams + 80>;
    PerRay x{};  ///< [cells]
    PerRay y{};  ///< [cells]
    PerRay weight{};
    PerRay normal_x{};
    PerRay normal_y{};
    PerRay free{};  ///< 1: counts in all directions; 0: along the normal only
    std::uint32_t count = 0;
};

/// Sums over rays, each by its weight a. f: the field at a ray's end as a fraction of kFieldMax; (x, y): f's slope
/// there in base_link [1/cell], t: by the heading [1/rad].
struct SlopeSums {
    double f = 0.0;
    double x = 0.0;
    double y = 0.0;
    double t = 0.0;
    double miss_x = 0.0;  ///< a (1 - f) x; so are the next
    double miss_y = 0.0;
    double miss_t = 0.0;
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    double xt = 0.0;
    double yt = 0.0;
    double tt = 0.0;
    double fourth = 0.0;  ///< a (x^2 + y^2)^2
};

/// The kernels give the same sums to the last bit. Wait-free, linear in the rays.
using SlopeSum = SlopeSums (*)(const FieldView&, const RayTable&, const FieldPose&);
[[nodiscard]] SlopeSum slope_sum_kernel(Kernel kernel);

}  // namespace crspf
