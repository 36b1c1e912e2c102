#include "tools/eval/wall_field.hpp"

#include <algorithm>
#include <cmath>

namespace crspf::eval {
namespace {

using Eigen::Vector2d;

constexpr std::uint16_t kNoWall = 0xFFFF;

/// Two neighbouring hits belong to one wall unless it would be seen at a glance of less than about 20 degrees.
bool connected(const Vector2d& a, const Vector2d& b, const ScanHits& scan) {
    constexpr double kGlancing = 3.0;  // 1 / sin(20 deg)
    constexpr double kNoise_m = 0.1;
    const double range_m = std::min((a - scan.lidar).norm(), (b - scan.lidar).norm());
    return (b - a).norm() < kNoise_m + kGlancing * range_m * scan.angle_increment_rad;
}

}  // namespace

WallField::WallField(const ScanHits& scan, double margin_m) {
    Vector2d low = scan.lidar;
    Vector2d high = scan.lidar;
    for (const Eigen::Vector2f& hit : scan.points) {
        const Vector2d p = hit.cast<double>();
        if ((p - scan.lidar).norm() < kFarthestHit_m) {
            low = low.cwiseMin(p);
            high = high.cwiseMax(p);
        }
    }
    const double around_m = margin_m + kReach_m + kCell_m;
    corner_ = low - Vector2d::Constant(around_m);
    width_ = static_cast<int>((high.x() + around_m - corner_.x()) / kCell_m) + 1;
    height_ = static_cast<int>((high.y() + around_m - corner_.y()) / kCell_m) + 1;
    const std::size_t cells = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    nearest_.assign(cells, kNoWall);
    nearness_.assign(cells, 0);
    through_.assign(cells, 0);
    add_walls(scan);
    paint_walls();
    look_through(scan);
}

std::ptrdiff_t WallField::place(const Vector2d& p, int border) const {
    const double column = (p.x() - corner_.x()) / kCell_m;
    const double row = (p.y() - corner_.y()) / kCell_m;
    if (!(column >= border && row >= border && column < width_ - border && row < height_ - border)) {
        return -1;
    }
    return static_cast<std::ptrdiff_t>(row) * width_ + static_cast<std::ptrdiff_t>(column);
}

const WallField::Wall* WallField::wall_near(const Vector2d& p) const {
    const std::ptrdiff_t at = place(p);
    if (at < 0 || nearest_[static_cast<std::size_t>(at)] == kNoWall) {
        return nullptr;
    }
    return &walls_[nearest_[static_cast<std::size_t>(at)]];
}

bool WallField::looked_through(const Vector2d& p) const {
    const std::ptrdiff_t at = place(p);
    return at >= 0 && through_[static_cast<std::size_t>(at)] != 0;
}

void WallField::add_walls(const ScanHits& scan) {
    // The wall between two hits faces across the line of the hits about it: four where there are, for less noise.
    const auto count = static_cast<std::ptrdiff_t>(scan.points.size());
    const auto hit = [&scan](std::ptrdiff_t i) -> Vector2d {
        return scan.points[static_cast<std::size_t>(i)].cast<double>();
    };
    const auto linked = [&](std::ptrdiff_t i) {  // hit i to hit i + 1
        return i >= 0 && i + 1 < count && connected(hit(i), hit(i + 1), scan);
    };
    for (std::ptrdiff_t i = 0; i + 1 < count; ++i) {
        const Vector2d a = hit(i);
        const Vector2d b = hit(i + 1);
        if (!linked(i) || (a - scan.lidar).norm() >= kFarthestHit_m || (b - scan.lidar).norm() >= kFarthestHit_m) {
            continue;
        }
        Vector2d along = b - a;
        constexpr double kStraight = 0.9;  // cosine of 25 degrees
        if (linked(i - 1) && linked(i + 1)) {
            const Vector2d wider = hit(i + 2) - hit(i - 1);
            const Vector2d before = a - hit(i - 1);
            const Vector2d after = hit(i + 2) - b;
            if (before.dot(after) > kStraight * before.norm() * after.norm()) {
                along = wider;
            }
        }
        const double length_m = along.norm();
        if (!(length_m > 1e-6)) {
            continue;
        }
        const Vector2d normal = Vector2d(-along.y(), along.x()) / length_m;
        const double gap_m = (b - a).norm();
        const int pieces = static_cast<int>(std::ceil(gap_m / kCell_m));
        for (int k = 0; k < pieces && walls_.size() < kNoWall; ++k) {
            walls_.push_back({.point = a + (k + 0.5) / pieces * (b - a), .normal = normal});
        }
    }
}

void WallField::paint_walls() {
    constexpr int kReach = static_cast<int>(kReach_m / kCell_m);
    for (std::size_t i = 0; i < walls_.size(); ++i) {
        const Vector2d& p = walls_[i].point;
        const std::ptrdiff_t at = place(p, kReach);
        if (at < 0) {
            continue;
        }
        const Vector2d in_raster = (p - corner_) / kCell_m;
        for (int dy = -kReach; dy <= kReach; ++dy) {
            for (int dx = -kReach; dx <= kReach; ++dx) {
                const double from_x = std::floor(in_raster.x()) + dx + 0.5 - in_raster.x();
                const double from_y = std::floor(in_raster.y()) + dy + 0.5 - in_raster.y();
                const double near = 1.0 - std::sqrt(from_x * from_x + from_y * from_y) * (kCell_m / kReach_m);
                const auto cell = static_cast<std::size_t>(at + static_cast<std::ptrdiff_t>(dy) * width_ + dx);
                const double value = std::floor(255.0 * near);
                if (value > static_cast<double>(nearness_[cell])) {
                    nearness_[cell] = static_cast<std::uint8_t>(value);
                    nearest_[cell] = static_cast<std::uint16_t>(i);
                }
            }
        }
    }
}

void WallField::look_through(const ScanHits& scan) {
    for (const Eigen::Vector2f& hit : scan.points) {
        const Vector2d beam = hit.cast<double>() - scan.lidar;
        const double range_m = beam.norm();
        if (range_m >= kFarthestHit_m) {
            continue;
        }
        const Vector2d step = beam * (kCell_m / range_m);
        Vector2d p = scan.lidar;
        const int steps = static_cast<int>(std::ceil((range_m - kReach_m) / kCell_m));
        for (int i = 0; i < steps; ++i) {
            const std::ptrdiff_t at = place(p);
            if (at >= 0) {
                through_[static_cast<std::size_t>(at)] = 1;
            }
            p += step;
        }
    }
}

}  // namespace crspf::eval
