// `crspf calibrate` on whole runs: simulated ones, whose constants are known, and recorded ones.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/trig.hpp"
#include "platform/files/input_error.hpp"
#include "tests/unit/eval/recordings.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tests/unit/sim/command.hpp"
#include "tools/crspf/calibrate.hpp"

namespace {

using namespace crspf;
using test::Scratch;

const Finding& of(const CalibrateOutcome& outcome, std::string_view key) {
    const auto at = std::find_if(outcome.findings.begin(), outcome.findings.end(),
                                 [key](const Finding& finding) { return finding.key == key; });
    REQUIRE(at != outcome.findings.end());
    return *at;
}

void check(const CalibrateOutcome& outcome, std::string_view key, double truth, double margin) {
    const Finding& finding = of(outcome, key);
    std::printf("calibrate: %-20s %9.4f +- %.4f, in truth %9.4f %s\n", finding.key.c_str(), finding.value,
                finding.stddev, truth, finding.unit.c_str());
    CHECK(finding.found);
    CHECK(finding.value == Approx(truth).margin(margin));
}

}  // namespace

TEST_CASE("calibrate: a simulated robot with wheels of other sizes than its maker told", "[replay]") {
    const Scratch scratch;
    const std::string capture = (scratch / "run.pcapng").string();
    test::crspf_sim({"--duration", "240", "--odom-scale-error", "0.03", "--odom-bias", "0.01", "--lidar-y", "0.03",
                     "--lidar-yaw", "-3", "--capture", capture, "--out", (scratch / "sim").string()});
    CalibrateJob job;
    job.logs = {capture};
    job.config = load_config(scratch / "sim/config.toml");
    job.config->slam.lidar.P_base_lidar = {.x_m = 0.1, .y_m = 0.0, .theta_rad = 0.0};
    job.config->slam.odometry.wheel_span_m = 0.35;
    const CalibrateOutcome outcome = run_calibration(job);
    check(outcome, "left_wheel_factor", 1.0 / (1.03 * 0.995), 0.005);
    check(outcome, "right_wheel_factor", 1.0 / (1.03 * 1.005), 0.005);
    check(outcome, "wheel_span_m", 0.33, 0.005);
    check(outcome, "x_m", 0.145, 0.012);
    check(outcome, "y_m", 0.03, 0.012);
    check(outcome, "yaw_deg", -3.0, 0.4);
    check(outcome, "stamp_offset_s", 0.0, 0.015);
    CHECK(outcome.settled);

    // What it wrote is a configuration, and says the same.
    const Config written = parse_config(fragment_of(outcome), "found.toml");
    CHECK(written.slam.odometry.wheel_span_m == Approx(of(outcome, "wheel_span_m").value).margin(1e-6));
    CHECK(written.slam.lidar.P_base_lidar.theta_rad == Approx(radians(of(outcome, "yaw_deg").value)).margin(1e-6));
}

TEST_CASE("calibrate: a simulated car, by speed and steering angle and by its IMU", "[replay]") {
    const Scratch scratch;
    for (const std::string odometer : {"steering", "imu"}) {
        const std::string capture = (scratch / (odometer + ".pcapng")).string();
        test::crspf_sim({"--robot",
                         "ackermann",
                         "--odometer",
                         odometer,
                         "--lidar",
                         "scan270",
                         "--scan-rate",
                         "10",
                         "--duration",
                         "150",
                         "--odom-scale-error",
                         "0.02",
                         "--lidar-y",
                         "0.05",
                         "--lidar-yaw",
                         "4",
                         "--capture",
                         capture,
                         "--out",
                         (scratch / "sim").string()});
        CalibrateJob job;
        job.logs = {capture};
        job.config = load_config(scratch / "sim/config.toml");
        job.config->slam.lidar.P_base_lidar = {.x_m = 0.1, .y_m = 0.0, .theta_rad = 0.0};
        job.config->slam.odometry.wheel_base_m = 0.4;
        const CalibrateOutcome outcome = run_calibration(job);
        check(outcome, "speed_factor", 1.0 / 1.02, 0.005);
        check(outcome, "x_m", 0.145, 0.015);
        check(outcome, "y_m", 0.05, 0.015);
        check(outcome, "yaw_deg", 4.0, 0.4);
        if (odometer == "steering") {
            check(outcome, "wheel_base_m", 0.35, 0.005);
            check(outcome, "steering_offset_deg", 0.0, 0.3);
        }
    }
}

