#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <numeric>
#include <vector>

#include "core/base/trig.hpp"
#include "core/slam/obstacle_scan.hpp"

using namespace crspf;

namespace {

constexpr double kHeight_m = 1.8;
constexpr std::uint32_t kColumns = 1440;
constexpr double kTurn_s = 0.1;

/// Whether there is something at a point of base_link's frame, z above the ground below it. [m]
using Solid = std::function<bool(double x_m, double y_m, double z_m)>;

struct Lasers {
    std::vector<double> elevation_rad;
    std::vector<double> rotation_rad;  ///< to the left of where the sensor looks
};

Lasers sixteen() {  // in the order of a VLP-16
    Lasers lasers;
    for (int i = 0; i < 8; ++i) {
        lasers.elevation_rad.insert(lasers.elevation_rad.end(), {radians(-15.0 + 2 * i), radians(1.0 + 2 * i)});
    }
    lasers.rotation_rad.assign(16, 0.0);
    return lasers;
}

Lasers sixty_four() {  // as an HDL-64E, whose lasers look to the sides by turns
    Lasers lasers;
    for (int i = 0; i < 64; ++i) {
        lasers.elevation_rad.push_back(radians(2.0 - 0.42 * i));
        lasers.rotation_rad.push_back(radians(i % 2 == 0 ? 4.0 : -4.0));
    }
    return lasers;
}

std::vector<std::uint8_t> upward(const Lasers& lasers) {
    std::vector<std::uint8_t> order(lasers.elevation_rad.size());
    std::iota(order.begin(), order.end(), std::uint8_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::uint8_t a, std::uint8_t b) { return lasers.elevation_rad[a] < lasers.elevation_rad[b]; });
    return order;
}

/// A revolution cut behind, of a lidar above base_link's origin. @param pitch_rad of its mounting, looking down
std::unique_ptr<Cloud> revolution(const Lasers& lasers, const Solid& solid, double pitch_rad = 0.0) {
    auto cloud = std::make_unique<Cloud>();
    cloud->lasers = static_cast<std::uint32_t>(lasers.elevation_rad.size());
    cloud->columns = kColumns;
    cloud->complete = true;
    const std::vector<std::uint8_t> order = upward(lasers);
    std::copy(order.begin(), order.end(), cloud->upward.begin());
    for (std::uint32_t c = 0; c < kColumns; ++c) {
        const double turned_rad = 2.0 * kPi * (c + 0.5) / kColumns;  // in no sector's edge
        cloud->azimuth_rad[c] = std::fmod(kPi + turned_rad, 2.0 * kPi);
        cloud->stamp[c] = Stamp{} + Duration::from_seconds(kTurn_s * (c + 0.5) / kColumns);
        cloud->measured[c] = true;
        for (std::uint32_t l = 0; l < cloud->lasers; ++l) {
            const double azimuth_rad = -cloud->azimuth_rad[c] + lasers.rotation_rad[l];
            const double elevation_rad = lasers.elevation_rad[l];
            const double x = std::cos(elevation_rad) * std::cos(azimuth_rad);
            const double y = std::cos(elevation_rad) * std::sin(azimuth_rad);
            const double z = std::sin(elevation_rad);
            const double base_x = std::cos(pitch_rad) * x + std::sin(pitch_rad) * z;
            const double base_z = -std::sin(pitch_rad) * x + std::cos(pitch_rad) * z;
            const std::size_t at = cloud->at(c, l);
            cloud->beam[at] = Beam::kNoReturn;
            constexpr double kStep_m = 0.02;
            for (int step = 25; step < 1500; ++step) {
                const double r = step * kStep_m;
                if (solid(r * base_x, r * y, kHeight_m + r * base_z)) {
                    cloud->beam[at] = Beam::kHit;
                    const double middle_m = r - 0.5 * kStep_m;
                    cloud->x_m[at] = static_cast<float>(middle_m * x);
                    cloud->y_m[at] = static_cast<float>(middle_m * y);
                    cloud->z_m[at] = static_cast<float>(middle_m * z);
                    break;
                }
            }
        }
    }
    return cloud;
}

std::unique_ptr<Scan> scan_of(const Cloud& cloud, const ObstacleParams& params = {}, const Pose2& P_base_lidar = {},
                              const AttitudeHistory& attitude = {}) {
    auto scan = std::make_unique<Scan>();
    const auto scanner = std::make_unique<ObstacleScanner>(params, LidarParams{.P_base_lidar = P_base_lidar});
    REQUIRE(scanner->scan(cloud, attitude, *scan));
    return scan;
}

std::unique_ptr<Scan> scan_of(const Lasers& lasers, const Solid& solid, const ObstacleParams& params = {}) {
    return scan_of(*revolution(lasers, solid), params);
}

