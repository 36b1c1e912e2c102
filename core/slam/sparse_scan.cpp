#include "core/slam/sparse_scan.hpp"

#include <algorithm>

#include "core/base/real.hpp"

namespace crspf {
namespace {

/// Calls `use(x_m, y_m)` for hits that lie apart, in the lidar's frame.
template <typename Use>
void for_each_apart(const ScanPoints& points, double apart_m, Use&& use) {
    constexpr double kFarthest_m = 1000.0;
    const Pose2 P_lidar_base = inverse(points.P_base_first_lidar);
    const SinCos r = sin_cos(P_lidar_base.theta_rad);
    double last_x_m = 0.0;
    double last_y_m = 0.0;
    bool first = true;
    for (std::uint32_t i = 0; i < points.count; ++i) {
        const auto base_x_m = static_cast<double>(points.x_m[i]);
        const auto base_y_m = static_cast<double>(points.y_m[i]);
        const double x_m = P_lidar_base.x_m + (r.cos * base_x_m - r.sin * base_y_m);
        const double y_m = P_lidar_base.y_m + (r.sin * base_x_m + r.cos * base_y_m);
        const bool near = !first && square(x_m - last_x_m) + square(y_m - last_y_m) < square(apart_m);
        if (near || !(square(x_m) + square(y_m) < square(kFarthest_m))) {
            continue;
        }
        first = false;
        last_x_m = x_m;
        last_y_m = y_m;
        use(x_m, y_m);
    }
}

}  // namespace

void SparseScan::take(const ScanPoints& points, double apart_m) {
    std::uint32_t all = 0;
    for_each_apart(points, apart_m, [&](double, double) { ++all; });
    const std::uint32_t every = all > kHits ? (all - 1) / kHits + 1 : 1;
    count = 0;
    double squares = 0.0;
    std::uint32_t next = 0;
    for_each_apart(points, apart_m, [&](double hit_x_m, double hit_y_m) {
        if (next++ % every == 0) {
            x_m[count] = static_cast<float>(hit_x_m);
            y_m[count] = static_cast<float>(hit_y_m);
            ++count;
            squares += square(hit_x_m) + square(hit_y_m);
        }
    });
    rms_range_m = count > 0 ? square_root(squares / count) : 0.0;
}

}  // namespace crspf
