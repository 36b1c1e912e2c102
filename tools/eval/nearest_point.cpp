#include "tools/eval/nearest_point.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace crspf::eval {

NearestPoint::NearestPoint(std::vector<Eigen::Vector2d> points) : points_(std::move(points)) {
    arrange(0, points_.size(), 0);
}

double NearestPoint::distance(const Eigen::Vector2d& p, double limit) const {
    double least_squared = limit * limit;
    search(0, points_.size(), 0, p, least_squared);
    return std::sqrt(least_squared);
}

// NOLINTNEXTLINE(misc-no-recursion): as deep as the logarithm of the number of points
void NearestPoint::arrange(std::size_t begin, std::size_t end, Eigen::Index axis) {
    if (end - begin < 2) {
        return;
    }
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [this](std::size_t i) { return points_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end),
                     [axis](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a[axis] < b[axis]; });
    arrange(begin, middle, 1 - axis);
    arrange(middle + 1, end, 1 - axis);
}

// NOLINTNEXTLINE(misc-no-recursion): as above
void NearestPoint::search(std::size_t begin, std::size_t end, Eigen::Index axis, const Eigen::Vector2d& p,
                          double& least_squared) const {
    if (begin == end) {
        return;
    }
    const std::size_t middle = begin + (end - begin) / 2;
    least_squared = std::min(least_squared, (points_[middle] - p).squaredNorm());
    const double beyond = p[axis] - points_[middle][axis];
    const bool low_first = beyond < 0.0;
    for (const bool low : {low_first, !low_first}) {
        if (low == low_first || beyond * beyond < least_squared) {
            search(low ? begin : middle + 1, low ? middle : end, 1 - axis, p, least_squared);
        }
    }
}

}  // namespace crspf::eval