std::uint32_t beam_at(const Scan& scan, double direction_rad) {
    const double from_first = wrap_angle(direction_rad - scan.angle_min_rad - kPi) + kPi;
    return static_cast<std::uint32_t>(std::lround(from_first / scan.angle_increment_rad)) % scan.count;
}

auto number_of(const Scan& scan, Beam kind) {
    return std::count(scan.beam.begin(), scan.beam.begin() + scan.count, kind);
}

bool ground(double /*x_m*/, double /*y_m*/, double z_m) {
    return z_m < 0.0;
}

bool is_in(double v, double low, double high) {
    return v > low && v < high;
}

}  // namespace

TEST_CASE("obstacle scan: level ground is clear as far as it was seen") {
    for (const Lasers& lasers : {sixteen(), sixty_four()}) {
        const auto scan = scan_of(lasers, ground);
        CHECK(scan->count == 720);
        CHECK(number_of(*scan, Beam::kClear) == 720);
        for (std::uint32_t i = 0; i < scan->count; ++i) {
            // The last ring of 16 lasers within 30 m is 5 degrees down, that of 64 is at 20 m or more.
            CHECK(static_cast<double>(scan->range_m[i]) ==
                  Approx(lasers.rotation_rad.size() == 16 ? 20.57 : 20.0).margin(0.6));
        }
    }
}

TEST_CASE("obstacle scan: walls are where they are, in the order and at the time that the beams say") {
    const Solid room = [](double x_m, double y_m, double z_m) {
        return z_m < 0.0 || x_m > 8.0 || x_m < -3.0 || y_m > 2.0 || y_m < -5.0;
    };
    for (const Lasers& lasers : {sixteen(), sixty_four()}) {
        const auto cloud = revolution(lasers, room);
        const auto scan = scan_of(*cloud);
        CHECK(number_of(*scan, Beam::kHit) == 720);
        double worst_m = 0.0;
        for (std::uint32_t i = 0; i < scan->count; ++i) {
            const double angle_rad = scan->angle_min_rad + i * scan->angle_increment_rad;
            const double x = std::cos(angle_rad);
            const double y = std::sin(angle_rad);
            const double wall_m = std::min(x > 0.0 ? 8.0 / x : -3.0 / x, y > 0.0 ? 2.0 / y : -5.0 / y);
            worst_m = std::max(worst_m, std::abs(static_cast<double>(scan->range_m[i]) - wall_m));
        }
        CHECK(worst_m < 0.1);
        CHECK(scan->time_per_beam_s * 720 == Approx(-kTurn_s));
        // Beam 100 is measured when the head looks there.
        const double at_s = (scan->stamp - Stamp{}).seconds() + 100 * scan->time_per_beam_s;
        const double head_rad = -(kPi + 2.0 * kPi * at_s / kTurn_s);
        const double beam_rad = scan->angle_min_rad + 100 * scan->angle_increment_rad;
        CHECK(wrap_angle(head_rad - beam_rad) == Approx(0.0).margin(1e-6));
    }
}

TEST_CASE("obstacle scan: a step is an obstacle where it is higher than the vehicle's") {
    const auto step = [](double height_m) -> Solid {
        return [height_m](double x_m, double y_m, double z_m) {
            return z_m < 0.0 || (is_in(x_m, 4.0, 6.0) && is_in(y_m, -1.0, 1.0) && z_m < height_m);
        };
    };
    for (const Lasers& lasers : {sixteen(), sixty_four()}) {
        const auto low = scan_of(lasers, step(0.08));
        CHECK(number_of(*low, Beam::kHit) == 0);
        const auto high = scan_of(lasers, step(1.0));
        const std::uint32_t ahead = beam_at(*high, 0.0);
        REQUIRE(high->beam[ahead] == Beam::kHit);
        CHECK(static_cast<double>(high->range_m[ahead]) == Approx(4.0).margin(0.05));
        CHECK(high->beam[beam_at(*high, radians(30.0))] == Beam::kClear);
    }
    // With another vehicle it is none.
    CHECK(number_of(*scan_of(sixteen(), step(1.0), {.height_step_m = 1.1}), Beam::kHit) == 0);
}

