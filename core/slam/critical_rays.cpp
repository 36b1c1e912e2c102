#include "core/slam/critical_rays.hpp"

#include <algorithm>
#include <limits>

#include "core/base/real.hpp"
#include "core/base/trig.hpp"

namespace crspf {
namespace {

constexpr float kStraight = -1.0F;

// Neighbours on one surface seen at an angle of incidence of at least 10 degrees are nearer than this.
bool same_surface(const ScanPoints& p, std::uint32_t i, std::uint32_t j, double noise_m) {
    if (p.beam[j] != p.beam[i] + 1) {
        return false;
    }
    constexpr double kInverseSinOf10Degrees = 5.758770483143634;
    const auto nearer_m = static_cast<double>(std::min(p.range_m[i], p.range_m[j]));
    const double limit_m = nearer_m * p.angle_increment_rad * kInverseSinOf10Degrees + 3.0 * noise_m;
    const auto dx = static_cast<double>(p.x_m[j] - p.x_m[i]);
    const auto dy = static_cast<double>(p.y_m[j] - p.y_m[i]);
    return square(dx) + square(dy) <= square(limit_m);
}

}  // namespace

std::uint32_t CriticalRays::select(const ScanPoints& points, std::array<bool, capacity::kBeams>& critical) {
    const std::uint32_t n = points.count;
    std::fill_n(critical.begin(), n, false);
    if (!params_.enabled) {
        return 0;
    }
    std::uint32_t begin = 0;
    for (std::uint32_t i = 1; i <= n; ++i) {
        if (i == n || !same_surface(points, i - 1, i, range_noise_m_)) {
            measure_chain(points, begin, i);
            begin = i;
        }
    }
    const auto threshold = static_cast<float>(sin_cos(params_.angle_max_rad).cos);
    const auto window = static_cast<std::uint32_t>(params_.window_max);
    std::uint32_t found = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
        const float own = sharpness_[i];
        if (own <= threshold) {
            continue;
        }
        // Sharper means a larger cosine. Missing beams do not stretch the window: it counts points, as the paper does.
        bool sharpest = true;
        for (std::uint32_t v = i > window ? i - window : 0; v < i && sharpest; ++v) {
            sharpest = sharpness_[v] < own;
        }
        for (std::uint32_t v = i + 1; v <= std::min(i + window, n - 1) && sharpest; ++v) {
            sharpest = sharpness_[v] <= own;
        }
        critical[i] = sharpest;
        found += sharpest ? 1 : 0;
    }
    return found;
}

void CriticalRays::measure_chain(const ScanPoints& p, std::uint32_t begin, std::uint32_t end) {
    const auto near = static_cast<std::uint32_t>(params_.window_min);
    const auto far = static_cast<std::uint32_t>(params_.window_max);
    const auto shortest = static_cast<float>(square(3.0 * range_noise_m_));
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    std::fill(sharpness_.begin() + begin, sharpness_.begin() + end, kStraight);
    if (end - begin < 2 * near + 1) {
        return;
    }
    // By arm lengths outside and by points inside: the inner loops have no branch, and compilers make vectors of them.
    for (std::uint32_t d = near; d <= far; ++d) {
        for (std::uint32_t i = begin; i + d < end; ++i) {
            const float dx = p.x_m[i + d] - p.x_m[i];
            const float dy = p.y_m[i + d] - p.y_m[i];
            const float squared = dx * dx + dy * dy;
            const float scale = squared > shortest ? 1.0F / __builtin_sqrtf(squared) : kNone;
            arm_x_[d][i] = dx * scale;
            arm_y_[d][i] = dy * scale;
        }
    }
    for (std::uint32_t b = near; b <= far; ++b) {
        for (std::uint32_t a = near; a <= far; ++a) {
            for (std::uint32_t i = begin + b; i + a < end; ++i) {
                // (6): the cosine rule is the dot product of the two arms' directions. Nothing compares with NaN.
                const float cosine = -(arm_x_[b][i - b] * arm_x_[a][i] + arm_y_[b][i - b] * arm_y_[a][i]);
                sharpness_[i] = cosine > sharpness_[i] ? cosine : sharpness_[i];
            }
        }
    }
}

}  // namespace crspf
