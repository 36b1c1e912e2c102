// What the simulated base tells, the decoders of drivers/can must hear.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "drivers/can/motion_decoders.hpp"
#include "drivers/can/wheel_decoder.hpp"
#include "tools/sim/random.hpp"
#include "tools/sim/signal_frames.hpp"

namespace crspf {
namespace {

constexpr double kTick_s = 0.02;

Stamp at(int tick) {
    return Stamp{} + Duration::from_seconds(tick * kTick_s);
}

/// A bus whose signals the configuration binds; `dbc` names a file of config/dbc.
CanSourceConfig bus(const std::string& dbc, const std::string& tables) {
    const std::string directory = std::string(CRSPF_SOURCE_DIR) + "/config/dbc/";
    return parse_config("[source.base]\ndriver = \"can\"\nport = \"can0\"\n" +
                            (dbc.find('\n') == std::string::npos ? "dbc = \"" + directory + dbc + "\"\n"
                                                                 : "dbc_text = \"\"\"\n" + dbc + "\"\"\"\n") +
                            tables,
                        "test.toml")
        .sources.at(0)
        .can;
}

/// Forth, back, and forth again, from a counter that begins anywhere.
double way_m(int tick) {
    return 3.0 * std::sin(0.02 * tick);
}

double speed_mps(int tick) {
    return 3.0 * 0.02 / kTick_s * std::cos(0.02 * tick);
}

struct Heard {
    double left_m = 0.0;
    double right_m = 0.0;
    WheelCounters counters;
    BindingCounters left;
};

/// Both wheels drive; the right one half as far.
Heard drive(const CanSourceConfig& can, int ticks = 400) {
    const auto& wheels = std::get<WheelParams>(can.odometer);
    sim::SignalFrames frames(can.dbc_text, {wheels.left.signal, wheels.right.signal});
    sim::WheelSignal left(wheels.left);
    sim::WheelSignal right(wheels.right);
    WheelDecoder decoder(wheels);
    Heard heard;
    for (int tick = 0; tick < ticks; ++tick) {
        left.tell(way_m(tick), speed_mps(tick), frames);
        right.tell(0.5 * way_m(tick), 0.5 * speed_mps(tick), frames);
        frames.send([&](const CanFrame& frame) {
            if (const auto sample = decoder.on_frame(frame, at(tick))) {
                heard.left_m += sample->left_m;
                heard.right_m += sample->right_m;
            }
        });
    }
    heard.counters = decoder.counters();
    heard.left = decoder.left_counters();
    return heard;
}

void check_drive(const Heard& heard, double margin_m, int ticks = 400) {
    CHECK(heard.left_m == Approx(way_m(ticks - 1)).margin(margin_m));
    CHECK(heard.right_m == Approx(0.5 * way_m(ticks - 1)).margin(margin_m));
    CHECK(heard.counters.samples == static_cast<std::uint64_t>(ticks - 1));
    CHECK(heard.counters.jumps + heard.counters.restarts + heard.counters.unpaired == 0);
    CHECK(heard.left.absent + heard.left.invalid + heard.left.alive_stuck + heard.left.alive_jumped == 0);
}

}  // namespace

TEST_CASE("signal frames: counters of wheels, round their width, mounted the other way round, in metres") {
    check_drive(drive(bus("canopen_402.dbc",
                          "[source.base.left]\nsignal = \"LeftPosition.LeftPositionActual\"\nscale = 1e-4\n"
                          "[source.base.right]\nsignal = \"RightPosition.RightPositionActual\"\nscale = -1e-4\n")),
                1e-3);
    check_drive(drive(bus("agilex_v2.dbc",
                          "[source.base.left]\nsignal = \"Odometry.LeftWay\"\n"
                          "[source.base.right]\nsignal = \"Odometry.RightWay\"\n")),
                2e-3);
}

TEST_CASE("signal frames: a modulus, a direction beside counters that only count up, validity, an alive counter") {
    const std::string more =
        "scale = 0.02\nmodulus = 1001\nvalid_bits = 0\nalive = \"PulseCounter\"\nbackward_bits = 2\ntimeout_s = 0.1\n";
    const CanSourceConfig can = bus("vw_mqb_wheels.dbc",
                                    "[source.base.left]\nsignal = \"ESP_10.PulsesRearLeft\"\n"
                                    "valid = \"PulsesRearLeftQuality\"\ndirection = \"DirectionRearLeft\"\n" +
                                        more +
                                        "[source.base.right]\nsignal = \"ESP_10.PulsesRearRight\"\n"
                                        "valid = \"PulsesRearRightQuality\"\ndirection = \"DirectionRearRight\"\n" +
                                        more);
    check_drive(drive(can, 2000), 0.05, 2000);  // a pulse is 2 cm, and a turning point may cost one
}

TEST_CASE("signal frames: wheel speeds, one that knows no sign gets the magnitude") {
    const std::string more = "scale = 0.2777777777777778\nis_speed = true\n";
    const CanSourceConfig can =
        bus("vw_mqb_wheels.dbc", "[source.base.left]\nsignal = \"ESP_19.SpeedRearLeft\"\n" + more +
                                     "[source.base.right]\nsignal = "
                                     "\"ESP_19.SpeedRearRight\"\n" +
                                     more);
    constexpr int kForward = 75;  // before the first turning point
    check_drive(drive(can, kForward), 0.01, kForward);
    const Heard there_and_back = drive(can, 2 * kForward);
    CHECK(there_and_back.left_m == Approx(2.0 * 3.0 - way_m(2 * kForward - 1)).margin(0.01));
}

TEST_CASE("signal frames: steering and speed of a message, IMU axes by their group, to half a digit") {
    const CanSourceConfig car = bus("agilex_v2.dbc",
                                    "[source.base.speed]\nsignal = \"MotionState.LinearSpeed\"\n"
                                    "[source.base.steering]\nsignal = \"MotionState.SteeringAngle\"\nzero = 0.1\n");
    const auto& steered = std::get<AckermannParams>(car.odometer);
    sim::SignalFrames frames(car.dbc_text, {steered.speed.signal, steered.steering});
    AckermannDecoder decoder(steered);
    sim::Random random(1, sim::RandomStream::kTest);
    for (int tick = 0; tick < 200; ++tick) {
        const double speed = random.uniform(-9.0, 9.0);
        const double steering_rad = random.uniform(-0.6, 0.6);
        frames.set(steered.speed.signal, speed);
        frames.set(steered.steering, steering_rad + steered.steering_zero_rad);
        int sent = 0;
        frames.send([&](const CanFrame& frame) {
            ++sent;
            const auto sample = decoder.on_frame(frame, at(tick));
            REQUIRE(sample);
            CHECK(std::abs(sample->speed_mps - speed) <= 0.5001e-3);
            CHECK(std::abs(sample->steering_rad - steering_rad) <= 0.5001e-3);
        });
        CHECK(sent == 1);
    }

    const CanSourceConfig imu = bus("openimu_j1939.dbc",
                                    "[source.base.speed]\nsignal = \"Acceleration.AccelerationFirst\"\n"
                                    "any_source_address = true\n[source.base.yaw_rate]\nsignal = "
                                    "\"AngularRate.RateThird\"\nscale = -0.017453292519943295\n"
                                    "any_source_address = true\n");
    const auto& turned = std::get<ImuParams>(imu.odometer);
    sim::SignalFrames groups(imu.dbc_text, {turned.speed->signal, turned.yaw_rate});
    ImuDecoder listener(turned);
    groups.set(turned.speed->signal, 3.21);
    groups.set(turned.yaw_rate, 0.5);
    std::optional<ImuSample> sample;
    groups.send([&](const CanFrame& frame) {
        CHECK(frame.extended);
        CHECK(frame.length == 8);
        const auto one = listener.on_frame(frame, at(0));
        sample = one ? one : sample;
    });
    REQUIRE(sample);
    CHECK(sample->speed_mps == Approx(3.21));
    CHECK(sample->yaw_rate_radps == Approx(0.5).margin(0.5 * 0.0078125 * 0.0174533));
}

TEST_CASE("signal frames: signals that share a message by turns each get a frame, and what is beside them both") {
    const CanSourceConfig can =
        bus("BO_ 100 Shared: 8 X\n"
            " SG_ Which M : 0|4@1+ (1,0) [0|0] \"\" X\n"
            " SG_ Alive : 4|4@1+ (1,0) [0|0] \"\" X\n"
            " SG_ Speed m3 : 8|16@1- (0.01,0) [0|0] \"\" X\n"
            " SG_ Steering m5 : 15|16@0- (0.001,0) [0|0] \"\" X\n",
            "[source.base.speed]\nsignal = \"Shared.Speed\"\n"
            "[source.base.steering]\nsignal = \"Shared.Steering\"\n");
    const auto& car = std::get<AckermannParams>(can.odometer);
    sim::SignalFrames frames(can.dbc_text, {car.speed.signal, car.steering});
    AckermannDecoder decoder(car);
    frames.set(car.speed.signal, -1.25);
    frames.set(car.steering, 0.125);
    std::vector<CanFrame> sent;
    std::optional<AckermannSample> sample;
    frames.send([&](const CanFrame& frame) {
        sent.push_back(frame);
        sample = decoder.on_frame(frame, at(0));
    });
    REQUIRE(sent.size() == 2);
    CHECK((sent[0].data[0] & 0xFU) == 3);
    CHECK((sent[1].data[0] & 0xFU) == 5);
    REQUIRE(sample);
    CHECK(sample->speed_mps == Approx(-1.25));
    CHECK(sample->steering_rad == Approx(0.125));
}

}  // namespace crspf