TEST_CASE("obstacle scan: a wall that is passed along is straight, and ends where it ends") {
    // 6 m to the left, from 3 m to 16 m ahead; and a pole that is less than a sector wide.
    const Solid wall = [](double x_m, double y_m, double z_m) {
        return z_m < 0.0 || (is_in(x_m, 3.0, 16.0) && is_in(y_m, 6.0, 7.0)) ||
               (is_in(x_m, 14.96, 15.04) && is_in(y_m, -3.04, -2.96) && z_m < 2.0);
    };
    for (const Lasers& lasers : {sixteen(), sixty_four()}) {
        const auto scan = scan_of(lasers, wall);
        int on_wall = 0;
        int on_pole = 0;
        for (std::uint32_t beam = 0; beam < scan->count; ++beam) {
            if (scan->beam[beam] != Beam::kHit) {
                continue;
            }
            const double direction_rad = scan->angle_min_rad + beam * scan->angle_increment_rad;
            const double x_m = static_cast<double>(scan->range_m[beam]) * std::cos(direction_rad);
            const double y_m = static_cast<double>(scan->range_m[beam]) * std::sin(direction_rad);
            INFO(x_m << " " << y_m);
            if (y_m > 0.0) {
                ++on_wall;
                CHECK(y_m > 5.95);  // the nearest point of the sector, told for its middle, would lie at 5.93 to 5.97
                CHECK(x_m > 2.95);
                CHECK(x_m < 16.05);
            } else {
                ++on_pole;
                CHECK(std::hypot(x_m - 15.0, y_m + 3.0) < 0.15);
            }
        }
        CHECK(on_wall > 80);
        CHECK(on_pole >= 1);
    }
}

TEST_CASE("obstacle scan: the lasers on a near wall lie less than a step apart") {
    // 64 lasers, 0.42 degrees apart, on a wall at 3 m: 3 cm from point to point.
    const auto scan = scan_of(sixty_four(), [](double x_m, double, double z_m) { return z_m < 0.0 || x_m > 3.0; });
    const std::uint32_t ahead = beam_at(*scan, 0.0);
    REQUIRE(scan->beam[ahead] == Beam::kHit);
    CHECK(static_cast<double>(scan->range_m[ahead]) == Approx(3.0).margin(0.03));
}

TEST_CASE("obstacle scan: a gentle slope is driven up, a steep one is not") {
    const auto ramp = [](double slope_deg) -> Solid {
        return [rise = std::tan(radians(slope_deg))](double x_m, double, double z_m) {
            return z_m < std::max(0.0, (x_m - 4.0) * rise);
        };
    };
    for (const Lasers& lasers : {sixteen(), sixty_four()}) {
        CHECK(number_of(*scan_of(lasers, ramp(10.0)), Beam::kHit) == 0);
        const auto steep = scan_of(lasers, ramp(25.0));
        const std::uint32_t ahead = beam_at(*steep, 0.0);
        REQUIRE(steep->beam[ahead] == Beam::kHit);
        CHECK(static_cast<double>(steep->range_m[ahead]) == Approx(4.7).margin(0.7));
        CHECK(steep->beam[beam_at(*steep, kPi)] == Beam::kClear);
    }
}

TEST_CASE("obstacle scan: what hangs above the vehicle is driven under") {
    const auto branch = [](double bottom_m) -> Solid {
        return [bottom_m](double x_m, double y_m, double z_m) {
            return z_m < 0.0 || (is_in(x_m, 5.0, 7.0) && is_in(y_m, -2.0, 2.0) && is_in(z_m, bottom_m, bottom_m + 1.0));
        };
    };
    for (const Lasers& lasers : {sixteen(), sixty_four()}) {
        CHECK(number_of(*scan_of(lasers, branch(2.1)), Beam::kHit) == 0);
        const auto low = scan_of(lasers, branch(1.2));
        const std::uint32_t ahead = beam_at(*low, 0.0);
        REQUIRE(low->beam[ahead] == Beam::kHit);
        CHECK(static_cast<double>(low->range_m[ahead]) == Approx(5.0).margin(0.1));
    }
}

TEST_CASE("obstacle scan: far off a wall is one though a single laser meets it below the vehicle's height") {
    // Laser -5 deg meets it 0.2 m up, 3 m behind where the one before met the ground; the next 0.9 m up.
    const ObstacleParams low{.vehicle_height_m = 0.5};
    const auto wall = scan_of(
        sixteen(), [](double x_m, double, double z_m) { return z_m < 0.0 || x_m > 18.0; }, low);
    const std::uint32_t ahead = beam_at(*wall, 0.0);
    REQUIRE(wall->beam[ahead] == Beam::kHit);
    CHECK(static_cast<double>(wall->range_m[ahead]) == Approx(18.0).margin(0.05));
    // As high up, but a hillside; and a crown over it, which the next laser meets elsewhere.
    for (const double crown_m : {20.0, 1.2}) {
        const auto hill = [crown_m](double x_m, double, double z_m) {
            return z_m < std::max(0.0, 0.08 * (x_m - 8.0)) || (is_in(x_m, 13.0, 15.0) && is_in(z_m, crown_m, 4.0));
        };
        CHECK(number_of(*scan_of(sixteen(), hill, low), Beam::kHit) == 0);
    }
}

