// Every DBC file that we ship parses to its end, and decodes frames worked out by hand from the devices' descriptions.
#include <catch2/catch.hpp>
#include <filesystem>
#include <string>

#include "drivers/can/dbc_reader.hpp"
#include "tests/unit/drivers/can/can_files.hpp"

using namespace crspf;
using namespace crspf::test;

TEST_CASE("profiles: all parse") {
    int files = 0;
    const std::filesystem::path config = std::filesystem::path(CRSPF_SOURCE_DIR) / "config";
    for (const auto& entry : std::filesystem::recursive_directory_iterator(config)) {
        if (entry.path().extension() != ".dbc") {
            continue;
        }
        ++files;
        INFO(entry.path().string());
        const std::string text = file_text(entry.path());
        DbcReader reader(text);
        int signals = 0;
        DbcReader::Item item = reader.next();
        for (; item != DbcReader::Item::kEnd && item != DbcReader::Item::kError; item = reader.next()) {
            signals += item == DbcReader::Item::kSignal ? 1 : 0;
        }
        CAPTURE(reader.error().line, reader.error().column);
        CHECK(item == DbcReader::Item::kEnd);
        CHECK(signals >= 6);
    }
    CHECK(files == 8);
}

TEST_CASE("profiles: CiA 402 drives") {
    const std::string text = dbc_text("dbc/canopen_402.dbc");
    const CanFrame left = make_frame(0x381, {0x37, 0x06, 0xFE, 0xFF, 0xFF, 0xFF});
    CHECK(value_in(signal_of(text, "LeftPosition", "LeftPositionActual"), left) == -2.0);
    CHECK(value_in(signal_of(text, "LeftPosition", "LeftStatusword"), left) == 0x0637);
    CHECK(value_in(signal_of(text, "RightVelocity", "RightVelocityActual"),
                   make_frame(0x482, {0x37, 0x06, 0x00, 0x01, 0x00, 0x00})) == 256.0);
}

TEST_CASE("profiles: AgileX, protocol V2") {
    const std::string text = dbc_text("dbc/agilex_v2.dbc");
    const CanFrame motion = make_frame(0x221, {0x00, 0x64, 0x00, 0x0A, 0x00, 0x00, 0xFF, 0x9C});
    CHECK(value_in(signal_of(text, "MotionState", "LinearSpeed"), motion) == Approx(0.1));
    CHECK(value_in(signal_of(text, "MotionState", "YawRate"), motion) == Approx(0.01));
    CHECK(value_in(signal_of(text, "MotionState", "SteeringAngle"), motion) == Approx(-0.1));
    const CanFrame ways = make_frame(0x311, {0x00, 0x01, 0x00, 0x00, 0xFF, 0xFF, 0xFF, 0xFF});
    CHECK(value_in(signal_of(text, "Odometry", "LeftWay"), ways) == Approx(65.536));
    CHECK(value_in(signal_of(text, "Odometry", "RightWay"), ways) == Approx(-0.001));
}

