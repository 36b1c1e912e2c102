#include "tools/sim/people.hpp"

#include <algorithm>
#include <cmath>

namespace crspf::sim {
namespace {

constexpr double kLegRadius_m = 0.06;
constexpr double kHalfStride_m = 0.18;
constexpr double kStride_m = 1.4;  // both legs once
constexpr double kRobotDistance_m = 0.15;
constexpr double kPatience_s = 3.0;

}  // namespace

People::People(const NavGrid& floor, std::size_t count, Point robot, std::uint64_t seed)
    : floor_(&floor), random_(seed, RandomStream::kPeople), people_(count), bodies_(count), legs_(2 * count) {
    for (std::size_t i = 0; i < count; ++i) {
        for (int attempt = 0; attempt < 20; ++attempt) {
            bodies_[i].centre = floor.random_place(random_);
            if (distance(bodies_[i].centre, robot) > 2.0) {
                break;
            }
        }
        bodies_[i].radius_m = random_.uniform(0.15, 0.25);
        people_[i].speed_mps = random_.uniform(0.6, 1.4);
        place_legs(i);
    }
}

void People::advance(double seconds, const Circle& robot) {
    for (std::size_t i = 0; i < people_.size(); ++i) {
        walk(i, seconds, robot);
        place_legs(i);
    }
}

void People::walk(std::size_t person, double seconds, const Circle& robot) {
    Person& p = people_[person];
    Circle& body = bodies_[person];
    p.stuck_s += seconds;
    if (p.stuck_s > kPatience_s) {
        // Back the way that was come: nothing else is sure to lead away from a robot in a door.
        p.stuck_s = 0.0;
        p.path.resize(std::min(p.next, p.path.size()));
        std::reverse(p.path.begin(), p.path.end());
        p.next = 0;
    }
    if (p.next >= p.path.size()) {
        p.path = floor_->plan(body.centre, floor_->random_place(random_));
        p.next = 1;  // 0 is here
    }
    const double step_m = p.speed_mps * seconds;
    const double keep_off_m = robot.radius_m + body.radius_m + kHalfStride_m + kRobotDistance_m;
    while (p.next < p.path.size() &&
           (distance(body.centre, p.path[p.next]) <= step_m || distance(robot.centre, p.path[p.next]) < keep_off_m)) {
        ++p.next;
        p.stuck_s = 0.0;
    }
    if (p.next >= p.path.size()) {
        return;
    }
    const Point target = p.path[p.next];
    const double left_m = distance(body.centre, target);
    const SinCos straight{.sin = (target.y_m - body.centre.y_m) / left_m,
                          .cos = (target.x_m - body.centre.x_m) / left_m};
    for (const double turn_deg : {0.0, -45.0, 45.0, -90.0, 90.0}) {  // round the robot if it is in the way
        const SinCos turn = sin_cos(radians(turn_deg));
        const SinCos heading{.sin = straight.sin * turn.cos + straight.cos * turn.sin,
                             .cos = straight.cos * turn.cos - straight.sin * turn.sin};
        const Point ahead{body.centre.x_m + step_m * heading.cos, body.centre.y_m + step_m * heading.sin};
        const double away_m = distance(ahead, robot.centre);
        const bool into_robot = away_m < keep_off_m && away_m < distance(body.centre, robot.centre);
        if (!into_robot && (turn_deg == 0.0 || floor_->reachable(ahead))) {
            p.heading = heading;
            body.centre = ahead;
            p.walked_m += step_m;
            return;
        }
    }
}

void People::place_legs(std::size_t person) {
    const Person& p = people_[person];
    const Circle& body = bodies_[person];
    const double swing_m = kHalfStride_m * sin_cos(2.0 * kPi * p.walked_m / kStride_m).sin;
    const double apart_m = body.radius_m - kLegRadius_m;
    for (const std::size_t side : {0U, 1U}) {
        const double sign = side == 0 ? 1.0 : -1.0;
        const double forward_m = sign * swing_m;
        const double left_m = sign * apart_m;
        legs_[2 * person + side] = {.centre = {body.centre.x_m + p.heading.cos * forward_m - p.heading.sin * left_m,
                                               body.centre.y_m + p.heading.sin * forward_m + p.heading.cos * left_m},
                                    .radius_m = kLegRadius_m};
    }
}

}  // namespace crspf::sim
