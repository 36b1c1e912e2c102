// A robot that drives in a circle through a room, sample by sample, and the service's modules without their threads.
#pragma once

#include <catch2/catch.hpp>
#include <memory>
#include <vector>

#include "core/odometry/motion_models.hpp"
#include "platform/crspfd/filter_module.hpp"
#include "platform/crspfd/map_module.hpp"
#include "platform/crspfd/odometry_module.hpp"
#include "tests/unit/core/synthetic.hpp"

namespace crspf::test {

inline constexpr double kDriveSpan_m = 0.4;
inline constexpr double kDriveScanPeriod_s = 0.1;
inline constexpr double kDriveSpeed_mps = 0.5;
inline constexpr double kDriveRadius_m = 1.0;
inline constexpr Pose2 kDriveStart{.x_m = 0.2, .y_m = -1.0, .theta_rad = 0.0};

inline SlamParams params() {
    SlamParams params;
    params.odometry.wheel_span_m = kDriveSpan_m;
    return params;
}

inline Stamp stamp_of(double seconds) {
    return Stamp{1'000'000'000} + Duration::from_seconds(seconds);
}

/// A robot that drives in a circle through a square room with a box in it, its wheels a little wrong.
class Drive {
 public:
    std::vector<DifferentialSample> wheels() {
        std::vector<DifferentialSample> samples;
        for (int i = 0; i < 10; ++i) {
            seconds_ += 0.1 * kDriveScanPeriod_s;
            const double way_m = 1.02 * kDriveSpeed_mps * 0.1 * kDriveScanPeriod_s;
            const double half_m = 0.5 * kDriveSpan_m * way_m / kDriveRadius_m;
            samples.push_back({.stamp = stamp_of(seconds_), .left_m = way_m - half_m, .right_m = way_m + half_m});
        }
        return samples;
    }
    [[nodiscard]] Scan scan() const {
        Scan scan = beams_of(361, radians(-135.0), radians(135.0));
        scan.stamp = stamp_of(seconds_);
        measure(scan, walls_, [&](double later) {
            const double t = seconds_ + later;
            return kDriveStart * arc(kDriveSpeed_mps * t, kDriveSpeed_mps / kDriveRadius_m * t);
        });
        return scan;
    }
    [[nodiscard]] Stamp now() const { return stamp_of(seconds_); }

 private:
    static Walls room() {
        Walls walls = square_room(3.0);
        add_box(walls, -3.0, 2.2, -1.8, 3.0);
        return walls;
    }
    Walls walls_ = room();
    double seconds_ = 0.0;
};

/// What a lidar of three lasers sees of the walls that the scan saw: one laser on the ground before, two on the wall.
inline std::unique_ptr<Cloud> cloud_of(const Scan& scan, double lidar_height_m) {
    auto cloud = std::make_unique<Cloud>();
    cloud->lasers = 3;
    cloud->upward = {0, 1, 2};
    cloud->columns = scan.count;
    cloud->complete = true;
    cloud->cut_rad = -(scan.angle_min_rad + (scan.count - 1) * scan.angle_increment_rad);
    for (std::uint32_t c = 0; c < scan.count; ++c) {
        const std::uint32_t beam = scan.count - 1 - c;  // clockwise
        const double left_rad = scan.angle_min_rad + beam * scan.angle_increment_rad;
        const SinCos direction = sin_cos(left_rad);
        cloud->azimuth_rad[c] = wrap_angle(-left_rad - kPi) + kPi;
        cloud->stamp[c] = scan.stamp + Duration{static_cast<std::int64_t>(c)};
        cloud->measured[c] = true;
        const auto wall_m = static_cast<double>(scan.range_m[beam]);
        for (std::uint32_t l = 0; l < 3; ++l) {
            const std::size_t at = cloud->at(c, l);
            const double range_m = l == 0 ? 0.5 * wall_m : wall_m;
            cloud->x_m[at] = static_cast<float>(range_m * direction.cos);
            cloud->y_m[at] = static_cast<float>(range_m * direction.sin);
            cloud->z_m[at] = static_cast<float>(0.4 * l - lidar_height_m);
            cloud->beam[at] = scan.beam[beam];
        }
    }
    return cloud;
}

struct Modules {
    std::unique_ptr<Exchange> exchange = std::make_unique<Exchange>();
    std::unique_ptr<OdometryModule> odometry = std::make_unique<OdometryModule>(params().odometry, *exchange);
    std::unique_ptr<FilterModule> filter = std::make_unique<FilterModule>(params(), *exchange);
    std::unique_ptr<MapModule> map = std::make_unique<MapModule>(params(), *exchange);
    Stamp now;

    void wheels(Drive& drive) {
        for (const DifferentialSample& sample : drive.wheels()) {
            now = sample.stamp;
            REQUIRE(exchange->motions.push({.sample = sample, .received = now}));
            CHECK(odometry->turn(now));
        }
    }
    void scan(const Scan& scan) { exchange->scan.publish({.scan = scan, .received = now}); }
    bool filter_turn() {
        return filter->turn([this] { return now; });
    }
    const FilterState& filter_state() const {
        exchange->filter.for_control.update();
        return exchange->filter.for_control.value();
    }
    const OdometryState& odometry_state() const {
        exchange->odometry.for_control.update();
        return exchange->odometry.for_control.value();
    }
};

}  // namespace crspf::test