TEST_CASE("obstacle scan: beyond the range obstacles are not told, and what was not seen is not clear") {
    const Lasers lasers = sixteen();
    const auto far =
        scan_of(lasers, [](double x_m, double, double z_m) { return z_m < 0.0 || x_m > 12.0; }, {.range_max_m = 10.0});
    CHECK(number_of(*far, Beam::kHit) == 0);
    CHECK(static_cast<double>(*std::max_element(far->range_m.begin(), far->range_m.begin() + far->count)) == 10.0);

    // Nothing comes back from 6 to 9 m: what lies behind is not known to be clear.
    auto cloud = revolution(lasers, ground);
    for (std::size_t i = 0; i < std::size_t{kColumns} * 16; ++i) {
        const double range_m = std::hypot(static_cast<double>(cloud->x_m[i]), static_cast<double>(cloud->y_m[i]));
        if (is_in(range_m, 7.0, 10.0)) {
            cloud->beam[i] = Beam::kNoReturn;
        }
    }
    const auto dark = scan_of(*cloud);
    CHECK(number_of(*dark, Beam::kClear) == 720);
    CHECK(static_cast<double>(*std::max_element(dark->range_m.begin(), dark->range_m.begin() + 720)) < 7.0);

    // Nor is anything where a packet was lost.
    std::fill_n(cloud->measured.begin() + 360, 48, false);
    const auto lost = scan_of(*cloud);
    CHECK(number_of(*lost, Beam::kInvalid) == 24);
    CHECK(lost->beam[beam_at(*lost, radians(180.0 - 96.0))] == Beam::kInvalid);
}

TEST_CASE("obstacle scan: the vehicle does not see itself") {
    // The bonnet, of a lidar 1.5 m ahead of the rear axle and turned left by a right angle.
    const Solid bonnet = [](double x_m, double y_m, double z_m) {
        // In the lidar's axes: ahead of it is the vehicle's left.
        return z_m < 0.0 || (is_in(-y_m, 1.0, 2.0) && is_in(x_m, -0.8, 0.8) && z_m < 1.45);
    };
    const Lasers lasers = sixteen();
    const auto cloud = revolution(lasers, bonnet);
    const Pose2 mounted{.x_m = 1.5, .y_m = 0.0, .theta_rad = 0.5 * kPi};
    CHECK(number_of(*scan_of(*cloud, {}, mounted), Beam::kHit) > 50);
    const ObstacleParams masked{.body_x_min_m = -1.0, .body_x_max_m = 3.6, .body_half_width_m = 0.9};
    CHECK(number_of(*scan_of(*cloud, masked, mounted), Beam::kHit) == 0);
}

TEST_CASE("obstacle scan: a lidar that looks down sees level ground as level") {
    const Lasers lasers = sixteen();
    const auto cloud = revolution(lasers, ground, radians(20.0));
    const auto told = scan_of(*cloud, {.lidar_pitch_rad = radians(20.0)});
    CHECK(number_of(*told, Beam::kHit) == 0);
    CHECK(number_of(*told, Beam::kClear) > 360);
    CHECK(number_of(*scan_of(*cloud), Beam::kHit) > 100);  // without being told
}

TEST_CASE("obstacle scan: a vehicle that pitches is levelled about its own place") {
    // A wall 10 m ahead of base_link, seen by a vehicle that looks 8 degrees down: its lidar has moved ahead by 0.25 m.
    const double pitch_rad = radians(8.0);
    const double ahead_m = kHeight_m * std::sin(pitch_rad);
    const double lower_m = kHeight_m * (1.0 - std::cos(pitch_rad));
    const Solid wall = [=](double x_m, double, double z_m) { return z_m < lower_m || x_m > 10.0 - ahead_m; };
    const auto cloud = revolution(sixteen(), wall, pitch_rad);
    AttitudeHistory attitude;
    attitude.add(Stamp{}, {.x = -std::sin(pitch_rad), .y = 0.0, .z = std::cos(pitch_rad)});
    const auto scan = scan_of(*cloud, {}, {}, attitude);
    const std::uint32_t ahead = beam_at(*scan, 0.0);
    REQUIRE(scan->beam[ahead] == Beam::kHit);
    CHECK(static_cast<double>(scan->range_m[ahead]) == Approx(10.0).margin(0.03));
    CHECK(scan->beam[beam_at(*scan, kPi)] != Beam::kHit);
    // Without an attitude it stands elsewhere.
    CHECK(static_cast<double>(scan_of(*cloud)->range_m[ahead]) < 9.9);
}

TEST_CASE("obstacle scan: no complete revolution, no scan") {
    const Lasers lasers = sixteen();
    auto cloud = revolution(lasers, ground);
    const auto scanner = std::make_unique<ObstacleScanner>(ObstacleParams{}, LidarParams{});
    auto scan = std::make_unique<Scan>();
    cloud->complete = false;
    CHECK_FALSE(scanner->scan(*cloud, {}, *scan));
    CHECK(scan->count == 0);
}
