#include <catch2/catch.hpp>
#include <limits>

#include "core/base/trig.hpp"
#include "core/odometry/imu_mounting.hpp"
#include "core/odometry/odometry.hpp"

namespace {

using namespace crspf;

constexpr double kGravity = 9.80665;

ImuSample sample(const Vector3& rate, const Vector3& force) {
    return {.stamp = {},
            .yaw_rate_radps = rate.z,
            .speed_mps = 1.0,
            .inertial = Inertial{.roll_rate_radps = rate.x,
                                 .pitch_rate_radps = rate.y,
                                 .acceleration_x_mps2 = force.x,
                                 .acceleration_y_mps2 = force.y,
                                 .acceleration_z_mps2 = force.z}};
}

void check_in_base(const OdometryParams& params, const Vector3& in_imu, const Vector3& in_base) {
    ImuSample turned = sample(in_imu, 2.0 * in_imu);
    ImuMounting(params).to_base(turned);
    const Vector3 rate{turned.inertial->roll_rate_radps, turned.inertial->pitch_rate_radps, turned.yaw_rate_radps};
    const Vector3 force{turned.inertial->acceleration_x_mps2, turned.inertial->acceleration_y_mps2,
                        turned.inertial->acceleration_z_mps2};
    CHECK(length(rate - in_base) < 1e-9);
    CHECK(length(force - 2.0 * in_base) < 1e-9);
}

}  // namespace

TEST_CASE("imu mounting: each angle turns as REP-103 has it, and yaw comes last") {
    constexpr double kQuarter = kPi / 2.0;
    const Vector3 x{.x = 1.0, .y = 0.0, .z = 0.0};
    const Vector3 y{.x = 0.0, .y = 1.0, .z = 0.0};
    const Vector3 z{.x = 0.0, .y = 0.0, .z = 1.0};
    OdometryParams roll;
    roll.imu_roll_rad = kQuarter;  // its left side up
    check_in_base(roll, y, z);
    check_in_base(roll, x, x);
    OdometryParams pitch;
    pitch.imu_pitch_rad = kQuarter;  // its x axis down
    check_in_base(pitch, x, -1.0 * z);
    check_in_base(pitch, y, y);
    OdometryParams yaw;
    yaw.imu_yaw_rad = kQuarter;
    check_in_base(yaw, x, y);
    check_in_base(yaw, z, z);
    // On edge, as in config/examples/sick_canmod.toml: x points up; y to the right, z back.
    OdometryParams edge;
    edge.imu_pitch_rad = -kQuarter;
    edge.imu_yaw_rad = kPi;
    edge.imu_roll_rad = 0.0;
    check_in_base(edge, x, z);
    check_in_base(edge, y, -1.0 * y);
    check_in_base(edge, z, x);
    OdometryParams all;
    all.imu_roll_rad = kQuarter;
    all.imu_pitch_rad = kQuarter;
    all.imu_yaw_rad = kQuarter;
    check_in_base(all, y, y);  // up by roll, forward by pitch, left by yaw
}

TEST_CASE("imu mounting: the odometry of one on edge is that of one that lies as the vehicle does") {
    OdometryParams params;
    params.imu_pitch_rad = -kPi / 2.0;
    Odometry edge(params);
    Odometry plain{OdometryParams{}};
    for (int i = 0; i <= 200; ++i) {
        const Vector3 rate{.x = 0.01, .y = -0.02, .z = 0.3};
        const Vector3 force{.x = 0.1, .y = 0.3, .z = kGravity};
        ImuSample level = sample(rate, force);
        // Its x axis points up, its z axis back.
        ImuSample askew = sample({.x = rate.z, .y = rate.y, .z = -rate.x}, {.x = force.z, .y = force.y, .z = -force.x});
        level.stamp = askew.stamp = Stamp{i * 10'000'000LL};
        plain.add(level);
        edge.add(askew);
    }
    CHECK(plain.pose().theta_rad > 0.5);
    CHECK(edge.pose().theta_rad == Approx(plain.pose().theta_rad).margin(1e-9));
    CHECK(edge.pose().x_m == Approx(plain.pose().x_m).margin(1e-9));
    const Stamp last{200 * 10'000'000LL};
    CHECK(length(edge.attitude().up_at(last) - plain.attitude().up_at(last)) < 1e-9);

    // A yaw rate alone says nothing there.
    const Pose2 before = edge.pose();
    edge.add(ImuSample{.stamp = Stamp{2'010'000'000}, .yaw_rate_radps = 1.0, .speed_mps = 1.0});
    ImuSample damaged = sample({.x = std::numeric_limits<double>::quiet_NaN(), .y = 0.0, .z = 0.0}, Vector3{});
    damaged.stamp = Stamp{2'020'000'000};
    edge.add(damaged);
    CHECK(edge.counters().askew == 2);
    CHECK(edge.pose() == before);
}
