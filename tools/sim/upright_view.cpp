#include "tools/sim/upright_view.hpp"

#include <algorithm>
#include <cmath>

#include "tools/sim/world3d.hpp"

namespace crspf::sim {
namespace {

constexpr double kNearest_m = 1e-3;  // a body that holds the eye is not seen

Point across(const Segment& wall, SinCos direction) {
    const double length_m = distance(wall.a, wall.b);
    const Point normal{(wall.a.y_m - wall.b.y_m) / length_m, (wall.b.x_m - wall.a.x_m) / length_m};
    const bool away = normal.x_m * direction.cos + normal.y_m * direction.sin > 0.0;
    return away ? Point{-normal.x_m, -normal.y_m} : normal;
}

/// The normal of the side by which a ray enters.
Point side_entered(const Box& box, Point p) {
    const Point at = box.seen(p);
    const bool end = std::abs(at.x_m) - box.half_length_m > std::abs(at.y_m) - box.half_width_m;
    const double sign = (end ? at.x_m : at.y_m) < 0.0 ? -1.0 : 1.0;
    return end ? Point{sign * box.heading.cos, sign * box.heading.sin}
               : Point{-sign * box.heading.sin, sign * box.heading.cos};
}

}  // namespace

std::span<const Sight> UprightView::look(Point eye, double eye_m, SinCos direction, const Movers& movers) {
    eye_ = eye;
    eye_m_ = eye_m;
    direction_ = direction;
    candidates_.clear();
    borders_.clear();
    seen_.clear();
    add({}, -kSteepest, kSteepest);  // the sky, behind everything
    const Hit wall = scene_->world.hit(eye, direction, kInfinity);
    const Part floor{.from_m = kNearest_m, .to_m = wall.range_m};
    add_level(Matter::kFloor, 0, -eye_m, floor);
    if (!scene_->outdoors) {
        add_level(Matter::kCeiling, 0, wall_height_m_ - eye_m, floor);
    }
    if (wall.range_m < kInfinity) {
        add_upright(Matter::kWall, wall.wall, wall.range_m, 0.0, wall_height_m_,
                    across(scene_->world.walls()[wall.wall], direction));
    }
    for (std::uint32_t i = 0; i < movers.legs.size(); ++i) {
        add_leg(i, movers.legs[i]);
    }
    for (std::uint32_t i = 0; i < movers.cars.size(); ++i) {
        add_car(i, movers.cars[i]);
    }
    for (std::uint32_t i = 0; i < scene_->crowns.size(); ++i) {
        add_crown(i, scene_->crowns[i]);
    }
    add_crossings();
    std::sort(borders_.begin(), borders_.end());
    for (std::size_t i = 1; i < borders_.size(); ++i) {
        const double low = borders_[i - 1];
        const double high = borders_[i];
        if (!(low < high)) {
            continue;
        }
        const Face& face = nearest((low + high) / 2.0);
        if (!seen_.empty() && seen_.back().face.same_surface(face)) {
            seen_.back().high = high;
        } else {
            seen_.push_back({face, low, high});
        }
    }
    return seen_;
}

void UprightView::add(const Face& face, double low, double high) {
    low = std::max(low, -kSteepest);
    high = std::min(high, kSteepest);
    if (low < high) {
        candidates_.push_back({face, low, high});
        borders_.insert(borders_.end(), {low, high});
    }
}

void UprightView::add_upright(Matter matter, std::uint32_t index, double way_m, double bottom_m, double top_m,
                              Point normal) {
    if (way_m > kNearest_m) {
        add({.matter = matter, .index = index, .upright = true, .at_m = way_m, .normal = normal},
            (bottom_m - eye_m_) / way_m, (top_m - eye_m_) / way_m);
    }
}

void UprightView::add_level(Matter matter, std::uint32_t index, double above_m, const Part& part) {
    const double a = above_m / std::max(part.from_m, kNearest_m);
    const double b = above_m / part.to_m;
    add({.matter = matter, .index = index, .upright = false, .at_m = above_m}, std::min(a, b), std::max(a, b));
}

void UprightView::add_leg(std::uint32_t index, const Circle& leg) {
    const double way_m = cast_on_circle(eye_, direction_, leg);
    if (way_m < kInfinity) {
        const Point hit{eye_.x_m + way_m * direction_.cos, eye_.y_m + way_m * direction_.sin};
        add_upright(Matter::kPerson, index, way_m, 0.0, World3d::kPersonHeight_m,
                    {(hit.x_m - leg.centre.x_m) / leg.radius_m, (hit.y_m - leg.centre.y_m) / leg.radius_m});
    }
}

void UprightView::add_car(std::uint32_t index, const Box& car) {
    const Part part = part_over(eye_, direction_, car);
    if (part.empty() || part.from_m <= kNearest_m) {
        return;
    }
    const Point hit{eye_.x_m + part.from_m * direction_.cos, eye_.y_m + part.from_m * direction_.sin};
    add_upright(Matter::kCar, index, part.from_m, 0.0, car.height_m, side_entered(car, hit));
    add_level(Matter::kCar, index, car.height_m - eye_m_, part);
}

void UprightView::add_crown(std::uint32_t index, const Crown& crown) {
    const Part part = part_over(eye_, direction_, crown.circle);
    if (part.empty()) {
        return;
    }
    const Point hit{eye_.x_m + part.from_m * direction_.cos, eye_.y_m + part.from_m * direction_.sin};
    const Circle& c = crown.circle;
    add_upright(Matter::kCrown, index, part.from_m, crown.low_m, crown.high_m,
                {(hit.x_m - c.centre.x_m) / c.radius_m, (hit.y_m - c.centre.y_m) / c.radius_m});
    add_level(Matter::kCrown, index, crown.low_m - eye_m_, part);
    add_level(Matter::kCrown, index, crown.high_m - eye_m_, part);
}

/// Where an upright face stands through a level one, as a cabin does through the body it sits on.
void UprightView::add_crossings() {
    for (const Sight& level : candidates_) {
        for (const Sight& upright : candidates_) {
            if (!level.face.upright && upright.face.upright && upright.face.at_m < kInfinity) {
                const double rise = level.face.at_m / upright.face.at_m;
                if (rise > std::max(level.low, upright.low) && rise < std::min(level.high, upright.high)) {
                    borders_.push_back(rise);
                }
            }
        }
    }
}

const Face& UprightView::nearest(double rise) const {
    const Sight* found = candidates_.data();
    for (const Sight& sight : candidates_) {
        if (rise > sight.low && rise < sight.high && sight.face.way_m(rise) < found->face.way_m(rise)) {
            found = &sight;
        }
    }
    return found->face;
}

}  // namespace crspf::sim
