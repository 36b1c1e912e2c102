// What one scan says about the plane around it: where walls are and which way they face, and where it looked through.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tools/eval/scan_alignment.hpp"

namespace crspf::eval {

/// A raster of base_link, made once for a scan and then looked up often.
class WallField {
 public:
    static constexpr double kCell_m = 0.05;
    /// Walls are known to cells up to so far from them.
    static constexpr double kReach_m = 0.3;

    /// A piece of wall about as long as a cell.
    struct Wall {
        Eigen::Vector2d point;   ///< [m]
        Eigen::Vector2d normal;  ///< unit length, either side
    };

    /// @param margin_m the raster reaches at least so far beyond the hits, so that a search need not look for its edge
    WallField(const ScanHits& scan, double margin_m);

    [[nodiscard]] const std::vector<Wall>& walls() const { return walls_; }

    /// The piece of wall nearest to `p`'s cell; nullptr where none is within reach.
    [[nodiscard]] const Wall* wall_near(const Eigen::Vector2d& p) const;
    /// A beam went through `p`'s cell and on for at least kReach_m.
    [[nodiscard]] bool looked_through(const Eigen::Vector2d& p) const;

    /// For searches that step by whole cells: nearness of walls, 255 on one down to 0 out of reach, row by row.
    [[nodiscard]] const std::vector<std::uint8_t>& nearness() const { return nearness_; }
    [[nodiscard]] int width() const { return width_; }
    /// Place of `p`'s cell; negative where it is off the raster, or nearer than `border` cells to its edge.
    [[nodiscard]] std::ptrdiff_t place(const Eigen::Vector2d& p, int border = 0) const;

 private:
    void add_walls(const ScanHits& scan);
    void paint_walls();
    void look_through(const ScanHits& scan);

    Eigen::Vector2d corner_;  ///< [m] lower left
    int width_ = 0;
    int height_ = 0;
    std::vector<Wall> walls_;
    std::vector<std::uint16_t> nearest_;
    std::vector<std::uint8_t> nearness_;
    std::vector<std::uint8_t> through_;
};

/// Hits beyond are left out everywhere. [m] from the lidar
inline constexpr double kFarthestHit_m = 25.0;

}  // namespace crspf::eval
