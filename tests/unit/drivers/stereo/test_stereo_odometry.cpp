#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "drivers/stereo/stereo_odometry.hpp"
#include "tests/unit/drivers/stereo/painted_room.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

constexpr std::int64_t kPeriod_ns = 66'666'667;
constexpr double kPeriod_s = 1e-9 * kPeriod_ns;

/// Takes a picture now and then, and keeps what came of it.
class Ride {
 public:
    explicit Ride(const StereoParams& params = {}) : odometry(kCamera, params) {}

    const StereoMotion& look(const PaintedRoom& room, Place place) {
        const Pictures pictures = room.seen_from(place, picture_);
        REQUIRE(odometry.add({picture_ * kPeriod_ns}, pictures.view(), motion));
        ++picture_;
        way = way * motion.sample.P_previous_base;
        doubt_m2 += motion.sample.translation_variance_m2;
        return motion;
    }

    StereoOdometry odometry;
    StereoMotion motion;
    Pose2 way;  ///< of base_link
    double doubt_m2 = 0.0;

 private:
    unsigned picture_ = 0;
};

}  // namespace

TEST_CASE("stereo odometry: straight on among boards", "[stereo]") {
    const PaintedRoom room;
    Ride ride;
    for (int i = 0; i <= 30; ++i) {
        ride.look(room, {.x = 0.0, .z = 0.05 * i});
        CHECK(ride.motion.blindness == Blindness::kSees);
        CHECK_FALSE(ride.motion.sample.blind);
    }
    CHECK(ride.way.x_m == Approx(1.5).margin(0.02));
    CHECK(ride.way.y_m == Approx(0.0).margin(0.02));
    CHECK(std::abs(ride.way.theta_rad) < 0.005);
    CHECK(ride.doubt_m2 > 1e-8);
    CHECK(ride.doubt_m2 < 0.02 * 0.02);
    CHECK(ride.motion.P_first_camera.t.z() == Approx(1.5).margin(0.02));
    CHECK(ride.odometry.counters().blind == 0);
}

TEST_CASE("stereo odometry: the camera's place on the robot counts", "[stereo]") {
    const PaintedRoom room;
    // It looks to the left: what it sees coming towards it is the robot going sideways, to its left.
    Ride ride({.mounting = {.x_m = 0.3, .yaw_rad = kPi / 2.0}});
    for (int i = 0; i <= 20; ++i) {
        ride.look(room, {.x = 0.0, .z = 0.04 * i});
    }
    CHECK(ride.way.y_m == Approx(0.8).margin(0.02));
    CHECK(ride.way.x_m == Approx(0.0).margin(0.02));
}

TEST_CASE("stereo odometry: a robot that stands does not wander", "[stereo]") {
    const PaintedRoom room;
    Ride ride;
    for (int i = 0; i < 60; ++i) {
        ride.look(room, {});
    }
    CHECK(std::hypot(ride.way.x_m, ride.way.y_m) < 0.003);
    CHECK(std::abs(ride.way.theta_rad) < 0.001);
    CHECK(ride.odometry.counters().references == 1);
}

TEST_CASE("stereo odometry: the same pictures give the same bits", "[stereo]") {
    const PaintedRoom room;
    Ride a;
    Ride b;
    for (int i = 0; i <= 8; ++i) {
        const Place place{.x = 0.01 * i, .z = 0.06 * i};
        a.look(room, place);
        b.look(room, place);
        CHECK(a.way == b.way);
        CHECK(a.motion.sample.translation_variance_m2 == b.motion.sample.translation_variance_m2);
    }
}

