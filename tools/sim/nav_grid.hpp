// Where a round body may stand, and the way from one such place to another.
#pragma once

#include <cstdint>
#include <vector>

#include "tools/sim/random.hpp"
#include "tools/sim/world.hpp"

namespace crspf::sim {

class NavGrid {
 public:
    /// All places that a body of `radius_m` can reach from `start`, on a grid of 0.1 m. `world` must outlive this.
    /// Throws InputError if the body does not fit at `start`.
    NavGrid(const World& world, Point start, double radius_m);

    [[nodiscard]] bool reachable(Point p) const;

    /// A reachable place, all equally likely.
    [[nodiscard]] Point random_place(Random& random) const;

    /// `count` random places, each far from those before it.
    [[nodiscard]] std::vector<Point> spread_places(std::size_t count, Random& random) const;

    /// A smooth way in steps of about 0.1 m that keeps off the walls where there is room. Both ends are moved to the
    /// nearest reachable cell if need be; empty if there is none within 0.5 m.
    [[nodiscard]] std::vector<Point> plan(Point from, Point to) const;

 private:
    static constexpr std::uint32_t kNone = UINT32_MAX;

    [[nodiscard]] Point centre(std::uint32_t cell) const;
    [[nodiscard]] std::uint32_t cell_at(Point p) const;
    [[nodiscard]] std::uint32_t nearest_reachable(Point p) const;
    [[nodiscard]] std::vector<Point> smooth(std::vector<Point> path) const;
    template <typename Visit>
    void for_each_neighbour(std::uint32_t cell, Visit visit) const;

    const World* world_;
    double radius_m_;
    std::uint32_t columns_ = 0;
    std::uint32_t rows_ = 0;
    std::vector<float> clearance_m_;       ///< of each cell's centre, up to radius_m_ + kComfort_m
    std::vector<std::uint8_t> reachable_;  ///< 0 or 1, by cell
    std::vector<std::uint32_t> reachable_cells_;
};

}  // namespace crspf::sim