TEST_CASE("profiles: inertial sensors") {
    const std::string xsens = dbc_text("dbc/xsens_mti.dbc");
    const CanFrame turn = make_frame(0x032, {0x02, 0x00, 0xFE, 0x00, 0x00, 0x01});
    CHECK(value_in(signal_of(xsens, "RateOfTurn", "GyroX"), turn) == 1.0);
    CHECK(value_in(signal_of(xsens, "RateOfTurn", "GyroY"), turn) == -1.0);
    CHECK(value_in(signal_of(xsens, "RateOfTurn", "GyroZ"), turn) == 1.0 / 512.0);
    CHECK(value_in(signal_of(xsens, "Acceleration", "AccelerationY"), make_frame(0x034, {0, 0, 0x09, 0xCF, 0, 0})) ==
          Approx(9.80859375));
    CHECK(value_in(signal_of(xsens, "Orientation", "Q0"), make_frame(0x021, {0x7F, 0xFF, 0, 0, 0, 0, 0, 0})) ==
          Approx(1.0));
    CHECK(value_in(signal_of(xsens, "Euler", "Yaw"), make_frame(0x022, {0, 0, 0, 0, 0x2D, 0x00})) == 90.0);
    CHECK(value_in(signal_of(xsens, "Velocity", "VelocityX"), make_frame(0x076, {0x00, 0x40, 0, 0, 0, 0})) == 1.0);

    const std::string sbg = dbc_text("dbc/sbg_ellipse.dbc");
    const CanFrame gyro = make_frame(0x122, {0xE8, 0x03, 0x18, 0xFC, 0x01, 0x00});
    CHECK(value_in(signal_of(sbg, "ImuGyro", "GyroX"), gyro) == Approx(1.0));
    CHECK(value_in(signal_of(sbg, "ImuGyro", "GyroY"), gyro) == Approx(-1.0));
    CHECK(value_in(signal_of(sbg, "ImuAcceleration", "AccelerationZ"), make_frame(0x121, {0, 0, 0, 0, 0xD5, 0x03})) ==
          Approx(9.81));
    CHECK(value_in(signal_of(sbg, "ImuInfo", "TimeStamp"), make_frame(0x120, {0x40, 0x42, 0x0F, 0, 0, 0, 0, 0})) ==
          Approx(1.0));
    CHECK(value_in(signal_of(sbg, "EkfEuler", "Yaw"), make_frame(0x132, {0, 0, 0, 0, 0x5C, 0x3D})) == Approx(1.5708));
    CHECK(value_in(signal_of(sbg, "EkfBodyVelocity", "VelocityX"), make_frame(0x139, {0xC8, 0, 0, 0, 0, 0})) ==
          Approx(2.0));

    const std::string openimu = dbc_text("dbc/openimu_j1939.dbc");
    FrameSignal rate = signal_of(openimu, "AngularRate", "RateThird");
    rate.id_mask = kJ1939PgnMask;
    const CanFrame standing = make_frame(0x0CF02A85, {0x00, 0x7D, 0x00, 0x7D, 0x80, 0x7D, 0xFF, 0xFF}, true);
    CHECK(value_in(rate, standing) == 1.0);
    FrameSignal acceleration = signal_of(openimu, "Acceleration", "AccelerationFirst");
    acceleration.id_mask = kJ1939PgnMask;
    CHECK_FALSE(value_in(acceleration, standing).has_value());
    CHECK(value_in(acceleration, make_frame(0x08F02D80, {0xD5, 0x80, 0, 0, 0, 0, 0, 0}, true)) == Approx(9.81));
}

TEST_CASE("profiles: Volkswagen wheels") {
    const std::string text = dbc_text("dbc/vw_mqb_wheels.dbc");
    // Counters 1000, 1, 512, 3 from bit 16 on, ten bits each; directions 0 1 0 1.
    std::uint64_t bits = 0;
    int place = 16;
    for (const std::uint64_t counter : {1000U, 1U, 512U, 3U}) {
        bits |= counter << place;
        place += 10;
    }
    bits |= (std::uint64_t{0x44} << 56U) | 0x5A7CU;
    CanFrame frame{.id = 0x116, .length = 8};
    for (std::size_t i = 0; i < 8; ++i) {
        frame.data[i] = static_cast<std::uint8_t>(bits >> (8 * i));
    }
    CHECK(value_in(signal_of(text, "ESP_10", "PulsesFrontLeft"), frame) == 1000.0);
    CHECK(value_in(signal_of(text, "ESP_10", "PulsesFrontRight"), frame) == 1.0);
    CHECK(value_in(signal_of(text, "ESP_10", "PulsesRearLeft"), frame) == 512.0);
    CHECK(value_in(signal_of(text, "ESP_10", "PulsesRearRight"), frame) == 3.0);
    CHECK(value_in(signal_of(text, "ESP_10", "DirectionFrontRight"), frame) == 1.0);
    CHECK(value_in(signal_of(text, "ESP_10", "DirectionRearLeft"), frame) == 0.0);
    CHECK(value_in(signal_of(text, "ESP_10", "PulseCounter"), frame) == 0xA);
    CHECK(value_in(signal_of(text, "ESP_19", "SpeedRearRight"), make_frame(0x0B2, {0, 0, 0xA0, 0x0F, 0, 0, 0, 0})) ==
          Approx(30.0));
}
