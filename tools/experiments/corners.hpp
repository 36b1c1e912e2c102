// Where the outline of a simulated world bends sharply: what a critical ray ought to see.
#pragma once

#include <vector>

#include "tools/sim/world.hpp"

namespace crspf::experiments {

/// A corner is where two walls meet at more than 30 degrees, or where a wall ends.
class Corners {
 public:
    /// `world` must outlive it.
    explicit Corners(const sim::World& world);

    /// Whether one lies within `within_m` of a point, and nothing hides it from `eye`.
    [[nodiscard]] bool seen_near(sim::Point p, double within_m, sim::Point eye) const;
    [[nodiscard]] const std::vector<sim::Point>& points() const { return points_; }

 private:
    void add(sim::Point p);

    const sim::World& world_;
    std::vector<sim::Point> points_;
};

}  // namespace crspf::experiments
