// Exact nearest neighbour in the plane: a k-d tree.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <vector>

namespace crspf::eval {

class NearestPoint {
 public:
    explicit NearestPoint(std::vector<Eigen::Vector2d> points);

    /// Distance from `p` to the nearest point; `limit` where none is nearer.
    [[nodiscard]] double distance(const Eigen::Vector2d& p,
                                  double limit = std::numeric_limits<double>::infinity()) const;

 private:
    void arrange(std::size_t begin, std::size_t end, Eigen::Index axis);
    void search(std::size_t begin, std::size_t end, Eigen::Index axis, const Eigen::Vector2d& p,
                double& least_squared) const;

    /// The middle of each range is its node, the halves are its children; the axis alternates with depth.
    std::vector<Eigen::Vector2d> points_;
};

}  // namespace crspf::eval
