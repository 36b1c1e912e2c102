#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "tools/crspf/commands.hpp"
#include "tools/crspf/sim_params.hpp"
#include "tools/crspf/sim_run.hpp"
#include "tools/sim/lidar_model.hpp"

namespace crspf::cli {

namespace {

/// A number within bounds. CLI::Range lets NaN pass.
CLI::Validator between(double low, double high) {
    char text[64];
    std::snprintf(text, sizeof text, "%g to %g", low, high);
    const std::string bounds = text;
    return {[low, high, bounds](std::string& value) {
                double number = 0.0;
                const bool valid = CLI::detail::lexical_cast(value, number) && number >= low && number <= high;
                return valid ? std::string{} : value + " is not a number from " + bounds;
            },
            ""};
}

/// Shows on a terminal how far it is.
class Progress {
 public:
    Progress() = default;
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    ~Progress() {
        if (terminal_) {
            std::fputs("\r\033[K", stderr);
        }
    }

    void show(double share) {
        const int percent = static_cast<int>(100.0 * std::min(share, 1.0));
        if (terminal_ && percent != shown_percent_) {
            shown_percent_ = percent;
            std::fprintf(stderr, "\r%3d %%", percent);
        }
    }

 private:
    bool terminal_ = ::isatty(STDERR_FILENO) == 1;
    int shown_percent_ = -1;
};

SimRun run_with_progress(const SimOptions& options) {
    Progress progress;
    return run_sim(options, [&](double share) { progress.show(share); });
}

void run(const SimOptions& options) {
    const SimRun run = run_with_progress(options);
    const sim::SimulationResult& result = run.result;
    std::printf(
        "%s: %.1f m driven in %.1f s, %zu scans. Written to %s: %s%struth.tum, world.pgm, world.yaml, config.toml",
        options.world.c_str(), result.driven_m, result.simulated_s, result.truth.size(), options.out.c_str(),
        run.log.c_str(), run.log.empty() ? "" : ", ");
    if (!options.capture.empty()) {
        std::printf("; the capture to %s", options.capture.c_str());
    }
    if (run.picture_pairs) {
        std::printf("; %zu pairs of pictures to %s", *run.picture_pairs, options.stereo.c_str());
    }
    std::printf(".\n");
    if (result.given_up > 0) {
        std::printf("%zu of the places on the way could not be reached in time and were left out.\n", result.given_up);
    }
}

void add_world_options(CLI::App& command, SimOptions& o) {
    const std::string group = "World";
    command
        .add_option("--world", o.world,
                    "office, corridor, meeting, hall, lobby, arena, field, campus, parking, or the YAML file of a map")
        ->type_name("NAME|FILE")
        ->capture_default_str()
        ->group(group);
    command.add_option("--start", o.start, "Where the robot begins; in a map, unless told, at its most open place")
        ->type_name("X,Y[,DEG]")
        ->delimiter(',')
        ->expected(2, 3)
        ->check(between(-1e5, 1e5))
        ->group(group);
    command.add_option("--bumps", o.bumps_deg, "How steep the steepest bumps of the ground are, for a velodyne")
        ->type_name("DEG")
        ->check(between(0.0, 30.0))
        ->capture_default_str()
        ->group(group);
    command.add_option("--people", o.params.people, "People who walk about")
        ->type_name("N")
        ->check(between(0, 1000))
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--cars", o.params.cars,
                    "Cars that drive on the road of a campus or a car park, in both directions")
        ->type_name("N")
        ->check(between(0, 1000))
        ->capture_default_str()
        ->group(group);
}

void add_robot_options(CLI::App& command, SimOptions& o) {
    sim::RobotParams& robot = o.params.robot;
    const auto number = [&](const char* name, double& value, const char* unit, double low, double high,
                            const char* help) {
        command.add_option(name, value, help)
            ->type_name(unit)
            ->check(between(low, high))
            ->capture_default_str()
            ->group("Robot");
    };
    command
        .add_option(
            "--robot", o.robot,
            "How it steers: differential (unless told) or ackermann; car: ackermann, four metres long, lidar on "
            "its roof")
        ->type_name("KIND")
        ->check(CLI::IsMember({"differential", "ackermann", "car"}))
        ->group("Robot");
    command
        .add_option("--config", o.config,
                    "It carries what this configuration says: lidar and mounting, wheels, signals on the bus; the "
                    "capture holds it")
        ->type_name("FILE")
        ->group("Robot");
    command
        .add_option(
            "--odometer", o.odometer,
            "What the base tells in a capture: wheels (counters), imu (speed and an IMU of six axes), steering "
            "(speed and steering angle, of an ackermann robot), inertial (an IMU of six axes and no speed), gyro (a "
            "yaw rate and no speed)")
        ->type_name("KIND")
        ->check(CLI::IsMember({"wheels", "imu", "steering", "inertial", "gyro"}))
        ->capture_default_str()
        ->group("Robot");
    command.add_option("--speed", o.speed_mps, "Cruising speed; 0.5 unless told, a car's 5")
        ->type_name("M/S")
        ->check(between(0.01, 20.0))
        ->group("Robot");
    number("--turn-rate", o.turn_rate_degps, "DEG/S", 1.0, 360.0, "Largest turn rate");
    number("--odom-rate", o.params.odometry_rate_hz, "HZ", 1.0, 1000.0, "Odometry lines per second");
    number("--odom-scale-error", robot.odom_scale_error, "E", -0.5, 0.5, "Both wheels count this fraction too much");
    number("--odom-bias", robot.odom_bias, "E", -0.5, 0.5, "The right wheel counts this fraction more than the left");
    number("--slip", robot.slip, "S", 0.0, 0.2, "Random error of each wheel [m per square root of a metre]");
    number("--gyro-bias", o.gyro_bias_degps, "DEG/S", -10.0, 10.0, "Error of the IMU's rates, about each axis");
    number("--counts-per-turn", robot.counts_per_turn, "N", 4.0, 1e6, "Encoder resolution");
}

void add_lidar_options(CLI::App& command, SimOptions& o) {
    const auto option = [&](const char* name, auto& value, const char* unit, double low, double high,
                            const char* help) {
        command.add_option(name, value, help)
            ->type_name(unit)
            ->check(between(low, high))
            ->capture_default_str()
            ->group("Lidar");
    };
    command
        .add_option("--lidar", o.lidar,
                    "urg (unless told; with --config the first of its driver's that reaches [lidar] range_max_m): 682 "
                    "beams, 240 deg, 5.6 m, 10 Hz; lms: LMS200, 181 beams, 180 deg, 80 m, "
                    "37.5 Hz, no --capture; lms1xx: 541 beams, 270 deg, 20 m, 50 Hz; lms5xx: 381 beams, 190 deg, 80 m, "
                    "50 Hz; scan270: 1081 beams, 270 deg, 30 m, 40 Hz; velodyne: VLP-16, 10 Hz, and hdl32e, both "
                    "--capture only")
        ->type_name("MODEL")
        ->check(CLI::IsMember(std::vector<std::string>(std::begin(sim::kLidarNames), std::end(sim::kLidarNames))))
        ->group("Lidar");
    option("--scan-rate", o.scan_rate_hz, "HZ", 0.1, 100.0, "Scans per second, instead of the model's");
    option("--max-range", o.max_range_m, "M", 0.1, 200.0, "Reach, instead of the model's");
    option("--dropout", o.dropout, "P", 0.0, 1.0, "Probability that a beam reads 0, instead of the model's");
    option("--range-noise", o.range_noise, "FACTOR", 0.0, 100.0, "The model's range noise, times this");
    option("--lidar-x", o.lidar_x_m, "M", -1.0, 1.0, "Mounting, forward of the axle");
    option("--lidar-y", o.lidar_y_m, "M", -1.0, 1.0, "Mounting, to the left");
    option("--lidar-yaw", o.lidar_yaw_deg, "DEG", -180.0, 180.0, "Mounting, turned to the left");
}

void add_camera_options(CLI::App& command, SimOptions& o) {
    const std::string group = "Stereo camera";
    command
        .add_option("--stereo", o.stereo,
                    "Write pairs of pictures, as KITTI's odometry benchmark has them; the capture holds them, too. As "
                    "[stereo] of the configuration has the camera, or 640 x 360 pixels, 90 deg wide, 12 cm apart, 15 "
                    "Hz, 1 m above the ground")
        ->type_name("DIR")
        ->group(group);
    command
        .add_option("--blind", o.blind,
                    "The camera sees nothing of use from one second of the drive to another: dark (unless told), blur, "
                    "or bare, one plain surface; may be given several times")
        ->type_name("FROM:TO[:KIND]")
        ->group(group);
    command.add_flag("--plain", o.plain, "Surfaces without grain: edges are all that a camera sees")->group(group);
}

void add_drive_options(CLI::App& command, SimOptions& o) {
    const auto option = [&](const char* name, auto& value, const char* unit, double low, double high,
                            const char* help) {
        command.add_option(name, value, help)
            ->type_name(unit)
            ->check(between(low, high))
            ->capture_default_str()
            ->group("Drive");
    };
    option("--places", o.params.places, "N", 1, 1000, "Random places to visit before coming back to the start");
    option("--duration", o.params.duration_s, "S", 0.1, 1e6, "Repeat the tour until so many seconds are over");
    option("--distance", o.params.distance_m, "M", 0.1, 1e6, "Repeat the tour until so many metres are driven");
    command.add_option("--path", o.path, "Drive along the points of FILE instead: `x y` lines or a TUM trajectory")
        ->type_name("FILE")
        ->group("Drive");
}

void add_output_options(CLI::App& command, SimOptions& o) {
    command.add_option("--out", o.out, "Directory for the results; beside the capture, where one is written")
        ->type_name("DIR")
        ->capture_default_str()
        ->group("Output");
    command.add_option("--format", o.format, "Of the log: carmen, or dat (the URG's, one line a scan)")
        ->type_name("FORMAT")
        ->check(CLI::IsMember({"carmen", "dat"}))
        ->capture_default_str()
        ->group("Output");
    command
        .add_option("--capture", o.capture,
                    "Write a pcapng, too: the bytes of the lidar's port and of the base's CAN bus; stamps are UTC")
        ->type_name("FILE")
        ->group("Output");
    command.add_option("--seed", o.params.seed, "The same seed gives the same bytes")
        ->type_name("N")
        ->capture_default_str()
        ->group("Output");
}

}  // namespace

