#include "core/slam/surface_normals.hpp"

#include <algorithm>

#include "core/base/real.hpp"

namespace crspf {

void SurfaceNormals::measure(const ScanPoints& points) {
    constexpr std::size_t kReach = 8;
    const std::size_t n = points.count;
    for (std::size_t i = 0; i < n; ++i) {
        const auto x = static_cast<double>(points.x_m[i]);
        const auto y = static_cast<double>(points.y_m[i]);
        const Sums& sums = before_[i];
        before_[i + 1] = {
            .x = sums.x + x, .y = sums.y + y, .xx = sums.xx + x * x, .xy = sums.xy + x * y, .yy = sums.yy + y * y};
    }
    std::size_t begin = 0;  // of the chain of neighbouring beams
    for (std::size_t next = 1; next <= n; ++next) {
        if (next < n && points.beam[next] == points.beam[next - 1] + 1) {
            continue;
        }
        for (std::size_t i = begin; i < next; ++i) {
            fit(i, i >= begin + kReach ? i - kReach : begin, std::min(i + kReach + 1, next));
        }
        begin = next;
    }
}

void SurfaceNormals::fit(std::size_t point, std::size_t begin, std::size_t end) {
    constexpr double kStraight = 2.5;  // standard deviations of the range noise
    constexpr double kSlender = 4.0;   // the fewest times that a line's variance along exceeds that across
    x_[point] = 0.0F;
    y_[point] = 0.0F;
    if (end - begin < 3) {
        return;
    }
    const Sums& a = before_[begin];
    const Sums& b = before_[end];
    const double share = 1.0 / static_cast<double>(end - begin);
    const double mean_x = (b.x - a.x) * share;
    const double mean_y = (b.y - a.y) * share;
    const double xx = (b.xx - a.xx) * share - mean_x * mean_x;
    const double xy = (b.xy - a.xy) * share - mean_x * mean_y;
    const double yy = (b.yy - a.yy) * share - mean_y * mean_y;
    const double spread = square_root(square(xx - yy) + 4.0 * square(xy));
    const double along = 0.5 * (xx + yy + spread);
    const double across = std::max(0.5 * (xx + yy - spread), 0.0);
    if (across > square(kStraight * range_noise_m_) || along < kSlender * across) {
        return;
    }
    // Two forms of the eigenvector to `across`; the longer one is exact where the other vanishes.
    const double normal_x = xx > yy ? -xy : yy - across;
    const double normal_y = xx > yy ? xx - across : -xy;
    const double length = square_root(square(normal_x) + square(normal_y));
    if (length > 0.0) {
        x_[point] = static_cast<float>(normal_x / length);
        y_[point] = static_cast<float>(normal_y / length);
    }
}

}  // namespace crspf
