// Which way the surface under each point faces (beyond the paper): a point on a straight surface says where the robot
// is across it, and nothing along it.
#pragma once

#include <array>

#include "config/capacities.hpp"
#include "core/slam/scan_points.hpp"

namespace crspf {

/// Fits a line to each point with its neighbours, eight beams to either side. Linear in the points; no heap, no throw.
/// One owner.
class SurfaceNormals {
 public:
    explicit SurfaceNormals(double range_noise_m) : range_noise_m_(range_noise_m) {}

    /// Reads the normals of all hits of `points`.
    void measure(const ScanPoints& points);

    /// Unit normal at point i in base_link; its sign means nothing. (0, 0) where the points form no straight line
    /// within 2.5 times the range noise: corners, edges, clutter, points alone.
    [[nodiscard]] float x(std::size_t i) const { return x_[i]; }
    [[nodiscard]] float y(std::size_t i) const { return y_[i]; }

 private:
    /// Sums over the points before an index, so that any window's sums are two look-ups.
    struct Sums {
        double x = 0.0;
        double y = 0.0;
        double xx = 0.0;
        double xy = 0.0;
        double yy = 0.0;
    };

    void fit(std::size_t point, std::size_t begin, std::size_t end);

    double range_noise_m_;
    std::array<Sums, capacity::kBeams + 1> before_{};
    std::array<float, capacity::kBeams> x_{};
    std::array<float, capacity::kBeams> y_{};
};

}  // namespace crspf