TEST_CASE("calibrate: the recorded URG-04LX runs", "[replay]") {
    for (const char* name : {"urg04lx/breezyslam_exp1.dat.xz", "urg04lx/tinyslam_exp3.dat.xz"}) {
        const auto file = test::recording(name);
        CRSPF_NEED_RECORDING(file);
        CalibrateJob job;
        job.logs = {file};
        job.config = load_config(std::string(CRSPF_SOURCE_DIR) + "/config/examples/urg04lx.toml");
        const CalibrateOutcome outcome = run_calibration(job);
        // Their maker's: factors of 1, a span of 0.33 m, the lidar 0.145 m before the axle. Both runs tell of a span
        // of 0.31 m.
        check(outcome, "left_wheel_factor", 1.0, 0.03);
        check(outcome, "right_wheel_factor", 1.0, 0.03);
        check(outcome, "wheel_span_m", 0.311, 0.01);
        CHECK(std::abs(of(outcome, "x_m").value - 0.145) < 3.0 * of(outcome, "x_m").stddev);
        CHECK(std::abs(of(outcome, "y_m").value) < 3.0 * of(outcome, "y_m").stddev);
    }
}

TEST_CASE("calibrate: the mounting of the recorded car's IMU", "[replay]") {
    const auto file = test::recording("can/car_imu.candump.log.xz");
    CRSPF_NEED_RECORDING(file);
    CalibrateJob job;
    job.logs = {file};
    // On edge: the sensor's x axis points up.
    const std::string dbc = std::string(CRSPF_SOURCE_DIR) + "/config/dbc/canmod_gps.dbc";
    std::string text = "[source.base]\ndriver = \"can\"\nport = \"can0\"\ndbc = \"" + dbc + "\"\n";
    for (const auto& [role, signal] :
         std::vector<std::pair<std::string, std::string>>{{"speed", "GnssSpeed.Speed"},
                                                          {"yaw_rate", "Imu.AngularRateX"},
                                                          {"roll_rate", "Imu.AngularRateY"},
                                                          {"pitch_rate", "Imu.AngularRateZ"},
                                                          {"acceleration_x", "Imu.AccelerationY"},
                                                          {"acceleration_y", "Imu.AccelerationZ"},
                                                          {"acceleration_z", "Imu.AccelerationX"}}) {
        text.append("[source.base.").append(role).append("]\nsignal = \"").append(signal).append("\"\n");
        text += role.ends_with("rate") ? "scale = 0.017453292519943295\n" : "";
        text += role == "speed" ? "timeout_s = 2.5\n" : "";  // GNSS, once a second
    }
    job.config = parse_config(text, "car.toml");
    const CalibrateOutcome outcome = run_calibration(job);
    const Finding& yaw = of(outcome, "imu_yaw_deg");
    std::printf("calibrate: the car's IMU is turned by %.1f +- %.1f deg\n", yaw.value, yaw.stddev);
    CHECK(yaw.found);
    CHECK(yaw.value == Approx(171.4).margin(2.0));
}

TEST_CASE("calibrate: says what is missing", "[replay]") {
    const Scratch scratch;
    CalibrateJob job;
    test::crspf_sim({"--duration", "10", "--out", (scratch / "poses").string()});
    job.logs = {scratch / "poses/log.clf"};
    CHECK_THROWS_WITH(run_calibration(job), Catch::Contains("poses that an odometer has summed up"));
    test::crspf_sim({"--duration", "10", "--format", "dat", "--out", (scratch / "short").string()});
    job.logs = {scratch / "short/log.dat"};
    job.config = load_config(scratch / "short/config.toml");
    CHECK_THROWS_WITH(run_calibration(job), Catch::Contains("too short a drive"));
    job.logs = {scratch / "nowhere.dat"};
    CHECK_THROWS_AS(run_calibration(job), InputError);
}
