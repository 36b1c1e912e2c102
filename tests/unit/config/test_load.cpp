#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "config/config.hpp"
#include "platform/files/input_error.hpp"

namespace crspf {
namespace {

/// What is wrong with `text`, one problem a line; empty where nothing is.
std::string problems(std::string_view text) {
    try {
        static_cast<void>(parse_config(text, "f.toml"));
        return {};
    } catch (const InputError& e) {
        return e.what();
    }
}

/// A file that lives as long as the test.
class TemporaryFile {
 public:
    explicit TemporaryFile(const std::string& content)
        : path_(std::filesystem::temp_directory_path() / ("crspf_config_" + std::to_string(::getpid()) + ".toml")) {
        std::ofstream(path_, std::ios::binary) << content;
    }
    ~TemporaryFile() { std::filesystem::remove(path_); }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
    std::filesystem::path path_;
};

TEST_CASE("an empty configuration holds the defaults") {
    CHECK(print_config(parse_config("", "f.toml")) == print_config(Config{}));
    CHECK(print_config(parse_config("# nothing\r\n\r\n[lidar]\r\n", "f.toml")) == print_config(Config{}));
}

TEST_CASE("values of each type arrive in their fields") {
    const Config config = parse_config(R"(
        [lidar]
        x_m = 0.145
        yaw_deg = -90
        mount_inverted = true
        range_max_m = 4          # an integer will do for a real number
        [wheels]
        counts_per_turn = 512
        [critical_rays]
        window_min = 3
        [particle_filter]
        particles_max = 400
        seed = 9007199254740991
        [odometry]
        rotation_floor_deg = 0.5
        rotation_per_metre_deg = 2.0
        [map]
        resolution_m = 0.05
        [slam]
        deskew = false)",
                                       "f.toml");
    CHECK(config.slam.lidar.P_base_lidar.x_m == 0.145);
    CHECK(config.slam.lidar.P_base_lidar.theta_rad == radians(-90.0));
    CHECK(config.slam.lidar.mount_inverted);
    CHECK(config.slam.lidar.range_max_m == 4.0);
    CHECK(config.wheels.counts_per_turn == 512.0);
    CHECK(config.slam.critical_rays.window_min == 3);
    CHECK(config.slam.particle_filter.particles_max == 400);
    CHECK(config.slam.particle_filter.seed == 9007199254740991U);
    CHECK(config.slam.odometry.rotation_floor_rad == radians(0.5));
    CHECK(config.slam.odometry.rotation_per_metre == radians(2.0));
    CHECK(config.slam.map.resolution_m == 0.05);
    CHECK_FALSE(config.slam.deskew);
}

TEST_CASE("unknown names are refused with what was probably meant") {
    CHECK(problems("[lidar]\nrange_max = 5.6") ==
          "f.toml:2:1: [lidar] range_max: unknown key; did you mean range_max_m?");
    CHECK(problems("[lidar]\n  yaw_rad = 0.1") == "f.toml:2:3: [lidar] yaw_rad: unknown key; did you mean yaw_deg?");
    CHECK(problems("[particle_filter]\nangle_max_rad = 0.1") ==
          "f.toml:2:1: [particle_filter] angle_max_rad: unknown key; did you mean angle_max_deg?");
    CHECK(problems("[lidar]\nx_mm = 145") == "f.toml:2:1: [lidar] x_mm: unknown key; did you mean x_m?");
    CHECK(problems("[wheels]\ncounts_per_tunr = 1") ==
          "f.toml:2:1: [wheels] counts_per_tunr: unknown key; did you mean counts_per_turn?");
    CHECK(problems("[lidar]\nresolution_m = 0.1") ==
          "f.toml:2:1: [lidar] resolution_m: unknown key; did you mean resolution_m of [map]?");
    CHECK(problems("[lidar]\ncolour = \"red\"") ==
          "f.toml:2:1: [lidar] colour: unknown key; `crspf config --reference` lists all");
    CHECK(problems("[analyzer]\nresult_on = 1") == "f.toml:1:2: [analyzer]: unknown table; did you mean [analyser]?");
    CHECK(problems("[ros]") == "f.toml:1:2: [ros]: unknown table; `crspf config --reference` lists all");
    CHECK(problems("deskew = true") == "f.toml:1:1: deskew: key outside of any table; did you mean deskew of [slam]?");
}

TEST_CASE("values that do not fit are refused with what is expected") {
    CHECK(problems("[lidar]\nx_m = \"0.1\"") ==
          "f.toml:2:7: [lidar] x_m: is a string; expected a real number from -100.0 to 100.0 [m]");
    CHECK(problems("[lidar]\nx_m = true") ==
          "f.toml:2:7: [lidar] x_m: is a boolean; expected a real number from -100.0 to 100.0 [m]");
    CHECK(problems("[lidar]\nx_m = [1.0]") ==
          "f.toml:2:7: [lidar] x_m: is an array; expected a real number from -100.0 to 100.0 [m]");
    CHECK(problems("[lidar.x_m]") ==
          "f.toml:1:1: [lidar] x_m: is a table; expected a real number from -100.0 to 100.0 [m]");
    CHECK(problems("[lidar]\nmount_inverted = 1") ==
          "f.toml:2:18: [lidar] mount_inverted: is an integer; expected true or false");
    CHECK(problems("[map]\nhit = 80.0") ==
          "f.toml:2:7: [map] hit: is a real number; expected an integer from 1 to 255 [1/255]");
    CHECK(problems("[map]\nhit = 256") ==
          "f.toml:2:7: [map] hit: 256 is out of range; expected an integer from 1 to 255 [1/255]");
    CHECK(problems("[map]\nhit = -9223372036854775808") ==
          "f.toml:2:7: [map] hit: -9223372036854775808 is out of range; expected an integer from 1 to 255 [1/255]");
    CHECK(problems("[critical_rays]\nweight = 2.5") ==
          "f.toml:2:10: [critical_rays] weight: 2.5 is not whole; expected a whole number from 1.0 to 100.0");
    CHECK(problems("[lidar]\nx_m = nan") ==
          "f.toml:2:7: [lidar] x_m: nan is not finite; expected a real number from -100.0 to 100.0 [m]");
    CHECK(problems("[lidar]\nrange_max_m = inf") ==
          "f.toml:2:15: [lidar] range_max_m: inf is not finite; expected a real number from 0.1 to 300.0 [m]");
    CHECK(problems("lidar = 3") == "f.toml:1:1: [lidar]: is an integer; write [lidar] on a line of its own, once");
    CHECK(problems("[[lidar]]") == "f.toml:1:3: [lidar]: is an array; write [lidar] on a line of its own, once");
}

TEST_CASE("the limits themselves are allowed") {
    CHECK(problems("[map]\nhit = 255").empty());
    CHECK(problems("[map]\nhit = 1").empty());
    CHECK(problems("[lidar]\nyaw_deg = 180.0").empty());
    CHECK_FALSE(problems("[lidar]\nyaw_deg = 180.00000000000003").empty());
}

TEST_CASE("values that contradict each other are refused") {
    CHECK(problems("[analyser]\nresult_on = 1500\nresult_off = 1500.5") ==
          "f.toml:3:14: [analyser] result_off: 1500.5 must be at most result_on, 1500.0; "
          "lower the one or raise the other");
    CHECK(problems("[analyser]\nresult_on = 1500\nresult_off = 1500").empty());
    CHECK(problems("[lidar]\nrange_min_m = 3\nrange_max_m = 3") ==
          "f.toml:2:15: [lidar] range_min_m: 3.0 must be less than range_max_m, 3.0; lower the one or raise the other");
    for (const char* const contradiction : {
             "[lidar]\nrange_min_m = 80",
             "[critical_rays]\nwindow_min = 16\nwindow_max = 15",
             "[particle_filter]\nmatch_min = 1000\nmatch_max = 1000",
             "[particle_filter]\nparticles_min = 200\nparticles_max = 199",
             "[particle_filter]\nrange_min_m = 0.2\nrange_max_m = 0.1",
             "[particle_filter]\nangle_min_deg = 2\nangle_max_deg = 1",
             "[analyser]\ndraw_off = 1000\ndraw_on = 999",
         }) {
        INFO(contradiction);
        CHECK_THAT(problems(contradiction), Catch::Contains("lower the one or raise the other"));
    }
}

TEST_CASE("a contradiction with a default says so") {
    CHECK_THAT(problems("[lidar]\nrange_min_m = 80"),
               Catch::Contains("80.0 must be less than range_max_m, 40.0 (default)"));
    CHECK_THAT(problems("[analyser]\ndraw_on = 1"), Catch::StartsWith("f.toml:2:11: [analyser] draw_off: ") &&
                                                        Catch::Contains(" (default) must be at most draw_on, 1.0;"));
}

TEST_CASE("all problems are reported at once, in the order of the file") {
    CHECK(problems("[slam]\ndeskew = 0\n[map]\nhit = 0\nhitt = 3\n[lidar]\nx_m = 'a'") ==
          "f.toml:2:10: [slam] deskew: is an integer; expected true or false\n"
          "f.toml:4:7: [map] hit: 0 is out of range; expected an integer from 1 to 255 [1/255]\n"
          "f.toml:5:1: [map] hitt: unknown key; did you mean hit?\n"
          "f.toml:7:7: [lidar] x_m: is a string; expected a real number from -100.0 to 100.0 [m]");
}

TEST_CASE("a value that was refused is not compared with others") {
    CHECK(problems("[analyser]\nresult_on = 99999\nresult_off = 2975") ==
          "f.toml:2:13: [analyser] result_on: 99999 is out of range; expected a real number from 0.0 to 2975.0");
}

TEST_CASE("TOML syntax errors are given with their place") {
    CHECK_THAT(problems("[lidar]\nx_m = \n"),
               Catch::StartsWith("f.toml:2:") && Catch::EndsWith("correct the TOML syntax"));
    CHECK_THAT(problems("[lidar]\nx_m = 1\nx_m = 2\n"), Catch::StartsWith("f.toml:3:"));
    CHECK_THAT(problems("[lidar]\n[lidar]\n"), Catch::StartsWith("f.toml:2:"));
    CHECK_THAT(problems("[lidar]\nx_m = 1,5\n"), Catch::StartsWith("f.toml:2:"));
    CHECK_THAT(problems("[map]\nhit = 99999999999999999999\n"), Catch::StartsWith("f.toml:2:"));
    CHECK_THAT(problems(std::string_view("\0\0\0", 3)), Catch::StartsWith("f.toml:1:"));
    CHECK_THAT(problems("\xff\xfe[\0l"), Catch::StartsWith("f.toml:1:"));
    CHECK_THAT(problems(std::string(100000, '[')), Catch::StartsWith("f.toml:1:"));
}

TEST_CASE("a message never carries terminal codes or endless names from the file") {
    const std::string message = problems("[lidar]\n\"\\u001b[31mred\" = 1\n" + std::string(5000, 'a') + " = 1");
    CHECK(message.find('\x1b') == std::string::npos);
    CHECK(message.size() < 600);
}

TEST_CASE("files that cannot be read are refused with the reason") {
    CHECK_THROWS_WITH(load_config("/does/not/exist.toml"),
                      Catch::StartsWith("/does/not/exist.toml:") && Catch::Contains("No such file"));
    CHECK_THROWS_AS(load_config("/does/not/exist.toml"), InputError);
    CHECK_THROWS_WITH(load_config("/"), Catch::Contains("Is a directory"));
    CHECK_THROWS_WITH(load_config("/dev/zero"), Catch::Contains("larger than 1048576 bytes"));
}

TEST_CASE("a file is read whole and named in its errors") {
    {
        const TemporaryFile good("[map]\nresolution_m = 0.1");
        CHECK(load_config(good.path()).slam.map.resolution_m == 0.1);
    }
    const TemporaryFile bad("[map]\nresolution_m = 9");
    CHECK_THROWS_WITH(load_config(bad.path()), Catch::StartsWith(bad.path().string() + ":2:16: [map] resolution_m: 9"));
    CHECK_NOTHROW(load_config("/dev/null"));
}

}  // namespace
}  // namespace crspf
