#include "tools/sim/cars.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "platform/files/input_error.hpp"

namespace crspf::sim {
namespace {

constexpr double kStep_m = 0.25;       // between the points of a lane
constexpr double kAcross = 2.0;        // [m/s^2] what passengers put up with in a bend
constexpr double kAcceleration = 1.5;  // [m/s^2]
constexpr double kBraking = 3.0;       // [m/s^2] wanted; it can do more
constexpr double kBrakingMax = 8.0;    // [m/s^2]
constexpr double kSlowest_mps = 2.0;   // of those who cruise
constexpr double kFastest_mps = 7.0;
constexpr double kFromRobot_m = 15.0;   // at the beginning
constexpr double kApart_m = 10.0;       // from middle to middle, at the beginning
constexpr double kStopped_m = 6.0;      // from middle to middle behind a car that stands
constexpr double kGap_m = 0.3;          // beside the body
constexpr double kStopsBefore_m = 1.0;  // what is in the way
constexpr int kAttempts = 200;
constexpr std::size_t kDiscs = 4;  // that together cover a car

// The cabin, on the body.
constexpr double kBonnet_m = 0.9;
constexpr double kCabinLength_m = 2.4;
constexpr double kCabinWidth_m = 1.5;
constexpr double kCabinBack_m = 0.4;

Point between(Point a, Point b, double u) {
    return {a.x_m + u * (b.x_m - a.x_m), a.y_m + u * (b.y_m - a.y_m)};
}

SinCos heading_of(Point from, Point to) {
    const double way_m = distance(from, to);
    return {.sin = (to.y_m - from.y_m) / way_m, .cos = (to.x_m - from.x_m) / way_m};
}

/// A line that leads round, in equal steps.
std::vector<Point> in_steps(const std::vector<Point>& round, double step_m) {
    std::vector<double> way_m{0.0};
    for (std::size_t i = 0; i < round.size(); ++i) {
        way_m.push_back(way_m.back() + distance(round[i], round[(i + 1) % round.size()]));
    }
    const auto count = static_cast<std::size_t>(way_m.back() / step_m);
    std::vector<Point> points;
    std::size_t piece = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const double at_m = way_m.back() * static_cast<double>(k) / static_cast<double>(count);
        while (way_m[piece + 1] <= at_m) {
            ++piece;
        }
        points.push_back(between(round[piece], round[(piece + 1) % round.size()],
                                 (at_m - way_m[piece]) / (way_m[piece + 1] - way_m[piece])));
    }
    return points;
}

/// Between the points `reach` before and behind, so that a bend of many corners turns evenly.
std::vector<SinCos> headings_of(const std::vector<Point>& round, std::size_t reach) {
    std::vector<SinCos> headings;
    const std::size_t n = round.size();
    for (std::size_t i = 0; i < n; ++i) {
        headings.push_back(heading_of(round[(i + n - reach) % n], round[(i + reach) % n]));
    }
    return headings;
}

}  // namespace

Cars::Cars(std::span<const Point> road, std::size_t count, Point robot, std::uint64_t seed)
    : lanes_{lane_of(road, kLane_m, false), lane_of(road, -kLane_m, true)},
      random_(seed, RandomStream::kCars),
      boxes_(2 * count),
      discs_(kDiscs * count) {
    for (std::size_t i = 0; i < count; ++i) {
        Car car{.lane = i % 2, .cruising_mps = random_.uniform(kSlowest_mps, kFastest_mps)};
        const Lane& lane = lanes_[car.lane];
        bool placed = false;
        for (int attempt = 0; attempt < kAttempts && !placed; ++attempt) {
            car.at_m = random_.uniform(0.0, length_m(lane));
            placed = distance(body_at(lane, car.at_m).centre, robot) > kFromRobot_m &&
                     std::all_of(cars_.begin(), cars_.end(), [&](const Car& other) {
                         const double apart_m = std::abs(car.at_m - other.at_m);
                         return other.lane != car.lane || std::min(apart_m, length_m(lane) - apart_m) > kApart_m;
                     });
        }
        if (!placed) {
            throw InputError("--cars " + std::to_string(count) + ": the road has room for " + std::to_string(i) +
                             "; give no more");
        }
        cars_.push_back(car);
        place(i);
    }
}

void Cars::advance(double seconds, std::span<const Circle> others) {
    for (std::size_t i = 0; i < cars_.size(); ++i) {
        drive(cars_[i], seconds, others);
        place(i);
    }
}