void add_sim(CLI::App& app) {
    auto options = std::make_shared<SimOptions>();
    CLI::App* command = app.add_subcommand("sim", "Simulate a robot with a lidar and write what it records");
    command->footer(
        "Writes into DIR: the log, truth.tum (true pose at each scan's first beam), world.pgm and world.yaml (true\n"
        "map) and config.toml (what a configuration must tell of this robot). With --capture the robot speaks bytes, "
        "as\n"
        "its sensors would: SCIP (urg, scan270), CoLa (lms1xx, lms5xx) or Velodyne packets, and CANopen drives;\n"
        "config.toml then names the sources. With --config the robot is that of your configuration: try it before you\n"
        "have the robot. A velodyne sees the world in three dimensions, with kerbs round which the robot drives; it "
        "has no "
        "log.\n"
        "On its uneven ground (--bumps) the robot pitches and rolls, and its map is that of the obstacles.\n"
        "\n"
        "Examples:\n"
        "  crspf sim --out office                      a URG through twelve places of an office\n"
        "  crspf sim --world corridor --lidar lms --odom-scale-error 0.02 --out corridor\n"
        "  crspf sim --world map.yaml --start 2,3,90 --people 5 --duration 300 --seed 7 --out crowded\n"
        "  crspf sim --world hall --lidar velodyne --duration 60 --capture hall/run.pcapng\n"
        "  crspf sim --world field --bumps 10 --lidar velodyne --odometer imu --capture field/run.pcapng\n"
        "  crspf sim --world hall --lidar lms1xx --stereo hall/pictures --blind 10:12 --duration 60 --out hall\n"
        "  crspf sim --config config/examples/bank_robot.toml --world hall --capture bank/run.pcapng --out bank\n"
        "  crspf replay bank/run.pcapng --out bank/replay && crspf eval ate bank/replay/trajectory.tum bank/truth.tum");
    add_world_options(*command, *options);
    add_robot_options(*command, *options);
    add_lidar_options(*command, *options);
    add_camera_options(*command, *options);
    add_drive_options(*command, *options);
    add_output_options(*command, *options);
    for (const char* told : {"--odometer", "--lidar-x", "--lidar-y", "--lidar-yaw"}) {
        command->get_option("--config")->excludes(command->get_option(told));
    }
    command->callback([options, command] {
        if (!options->capture.empty() && command->count("--out") == 0) {
            options->out = std::filesystem::path(options->capture).parent_path().string();
            options->out = options->out.empty() ? "." : options->out;
        }
        run(*options);
    });
}

}  // namespace crspf::cli
