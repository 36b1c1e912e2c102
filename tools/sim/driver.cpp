#include "tools/sim/driver.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/trig.hpp"

namespace crspf::sim {
namespace {

constexpr double kStuck_s = 30.0;     // no progress for so long: give the place up
constexpr std::size_t kGiveUps = 5;   // places in a row: give up altogether
constexpr double kPathStep_m = 0.1;   // between the points of a path, about
constexpr double kLookahead_s = 0.8;  // pure pursuit aims where the robot would be after this
constexpr double kLookaheadMin_m = 0.4;
constexpr double kLineMargin_m = 0.03;  // a straight way must be this much wider than what brings the robot to a stop
constexpr double kStopMargin_m = 0.05;
constexpr double kPersonGap_m = 0.3;  // beside the body, for the legs' swing
constexpr double kCarGap_m = 0.3;
constexpr double kTurnAbove_rad = radians(60.0);   // differential: beyond this the robot turns on the spot ...
constexpr double kTurnedBelow_rad = radians(3.0);  // ... until it faces its way
constexpr double kReverseAbove_rad = radians(75.0);
constexpr double kReversedBelow_rad = radians(25.0);
constexpr double kForwardLeg_m = 0.3;  // Ackermann: between changes of direction
constexpr double kReverseLegMin_m = 0.2;
constexpr double kReverseLegMax_m = 1.0;

Point position(const Pose2& pose) {
    return {pose.x_m, pose.y_m};
}

}  // namespace

Driver::Driver(const World& world, const NavGrid& floor, const RobotParams& params, std::vector<Point> places,
               bool repeat)
    : world_(&world), floor_(&floor), params_(params), places_(std::move(places)), repeat_(repeat) {}

Driver::Driver(const World& world, const NavGrid& floor, const RobotParams& params, std::vector<Point> path)
    : world_(&world), floor_(&floor), params_(params), path_(std::move(path)) {}

double Driver::progress() const {
    const double along = path_.empty() ? 1.0 : static_cast<double>(passed_ + 1) / static_cast<double>(path_.size());
    if (finished_ || places_.empty()) {
        return along;
    }
    return (std::max(static_cast<double>(place_), 1.0) - 1.0 + along) / static_cast<double>(places_.size());
}

Command Driver::command(const Robot& robot, const std::vector<Circle>& people, std::span<const Circle> cars,
                        double seconds) {
    const Point here = position(robot.pose());
    update_progress(here, seconds);
    const bool arrived =
        path_.empty() || (passed_ + 1 == path_.size() && distance(here, path_.back()) < params_.arrived_m);
    if (arrived || stuck_s_ > kStuck_s) {
        given_up_ += arrived ? 0U : 1U;
        given_up_in_a_row_ = arrived ? 0 : given_up_in_a_row_ + 1;
        next_place(here);
    }
    if (finished_ || person_ahead(robot, people) || car_ahead(robot, cars)) {
        return {};
    }
    const Point target = lookahead(here);
    const Pose2 P_base_target = inverse(robot.pose()) * Pose2{.x_m = target.x_m, .y_m = target.y_m, .theta_rad = 0.0};
    const double bearing_rad = arc_tan2(P_base_target.y_m, P_base_target.x_m);
    const double distance_m = std::max(distance(here, target), kPathStep_m);
    const double curvature = 2.0 * sin_cos(bearing_rad).sin / distance_m;
    return params_.drive == Drive::kDifferential ? drive_differential(robot, bearing_rad, curvature)
                                                 : drive_ackermann(robot, bearing_rad, curvature, seconds);
}

// A disc may turn wherever it stands, so it never needs to reverse.
Command Driver::drive_differential(const Robot& robot, double bearing_rad, double curvature) {
    if (std::abs(bearing_rad) > kTurnAbove_rad || !clear_arc(robot.pose(), stopping_m(robot.speed_mps()), curvature)) {
        change_to(Manoeuvre::kTurn);
    } else if (std::abs(bearing_rad) < kTurnedBelow_rad) {
        change_to(Manoeuvre::kForward);
    }
    if (manoeuvre_ == Manoeuvre::kTurn) {
        const double rate = std::sqrt(params_.turn_acceleration_radps2 * std::abs(bearing_rad));
        return {.speed_mps = 0.0,
                .turn_rate_radps = std::copysign(std::min(rate, params_.turn_rate_radps), bearing_rad)};
    }
    const double speed_mps = std::min(params_.speed_mps, params_.turn_rate_radps / std::max(std::abs(curvature), 1e-6));
    return {.speed_mps = speed_mps, .turn_rate_radps = speed_mps * curvature};
}

// Three-point turns: back with the wheels turned the other way, until the target lies ahead.
Command Driver::drive_ackermann(const Robot& robot, double bearing_rad, double curvature, double seconds) {
    manoeuvre_m_ += std::abs(robot.speed_mps()) * seconds;
    const double bearing = std::abs(bearing_rad);
    const double stopping = stopping_m(robot.speed_mps());
    if (manoeuvre_ != Manoeuvre::kReverse) {
        if (!clear_arc(robot.pose(), stopping, robot.curvature()) ||
            (bearing > kReverseAbove_rad && manoeuvre_m_ > kForwardLeg_m)) {
            change_to(Manoeuvre::kReverse);
        }
    } else if (!clear_arc(robot.pose(), -stopping, robot.curvature()) || manoeuvre_m_ > kReverseLegMax_m ||
               (bearing < kReversedBelow_rad && manoeuvre_m_ > kReverseLegMin_m)) {
        change_to(Manoeuvre::kForward);
    }
    if (manoeuvre_ == Manoeuvre::kReverse) {
        return {.speed_mps = -0.5 * params_.speed_mps,
                .turn_rate_radps = std::copysign(params_.turn_rate_radps, bearing_rad)};
    }
    return {.speed_mps = params_.speed_mps, .turn_rate_radps = params_.speed_mps * curvature};
}

void Driver::change_to(Manoeuvre manoeuvre) {
    if (manoeuvre != manoeuvre_) {
        manoeuvre_ = manoeuvre;
        manoeuvre_m_ = 0.0;
    }
}

double Driver::stopping_m(double speed_mps) const {
    return speed_mps * speed_mps / (2.0 * params_.acceleration_mps2) + kStopMargin_m;
}

void Driver::update_progress(Point robot, double seconds) {
    constexpr std::size_t kWindow = 10;
    stuck_s_ += seconds;
    const std::size_t last = std::min(passed_ + kWindow + 1, path_.size());
    for (std::size_t i = passed_ + 1; i < last; ++i) {
        if (distance(robot, path_[i]) < distance(robot, path_[passed_])) {
            passed_ = i;
            stuck_s_ = 0.0;
        }
    }
}

void Driver::next_place(Point robot) {
    finished_ = given_up_in_a_row_ >= kGiveUps;
    for (std::size_t attempt = 0; !finished_ && attempt < places_.size(); ++attempt) {
        if (place_ == places_.size()) {
            if (!repeat_) {
                break;
            }
            place_ = 0;
        }
        path_ = floor_->plan(robot, places_[place_++]);
        passed_ = 0;
        stuck_s_ = 0.0;
        if (path_.size() > 1) {
            return;
        }
    }
    finished_ = true;
}

Point Driver::lookahead(Point robot) const {
    const double ahead_m = std::max(kLookaheadMin_m, kLookahead_s * params_.speed_mps);
    std::size_t target = std::min(passed_ + static_cast<std::size_t>(ahead_m / kPathStep_m), path_.size() - 1);
    while (target > passed_ + 1 && !clear_line(robot, path_[target])) {
        --target;
    }
    return path_[target];
}

bool Driver::clear_line(Point from, Point to) const {
    const double wanted_m = params_.radius_m + kLineMargin_m;
    const double needed_m = world_->clearance(from, wanted_m);
    const int steps = 1 + static_cast<int>(distance(from, to) / kPathStep_m);
    for (int i = 1; i <= steps; ++i) {
        const double u = static_cast<double>(i) / steps;
        const Point p{from.x_m + u * (to.x_m - from.x_m), from.y_m + u * (to.y_m - from.y_m)};
        if (world_->clearance(p, wanted_m) < needed_m) {
            return false;
        }
    }
    return true;
}

bool Driver::clear_arc(const Pose2& P_world_base, double length_m, double curvature) const {
    const double needed_m = world_->clearance(position(P_world_base), params_.radius_m);
    const int steps = 1 + static_cast<int>(std::abs(length_m) / kPathStep_m);
    for (int i = 1; i <= steps; ++i) {
        const double along_m = length_m * i / steps;
        if (world_->clearance(position(P_world_base * arc(along_m, along_m * curvature)), params_.radius_m) <
            needed_m) {
            return false;
        }
    }
    return true;
}

bool Driver::person_ahead(const Robot& robot, const std::vector<Circle>& people) const {
    const double stopping = stopping_m(robot.speed_mps());
    const Point here = position(robot.pose());
    const Point ahead = position(robot.pose() * arc(manoeuvre_ == Manoeuvre::kReverse ? -stopping : stopping, 0.0));
    return std::any_of(people.begin(), people.end(), [&](const Circle& person) {
        const double gap_m = distance(ahead, person.centre) - person.radius_m - params_.radius_m;
        return gap_m < kPersonGap_m && distance(ahead, person.centre) < distance(here, person.centre);
    });
}

// A person may come from anywhere; a car keeps its lane, and matters where that leads over the path.
bool Driver::car_ahead(const Robot& robot, std::span<const Circle> cars) const {
    const auto steps = static_cast<std::size_t>(stopping_m(robot.speed_mps()) / kPathStep_m) + 1;
    const std::size_t last = std::min(passed_ + steps + 1, path_.size());
    return std::any_of(cars.begin(), cars.end(), [&](const Circle& car) {
        const double near_m = params_.radius_m + car.radius_m + kCarGap_m;
        for (std::size_t i = passed_; i < last; ++i) {
            if (distance(path_[i], car.centre) < near_m &&
                distance(path_[i], car.centre) < distance(position(robot.pose()), car.centre)) {
                return true;
            }
        }
        return false;
    });
}

}  // namespace crspf::sim
