#include "tools/crspf/sim_params.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>
#include <variant>

#include "core/base/trig.hpp"
#include "platform/files/fields.hpp"
#include "platform/files/input_error.hpp"
#include "platform/files/read_file.hpp"
#include "tools/sim/capture_writer.hpp"
#include "tools/sim/carried.hpp"
#include "tools/sim/lidar_model.hpp"

namespace crspf::cli {

namespace {

/// Lines of `x y`, `x y theta` or TUM; of the latter the position counts. Empty lines and # comments are skipped.
std::vector<sim::Point> read_path(const std::string& file) {
    constexpr std::size_t kBytesMax = std::size_t{1} << 26U;
    const std::string content = read_file(file, kBytesMax);
    std::vector<sim::Point> path;
    std::string_view rest = content;
    for (std::size_t line_number = 1; !rest.empty(); ++line_number) {
        const std::size_t end = rest.find('\n');
        const std::string_view line = rest.substr(0, end);
        rest.remove_prefix(end == rest.npos ? rest.size() : end + 1);
        Fields fields(line);
        if (fields.at_end() || line.starts_with('#')) {
            continue;
        }
        std::vector<double> values;
        double value = 0.0;
        while (values.size() < 8 && fields.number(value) && std::isfinite(value)) {
            values.push_back(value);
        }
        const bool tum = values.size() == 8;
        if (!fields.at_end() || (values.size() != 2 && values.size() != 3 && !tum)) {
            throw InputError(file + ":" + std::to_string(line_number) +
                             ": not a point of a path; give `x y` in metres, or lines of a TUM trajectory");
        }
        path.push_back(tum ? sim::Point{values[1], values[2]} : sim::Point{values[0], values[1]});
    }
    if (path.size() < 2) {
        throw InputError(file + ": a path needs two points or more");
    }
    return path;
}

/// What the protocols of captures can say.
void fit_to_capture(sim::LidarModel& lidar) {
    if (!lidar.spatial()) {
        // A sensor tells its speed in whole turns a minute, and sends a scan each turn.
        const double rpm = std::max(std::floor(60.0 * lidar.scan_rate_hz + 0.5), 1.0);
        lidar.scan_rate_hz = rpm / 60.0;
        lidar.revolution_s = 60.0 / rpm;
        return;
    }
    if (lidar.scan_rate_hz < 5.0 || lidar.scan_rate_hz > 20.0) {
        throw InputError("--scan-rate: a Velodyne turns 5 to 20 times a second");
    }
    if (lidar.range_max_m > 130.0) {
        throw InputError("--max-range: a Velodyne's packets count to 130 m; give less");
    }
    lidar.revolution_s = 1.0 / lidar.scan_rate_hz;
}

/// Unless told, the first that the source's driver understands and that reaches as far as the configuration believes
/// it.
sim::LidarModel model_for(const Config& config, const std::optional<std::string>& told) {
    const SourceConfig& source = *sim::carried(config).lidar;
    if (source.driver == SourceDriver::kLd06) {
        throw InputError("[source." + source.name +
                         "] driver: an LD06 is not simulated; give the driver of another lidar");
    }
    sim::LidarModel lidar;
    for (const char* name : sim::kLidarNames) {
        const sim::LidarModel model = sim::lidar_model(told.value_or(name));
        const bool fits =
            model.driver == source.driver && (!model.spatial() || model.velodyne == source.velodyne.model);
        if (fits && (lidar.name.empty() || lidar.range_max_m < config.slam.lidar.range_max_m)) {
            lidar = model;
        }
    }
    if (lidar.name.empty()) {
        throw InputError(told ? "--lidar " + *told + ": is not what [source." + source.name +
                                    "] listens to; leave --lidar out for one that is"
                              : "[source." + source.name +
                                    "] model: the simulated Velodynes are VLP-16 and HDL-32E; give one of them");
    }
    return lidar;
}

sim::LidarModel adapted(sim::LidarModel lidar, const SimOptions& options) {
    lidar.range_max_m = options.max_range_m.value_or(lidar.range_max_m);
    if (lidar.no_return_m > 0.0) {
        lidar.no_return_m = std::max(lidar.no_return_m, lidar.range_max_m);
    }
    lidar.scan_rate_hz = options.scan_rate_hz.value_or(lidar.scan_rate_hz);
    lidar.revolution_s = std::min(lidar.revolution_s, 1.0 / lidar.scan_rate_hz);
    lidar.dropout = options.dropout.value_or(lidar.dropout);
    lidar.noise_m *= options.range_noise;
    lidar.noise_fraction *= options.range_noise;
    if (!options.capture.empty()) {
        fit_to_capture(lidar);
    }
    return lidar;
}

sim::Odometer odometer_of(const SimOptions& options, const Config* config) {
    if (config != nullptr) {
        const SourceConfig* const base = sim::carried(*config).base;
        if (base == nullptr) {
            return sim::Odometer::kWheels;
        }
        const auto& odometer = base->can.odometer;
        return std::holds_alternative<ImuParams>(odometer)         ? sim::Odometer::kImu
               : std::holds_alternative<AckermannParams>(odometer) ? sim::Odometer::kSteering
                                                                   : sim::Odometer::kWheels;
    }
    return options.odometer == "imu"        ? sim::Odometer::kImu
           : options.odometer == "steering" ? sim::Odometer::kSteering
           : options.odometer == "inertial" ? sim::Odometer::kInertial
           : options.odometer == "gyro"     ? sim::Odometer::kGyro
                                            : sim::Odometer::kWheels;
}

sim::BlindSpell blind_spell_of(const std::string& text) {
    std::string spaced = text;
    std::replace(spaced.begin(), spaced.end(), ':', ' ');
    Fields fields(spaced);
    sim::BlindSpell spell;
    const bool times = fields.numbers(spell.from_s, spell.to_s) && spell.from_s >= 0.0 && spell.from_s < spell.to_s;
    const std::string_view kind = fields.word();
    const bool known = kind.empty() || kind == "dark" || kind == "blur" || kind == "bare";
    if (!times || !known || !fields.at_end()) {
        throw InputError("--blind " + text +
                         ": give FROM:TO in seconds of the drive, or FROM:TO:KIND, where KIND is dark, blur or bare");
    }
    spell.kind = kind == "blur"   ? sim::Blindness::kBlur
                 : kind == "bare" ? sim::Blindness::kBare
                                  : sim::Blindness::kDark;
    return spell;
}

/// The camera, where there is one.
std::optional<sim::StereoRigParams> stereo_of(const SimOptions& options, const Config* config) {
    if (options.stereo.empty() && (config == nullptr || config->stereo.device.empty())) {
        if (!options.blind.empty() || options.plain) {
            throw InputError("--blind, --plain: only a camera sees the difference; give --stereo DIR, too");
        }
        return std::nullopt;
    }
    StereoConfig usual;
    usual.height_px = 360;
    sim::StereoRigParams stereo = sim::stereo_of(config != nullptr ? config->stereo : usual);
    stereo.camera.grain = !options.plain;
    std::transform(options.blind.begin(), options.blind.end(), std::back_inserter(stereo.blind), blind_spell_of);
    return stereo;
}

}  // namespace

sim::SimulationParams params_of(const SimOptions& options, const Config* config) {
    sim::SimulationParams params = options.params;
    params.odometer = odometer_of(options, config);
    const bool steered = config != nullptr && params.odometer == sim::Odometer::kSteering;
    const std::string robot = options.robot.value_or(steered ? "ackermann" : "differential");
    if (robot == "car") {
        const sim::RobotParams& told = options.params.robot;
        params.robot = sim::car();
        params.robot.odom_scale_error = told.odom_scale_error;
        params.robot.odom_bias = told.odom_bias;
        params.robot.slip = told.slip;
        params.robot.counts_per_turn = told.counts_per_turn;
    } else if (robot == "ackermann") {
        params.robot.drive = sim::Drive::kAckermann;
    }
    params.robot.speed_mps = options.speed_mps.value_or(params.robot.speed_mps);
    params.robot.turn_rate_radps = radians(options.turn_rate_degps);
    params.gyro_bias_radps = radians(options.gyro_bias_degps);
    params.bumps_rad = radians(options.bumps_deg);
    params.lidar =
        config != nullptr ? model_for(*config, options.lidar) : sim::lidar_model(options.lidar.value_or("urg"));
    params.P_base_lidar = {
        .x_m = options.lidar_x_m, .y_m = options.lidar_y_m, .theta_rad = radians(options.lidar_yaw_deg)};
    if (config != nullptr) {
        sim::carry(*config, params);
        // The body reaches as far as what it carries.
        const Pose2& lidar = params.P_base_lidar;
        params.robot.radius_m = std::max(params.robot.radius_m, std::hypot(lidar.x_m, lidar.y_m));
    } else if (std::hypot(options.lidar_x_m, options.lidar_y_m) > params.robot.radius_m) {
        throw InputError("--lidar-x, --lidar-y: the lidar stands out of the robot, whose radius is " +
                         std::to_string(params.robot.radius_m) + " m; move it in");
    }
    params.lidar = adapted(params.lidar, options);
    params.stereo = stereo_of(options, config);
    if (params.stereo) {
        const CameraMounting& camera = params.stereo->camera.mounting;
        params.robot.radius_m = std::max(params.robot.radius_m, std::hypot(camera.x_m, camera.y_m));
    }
    if (!options.path.empty()) {
        params.path = read_path(options.path);
    }
    if (params.odometer == sim::Odometer::kSteering && params.robot.drive != sim::Drive::kAckermann) {
        throw InputError("a differential robot has no steering angle to tell; give --robot ackermann or car");
    }
    if (!options.capture.empty()) {
        params.start_us = sim::kCaptureStart_us + sim::kStandstill_us;
    }
    return params;
}

}  // namespace crspf::cli
