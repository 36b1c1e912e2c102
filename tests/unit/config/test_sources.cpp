#include <catch2/catch.hpp>
#include <set>
#include <string>
#include <variant>

#include "config/parameters.hpp"
#include "config/port.hpp"
#include "platform/files/input_error.hpp"

namespace crspf {
namespace {

const std::string kDbc = std::string(CRSPF_SOURCE_DIR) + "/config/dbc/";

std::string problems(const std::string& text) {
    try {
        static_cast<void>(parse_config(text, "f.toml"));
        return {};
    } catch (const InputError& e) {
        return e.what();
    }
}

std::string signal(const std::string& role, const std::string& name, const std::string& more = {}) {
    return "[source.base." + role + "]\nsignal = \"" + name + "\"\n" + more + "\n";
}

std::string bus(const std::string& dbc, const std::string& signals, const std::string& more = {}) {
    return "[source.base]\ndriver = \"can\"\nport = \"can0\"\ndbc = \"" + kDbc + dbc + "\"\n" + more + "\n" + signals;
}

const std::string kLeft = signal("left", "LeftPosition.LeftPositionActual", "scale = 1.5e-4\ntimeout_s = 0.1");
const std::string kRight = signal("right", "RightPosition.RightPositionActual", "scale = -1.5e-4");

TEST_CASE("no two keys of a source or signal share a field, and each default is allowed") {
    std::set<std::string> names;
    for (const SourceParameter& p : source_parameters()) {
        INFO(p.table << "." << p.key);
        CHECK(names.insert(std::string(p.table) + "." + std::string(p.key)).second);
        if (is_number(p)) {
            CHECK(get(p, SourceConfig{}) >= p.minimum);
            CHECK(get(p, SourceConfig{}) <= p.maximum);
        }
    }
    for (const SignalParameter& p : signal_parameters()) {
        INFO(p.key);
        CHECK(names.insert("signal." + std::string(p.key)).second);
    }
}

TEST_CASE("ports are understood") {
    CHECK(parse_port("/dev/ttyACM0")->kind == PortConfig::Kind::kSerial);
    CHECK(parse_port("can0")->device == "can0");
    CHECK(parse_port("tcp://192.168.0.10:10940")->address == 0xC0A8000A);
    CHECK(parse_port("tcp://192.168.0.10:10940")->port == 10940);
    CHECK(parse_port("udp://:2368")->address == 0);
    CHECK(parse_port("udp://10.0.0.1:2368")->address == 0x0A000001);
    for (const char* wrong : {"", "tcp://:10940", "tcp://192.168.0.10", "tcp://192.168.0.10:0", "udp://:65536",
                              "udp://1.2.3:5", "udp://1.2.3.4.5:6", "tcp://256.1.1.1:1", "tcp://1.1.1.1:1x",
                              "an_interface_of_a_long_name", "can 0", "http://x"}) {
        INFO(wrong);
        CHECK_FALSE(parse_port(wrong));
    }
}

TEST_CASE("each driver's source loads, and prints to what loads to the same") {
    const std::string text =
        "[source.a]\ndriver = \"scip\"\nport = \"tcp://10.0.0.2:10940\"\ncluster = 3\nencoding = \"two_characters\"\n"
        "[source.b]\ndriver = \"sick\"\nport = \"tcp://10.0.0.3:2112\"\nrecord_only = true\ndialect = \"binary\"\n"
        "frequency_hz = 25\nresolution_deg = 0.25\n"
        "[source.c]\ndriver = \"lms2xx\"\nport = \"/dev/ttyS0\"\nrecord_only = true\nbaud = 500000\nangle = 100\n"
        "resolution = 0.25\n"
        "[source.l]\ndriver = \"ld06\"\nport = \"/dev/ttyUSB0\"\nrecord_only = true\n"
        "[source.d]\ndriver = \"velodyne\"\nport = \"udp://:2368\"\nrecord_only = true\nmodel = \"HDL-64E S2\"\n"
        "address = \"10.0.0.4\"\ncut_deg = 90\nlaser = 7\n"
        "planar = \"obstacles\"\n" +
        bus("canopen_402.dbc", kLeft + kRight, "canopen_nodes = [1, 2]");
    const Config config = parse_config(text, "f.toml");
    REQUIRE(config.sources.size() == 6);
    CHECK(config.sources[0].scip.cluster == 3);
    CHECK(config.sources[0].scip.encoding == ScipEncoding::kTwoChars);
    CHECK(config.sources[1].sick.dialect == SickDialect::kBinary);
    CHECK(config.sources[1].sick.scan->frequency_centihertz == 2500);
    CHECK(config.sources[1].sick.scan->resolution_1e4deg == 2500);
    const SourceConfig& base = config.sources[2];
    CHECK(base.name == "base");
    const auto& wheels = std::get<WheelParams>(base.can.odometer);
    CHECK(wheels.left.signal.signal.id == 897);
    CHECK(wheels.left.signal.signal.layout.length == 32);
    CHECK(wheels.left.signal.timeout.ns == 100'000'000);
    CHECK(wheels.right.signal.scale == -1.5e-4);
    CHECK(base.can.canopen_nodes == std::vector<std::uint32_t>{1, 2});
    CHECK(config.sources[3].lms2xx.variant == Lms2xxVariant{100, 25});
    CHECK(config.sources[4].velodyne.model == VelodyneModel::kHdl64eS2);
    CHECK(config.sources[4].velodyne.source_address == 0x0A000004);
    CHECK(config.sources[4].velodyne_scan.laser == 7U);

    CHECK(config.sources[4].velodyne_planar == PlanarScan::kObstacles);
    CHECK(config.sources[5].driver == SourceDriver::kLd06);

    const std::string printed = print_config(config);
    CHECK(printed.find("canopen_402.dbc") == printed.npos);  // needs no other file
    CHECK(printed.size() < 16384);
    CHECK(print_config(parse_config(printed, "printed.toml")) == printed);
}

TEST_CASE("another process's odometry is an odometer, at a port of datagrams") {
    const std::string stereo = "[source.stereo]\ndriver = \"motion\"\nport = \"udp://127.0.0.1:7750\"\n";
    const Config config = parse_config(stereo, "f.toml");
    CHECK(config.sources[0].driver == SourceDriver::kMotion);
    CHECK_FALSE(is_lidar(config.sources[0].driver));
    CHECK(config.sources[0].port.address == 0x7F000001);
    CHECK(config.sources[0].port.port == 7750);
    const std::string printed = print_config(config);
    CHECK(print_config(parse_config(printed, "printed.toml")) == printed);

    const std::string base = bus("canopen_402.dbc", kLeft + kRight);
    CHECK(problems(base + stereo).find("[source.stereo] is a second odometer beside [source.base]") !=
          std::string::npos);
    CHECK(problems(base + stereo + "record_only = true\n").empty());
    CHECK(problems("[source.x]\ndriver = \"motion\"\nport = \"can0\"")
              .find("this driver takes udp://ADDRESS:PORT (127.0.0.1:7750)") != std::string::npos);
    CHECK(problems("[source.x]\ndriver = \"motion\"\nport = \"udp://:1\"\nbaud = 1").find("unknown key") !=
          std::string::npos);
}

TEST_CASE("a lidar that hangs upside down finds no obstacles on the ground") {
    const std::string velodyne = "[source.a]\ndriver = \"velodyne\"\nport = \"udp://:2368\"\nplanar = \"obstacles\"\n";
    CHECK_NOTHROW(parse_config(velodyne, "f.toml"));
    CHECK(problems("[lidar]\nmount_inverted = true\n" + velodyne).find("f.toml:6:") != std::string::npos);
}

TEST_CASE("two buses' descriptions in one: the vehicle's speed, an IMU's yaw rate") {
    const std::string text = "[source.base]\ndriver = \"can\"\nport = \"can0\"\ndbc = [\"" + kDbc +
                             "agilex_v2.dbc\", \"" + kDbc + "xsens_mti.dbc\"]\n" +
                             signal("speed", "MotionState.LinearSpeed") + signal("yaw_rate", "RateOfTurn.GyroZ");
    const Config config = parse_config(text, "f.toml");
    const auto& imu = std::get<ImuParams>(config.sources[0].can.odometer);
    CHECK(imu.speed->signal.signal.id == 545);
    CHECK(imu.yaw_rate.signal.id == 50);
    const std::string printed = print_config(config);
    CHECK(print_config(parse_config(printed, "printed.toml")) == printed);
}

TEST_CASE("an IMU of six axes: all of them, or the yaw rate alone") {
    const std::string head = "[source.base]\ndriver = \"can\"\nport = \"can0\"\ndbc = [\"" + kDbc +
                             "agilex_v2.dbc\", \"" + kDbc + "xsens_mti.dbc\"]\n" +
                             signal("speed", "MotionState.LinearSpeed") + signal("yaw_rate", "RateOfTurn.GyroZ");
    const std::string rates = signal("roll_rate", "RateOfTurn.GyroX") + signal("pitch_rate", "RateOfTurn.GyroY");
    const std::string accelerations = signal("acceleration_x", "Acceleration.AccelerationX") +
                                      signal("acceleration_y", "Acceleration.AccelerationY") +
                                      signal("acceleration_z", "Acceleration.AccelerationZ", "scale = -1");
    const Config config = parse_config(head + rates + accelerations, "f.toml");
    const auto& imu = std::get<ImuParams>(config.sources[0].can.odometer);
    REQUIRE(imu.inertial);
    CHECK(imu.inertial->pitch_rate.signal.id == 50);
    CHECK(imu.inertial->acceleration_z.signal.id == 52);
    CHECK(imu.inertial->acceleration_z.scale == -1.0);
    const std::string printed = print_config(config);
    CHECK(print_config(parse_config(printed, "printed.toml")) == printed);
    CHECK(problems(head + rates).find("has no signal `acceleration_x`") != std::string::npos);
    const std::string wheels =
        bus("canopen_402.dbc", kLeft + kRight + signal("roll_rate", "LeftPosition.LeftPositionActual"));
    CHECK(problems(wheels).find("beside yaw_rate only") != std::string::npos);
}

TEST_CASE("a yaw rate without a speed") {
    const std::string head = "[source.base]\ndriver = \"can\"\nport = \"can0\"\ndbc = \"" + kDbc + "xsens_mti.dbc\"\n";
    const std::string text = head + signal("yaw_rate", "RateOfTurn.GyroZ");
    const Config config = parse_config(text, "f.toml");
    CHECK_FALSE(std::get<ImuParams>(config.sources[0].can.odometer).speed);
    const std::string printed = print_config(config);
    CHECK(print_config(parse_config(printed, "printed.toml")) == printed);
    CHECK(problems(text + signal("second_speed", "RateOfTurn.GyroX")).find("has no signal `speed`") !=
          std::string::npos);
    CHECK(problems(head + signal("speed", "RateOfTurn.GyroZ")).find("yaw_rate alone") != std::string::npos);
}

TEST_CASE("a steered vehicle and one with an IMU") {
    const std::string dbc =
        "dbc_text = \"\"\"\nBO_ 5 M: 8 X\n SG_ Mux M : 0|4@1+ (1,0) [0|0] \\\"\\\" X\n"
        " SG_ Speed m1 : 8|16@1- (0.01,0) [0|0] \\\"km/h\\\" X\n SG_ Angle m1 : 24|16@1- (0.1,0) [0|0] \\\"deg\\\" X\n"
        " SG_ Rate m2 : 32|32@1- (1,0) [0|0] \\\"rad/s\\\" X\nSIG_VALTYPE_ 5 Rate : 1;\n"
        "SG_MUL_VAL_ 5 Rate Mux 2-3, 7-7;\n\"\"\"\n";
    const std::string head = "[source.base]\ndriver = \"can\"\nport = \"can0\"\n" + dbc;
    const Config car = parse_config(head + signal("speed", "M.Speed", "scale = 0.2777777777777778") +
                                        signal("steering", "M.Angle", "scale = 0.0011\nzero = 0.02"),
                                    "f.toml");
    const auto& ackermann = std::get<AckermannParams>(car.sources[0].can.odometer);
    CHECK(ackermann.steering_zero_rad == 0.02);
    CHECK(ackermann.speed.signal.signal.range_count == 1);
    const Config imu = parse_config(head + signal("speed", "M.Speed") + signal("second_speed", "M.Speed") +
                                        signal("yaw_rate", "M.Rate", "any_source_address = true"),
                                    "f.toml");
    const auto& params = std::get<ImuParams>(imu.sources[0].can.odometer);
    CHECK(params.speed->second.has_value());
    CHECK(params.yaw_rate.signal.layout.type == SignalType::kFloat32);
    CHECK(params.yaw_rate.signal.range_count == 2);
    CHECK(params.yaw_rate.signal.id_mask == kJ1939PgnMask);
    for (const Config* config : {&car, &imu}) {
        const std::string printed = print_config(*config);
        CHECK(print_config(parse_config(printed, "printed.toml")) == printed);
    }
}

TEST_CASE("what is wrong with a source is said with its place and remedy") {
    const auto says = [](const std::string& text, const std::string& what) {
        const std::string found = problems(text);
        INFO(found);
        return found.find(what) != found.npos;
    };
    CHECK(says("source = 3", "f.toml:1:10: source: is an integer; write [source.NAME]"));
    CHECK(says("[source]\nx = 3", "[source] x: is an integer"));
    CHECK(says("[source.x]\nport = \"can0\"", "f.toml:1:9: [source.x] has no driver; add driver = one of \"scip\""));
    CHECK(says("[source.x]\ndriver = \"urg\"", "f.toml:2:10: [source.x] driver: \"urg\" is none of them"));
    CHECK(says("[source.x]\ndriver = \"scip\"", "[source.x] has no port"));
    CHECK(says("[source.x]\ndriver = \"scip\"\nport = \"can0\"", "f.toml:3:8: [source.x] port: \"can0\": this driver"));
    CHECK(says("[source.x]\ndriver = \"scip\"\nport = \"/dev/a\"\nclusters = 1", "did you mean cluster?"));
    CHECK(says("[source.x]\ndriver = \"scip\"\nport = \"/dev/a\"\ncluster = 100", "100 is out of range"));
    CHECK(
        says("[source.x]\ndriver = \"scip\"\nport = \"/dev/a\"\n[source.x.left]\nsignal = \"a.b\"", "only a CAN bus"));
    CHECK(says("[source.\"a b\"]\ndriver = \"scip\"\nport = \"/dev/a\"", "a name has 1 to 32 letters"));
    CHECK(says("[source.a]\ndriver = \"scip\"\nport = \"/dev/a\"\n[source.b]\ndriver = \"scip\"\nport = \"/dev/a\"",
               "port: [source.a] has the same"));
    CHECK(says("[source.a]\ndriver = \"scip\"\nport = \"/dev/a\"\n[source.b]\ndriver = \"scip\"\nport = \"/dev/b\"",
               "is a second lidar beside [source.a]"));
    CHECK(says("[source.a]\ndriver = \"sick\"\nport = \"tcp://1.2.3.4:2112\"\nfrequency_hz = 25", "give both or none"));
    CHECK(says("[source.a]\ndriver = \"lms2xx\"\nport = \"/dev/a\"\nbaud = 57600", "f.toml:4:8: [source.a] baud"));
    CHECK(says("[source.a]\ndriver = \"lms2xx\"\nport = \"/dev/a\"\nresolution = 0.25", "angle, resolution"));
    CHECK(says("[source.a]\ndriver = \"velodyne\"\nport = \"udp://:2368\"\naddress = \"sensor\"", "no IPv4 address"));

    CHECK(says("[source.base]\ndriver = \"can\"\nport = \"can0\"\n" + kLeft + kRight, "has neither dbc nor dbc_text"));
    CHECK(says(bus("none.dbc", kLeft + kRight), "none.dbc: cannot be read"));
    CHECK(says(bus("README.md", kLeft + kRight), "README.md:1:1: "));
    CHECK(says(bus("canopen_402.dbc", ""), "its signals are no odometer"));
    CHECK(says(bus("canopen_402.dbc", kLeft), "has no signal `right`"));
    CHECK(says(bus("canopen_402.dbc", kLeft + kRight + signal("yaw_rate", "LeftPosition.LeftPositionActual")),
               "more than one odometer"));
    CHECK(says(bus("canopen_402.dbc", kLeft + kRight + signal("speed", "LeftPosition.LeftPositionActual")),
               "is not used beside left and right"));
    CHECK(says(bus("canopen_402.dbc", kRight + signal("left", "Left.Position")), "has no message Left;"));
    CHECK(says(bus("canopen_402.dbc", kRight + signal("left", "LeftPosition.Position")), "has no signal Position in"));
    CHECK(says(bus("canopen_402.dbc", kRight + signal("left", "Position")), "is not of the form MESSAGE.SIGNAL"));
    CHECK(says(bus("canopen_402.dbc", kRight + "[source.base.left]\nscale = 1"), "left: has no signal"));
    CHECK(says(bus("canopen_402.dbc", kRight + signal("left", "LeftPosition.LeftPositionActual", "valid = \"Ok\"")),
               "left.valid: "));
    CHECK(says(bus("canopen_402.dbc", kRight + signal("left", "LeftPosition.LeftStatusword", "scale = 1e-5")),
               "left.timeout_s: at speed_max_mps the counter may go half round"));
    CHECK(says(bus("canopen_402.dbc", kLeft + kRight, "canopen_nodes = [0]"), "0 is out of range"));
    CHECK(says(bus("canopen_402.dbc", kLeft + kRight, "canopen_nodes = 1"), "is an integer; expected a list of"));
}

}  // namespace
}  // namespace crspf