TEST_CASE("stereo odometry: two seconds in which nothing is seen", "[stereo]") {
    PaintedRoom room;
    Ride ride;
    const double speed_mps = 0.6;
    int i = 0;
    const auto drive = [&](double seconds) {
        for (const int end = i + static_cast<int>(seconds / kPeriod_s); i < end; ++i) {
            const Pose2 before = ride.way;
            ride.look(room, {.x = 0.0, .z = speed_mps * kPeriod_s * i});
            // Never a jump.
            CHECK(std::hypot(ride.way.x_m - before.x_m, ride.way.y_m - before.y_m) <
                  2.0 * speed_mps * kPeriod_s + 0.01);
        }
    };
    drive(1.0);
    const double sure_m2 = ride.doubt_m2;
    SECTION("dark") {
        room.light = 0.0;
    }
    SECTION("a bare wall") {
        room.paint = PaintedRoom::Paint::kNone;
    }
    drive(2.0);
    CHECK(ride.motion.sample.blind);
    CHECK(ride.motion.blindness == Blindness::kNoTexture);
    const std::uint64_t blind = ride.odometry.counters().blind;
    CHECK(blind >= 28);
    // It went on as it went, and says how little it knows.
    CHECK(ride.way.x_m == Approx(speed_mps * 3.0).margin(0.15));
    CHECK(ride.doubt_m2 > sure_m2 + 0.5 * 0.5);
    room = {};
    drive(1.0);
    CHECK_FALSE(ride.motion.sample.blind);
    CHECK(ride.odometry.counters().blind <= blind + 2);
    CHECK(ride.way.x_m == Approx(speed_mps * 4.0).margin(0.2));
}

TEST_CASE("stereo odometry: what is not lit for long is not driven through for long", "[stereo]") {
    PaintedRoom room;
    Ride ride;
    for (int i = 0; i < 10; ++i) {
        ride.look(room, {.x = 0.0, .z = 0.04 * i});
    }
    room.light = 0.0;
    for (int i = 0; i < 150; ++i) {
        ride.look(room, {});
    }
    const Pose2 before = ride.way;
    CHECK(before.x_m == Approx(0.36 + 3.0 * 0.6).margin(0.2));
    ride.look(room, {});
    CHECK(std::hypot(ride.way.x_m - before.x_m, ride.way.y_m - before.y_m) < 1e-9);
    CHECK(ride.motion.sample.translation_variance_m2 > 0.0);
}

TEST_CASE("stereo odometry: a pattern that repeats itself is not followed astray", "[stereo]") {
    PaintedRoom room;
    room.paint = PaintedRoom::Paint::kStripes;
    Ride ride;
    for (int i = 0; i <= 15; ++i) {
        ride.look(room, {.x = 0.0, .z = 0.04 * i});
    }
    // Either it sees aright, by the boards' edges, or it says that it does not.
    CHECK((ride.odometry.counters().blind > 7 || std::abs(ride.way.x_m - 0.6) < 0.06));
}

TEST_CASE("stereo odometry: a crowd that fills most of the picture does not take it along", "[stereo]") {
    PaintedRoom room;
    room.crowd_boards = 3;
    Ride ride;
    for (int i = 0; i < 15; ++i) {
        ride.look(room, {});
    }
    for (int i = 0; i < 15; ++i) {
        room.crowd_m += 0.08;  // 1.2 m/s
        ride.look(room, {});
    }
    CHECK(std::hypot(ride.way.x_m, ride.way.y_m) < 0.05);
}

TEST_CASE("stereo odometry: pairs out of order are dropped, a gap is counted", "[stereo]") {
    const PaintedRoom room;
    const Pictures pictures = room.seen_from({}, 0);
    StereoOdometry odometry(kCamera, {});
    StereoMotion motion;
    REQUIRE(odometry.add({1'000'000'000}, pictures.view(), motion));
    CHECK_FALSE(odometry.add({1'000'000'000}, pictures.view(), motion));
    CHECK_FALSE(odometry.add({500'000'000}, pictures.view(), motion));
    CHECK(odometry.counters().ran_back == 2);
    REQUIRE(odometry.add({9'000'000'000}, pictures.view(), motion));
    CHECK(odometry.counters().gaps == 1);
    CHECK(std::abs(motion.sample.P_previous_base.x_m) < 0.01);
}