Cars::Lane Cars::lane_of(std::span<const Point> road, double right_m, bool backward) {
    std::vector<Point> middle(road.begin(), road.end());
    while (middle.size() > 1 && distance(middle.front(), middle.back()) < kStep_m) {
        middle.pop_back();
    }
    middle = in_steps(middle, kStep_m);
    constexpr std::size_t kReach = 6;
    const std::vector<SinCos> along = headings_of(middle, kReach);
    std::vector<Point> places;
    for (std::size_t i = 0; i < middle.size(); ++i) {
        places.push_back({middle[i].x_m + right_m * along[i].sin, middle[i].y_m - right_m * along[i].cos});
    }
    if (backward) {
        std::reverse(places.begin(), places.end());
    }
    places = in_steps(places, kStep_m);
    const std::vector<SinCos> headings = headings_of(places, kReach);
    const std::size_t n = places.size();
    Lane lane(n);
    for (std::size_t i = 0; i < n; ++i) {
        const SinCos& before = headings[(i + n - kReach) % n];
        const SinCos& after = headings[(i + kReach) % n];
        const double turn = std::abs(before.cos * after.sin - before.sin * after.cos);
        const double curvature = turn / (2.0 * kReach * kStep_m);
        lane[i] = {.place = places[i],
                   .heading = headings[i],
                   .limit_mps = std::min(std::sqrt(kAcross / std::max(curvature, 1e-6)), kFastest_mps)};
    }
    // Twice round, so that the first points know of bends behind the last.
    for (std::size_t k = 2 * n; k-- > 0;) {
        const double next_mps = lane[(k + 1) % n].limit_mps;
        double& limit_mps = lane[k % n].limit_mps;
        limit_mps = std::min(limit_mps, std::sqrt(next_mps * next_mps + 2.0 * kBraking * kStep_m));
    }
    return lane;
}

double Cars::length_m(const Lane& lane) {
    return kStep_m * static_cast<double>(lane.size());
}

Box Cars::body_at(const Lane& lane, double at_m) {
    const double steps = at_m / kStep_m;
    const double whole = std::floor(steps);
    const LanePoint& from = lane[static_cast<std::size_t>(whole) % lane.size()];
    const LanePoint& to = lane[(static_cast<std::size_t>(whole) + 1) % lane.size()];
    const double u = steps - whole;
    const Point ahead{from.heading.cos + u * (to.heading.cos - from.heading.cos),
                      from.heading.sin + u * (to.heading.sin - from.heading.sin)};
    return {.centre = between(from.place, to.place, u),
            .heading = heading_of({}, ahead),
            .half_length_m = kLength_m / 2.0,
            .half_width_m = kWidth_m / 2.0,
            .height_m = kBonnet_m};
}

/// To the middle of the car ahead; infinity if it has the lane for itself.
double Cars::gap_m(const Car& car) const {
    double nearest_m = kInfinity;
    for (const Car& other : cars_) {
        if (&other != &car && other.lane == car.lane) {
            const double ahead_m = other.at_m - car.at_m;
            nearest_m = std::min(nearest_m, ahead_m > 0.0 ? ahead_m : ahead_m + length_m(lanes_[car.lane]));
        }
    }
    return nearest_m;
}

/// Whether one of the others is where the car comes within so many metres.
bool Cars::in_the_way(const Car& car, double ahead_m, std::span<const Circle> others) const {
    const Lane& lane = lanes_[car.lane];
    const Point here = body_at(lane, car.at_m).centre;
    return std::any_of(others.begin(), others.end(), [&](const Circle& other) {
        const double near_m = other.radius_m + kGap_m;
        if (distance(here, other.centre) > ahead_m + kLength_m + near_m) {
            return false;
        }
        const int steps = static_cast<int>(std::ceil(ahead_m / kStep_m));
        for (int step = 1; step <= steps; ++step) {
            if (body_at(lane, car.at_m + step * kStep_m).away_m(other.centre) < near_m) {
                return true;
            }
        }
        return false;
    });
}

void Cars::drive(Car& car, double seconds, std::span<const Circle> others) {
    const Lane& lane = lanes_[car.lane];
    const double limit_mps = lane[static_cast<std::size_t>(car.at_m / kStep_m) % lane.size()].limit_mps;
    const double stopping_m = car.speed_mps * car.speed_mps / (2.0 * kBraking);
    // The car ahead may stop as fast as it likes: it has come to stand no nearer than it is.
    const double room_m = std::max(gap_m(car) - kStopped_m, 0.0);
    const bool blocked = in_the_way(car, stopping_m + kStopsBefore_m, others);
    const double wanted_mps =
        blocked ? 0.0 : std::min({car.cruising_mps, limit_mps, std::sqrt(2.0 * kBraking * room_m)});
    car.speed_mps = wanted_mps > car.speed_mps ? std::min(car.speed_mps + kAcceleration * seconds, wanted_mps)
                                               : std::max(car.speed_mps - kBrakingMax * seconds, wanted_mps);
    car.at_m += car.speed_mps * seconds;
    car.at_m -= car.at_m >= length_m(lane) ? length_m(lane) : 0.0;
}

void Cars::place(std::size_t car) {
    const Box body = body_at(lanes_[cars_[car].lane], cars_[car].at_m);
    const auto ahead = [&](double way_m) {
        return Point{body.centre.x_m + way_m * body.heading.cos, body.centre.y_m + way_m * body.heading.sin};
    };
    boxes_[2 * car] = body;
    boxes_[2 * car + 1] = {.centre = ahead(-kCabinBack_m),
                           .heading = body.heading,
                           .half_length_m = kCabinLength_m / 2.0,
                           .half_width_m = kCabinWidth_m / 2.0,
                           .height_m = kHeight_m};
    for (std::size_t i = 0; i < kDiscs; ++i) {
        const double share = static_cast<double>(i) / (kDiscs - 1) - 0.5;
        discs_[kDiscs * car + i] = {.centre = ahead(share * (kLength_m - kWidth_m)), .radius_m = kWidth_m / 2.0};
    }
}

}  // namespace crspf::sim
