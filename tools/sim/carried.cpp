#include "tools/sim/carried.hpp"

#include <cmath>
#include <string>
#include <variant>

#include "core/base/trig.hpp"
#include "platform/files/input_error.hpp"
#include "platform/service/stereo_calibration.hpp"

namespace crspf::sim {
namespace {

void check_mounting(const LidarParams& lidar, const ObstacleParams& obstacles) {
    const double tilt_rad = std::abs(obstacles.lidar_roll_rad) + std::abs(obstacles.lidar_pitch_rad);
    if (lidar.mount_inverted || tilt_rad > 0.0) {
        throw InputError(
            "[lidar] mount_inverted, [obstacles] lidar_roll_deg, lidar_pitch_deg: the simulated lidars "
            "stand upright; leave them out to simulate");
    }
    if (std::abs(lidar.stamp_offset_s) > 0.0) {
        throw InputError("[lidar] stamp_offset_s: the simulated lidars tell their time; leave it out to simulate");
    }
}

void check_velodyne(const SourceConfig& source) {
    if (!source.velodyne_calibration.empty()) {
        throw InputError("[source." + source.name +
                         "] calibration: the simulated Velodyne is as its data sheet; leave it out to simulate");
    }
    if (std::abs(source.velodyne.cut_rad - kPi) > 1e-9) {
        throw InputError("[source." + source.name +
                         "] cut_deg: the simulated Velodyne's revolutions begin behind; leave it out to simulate");
    }
}

/// As the source sets the sensor up.
void set_up(const SourceConfig& source, LidarModel& lidar) {
    if (source.sick_frequency_hz > 0.0) {
        lidar.scan_rate_hz = source.sick_frequency_hz;
        lidar.revolution_s = 1.0 / source.sick_frequency_hz;
    }
    if (source.sick_resolution_rad > 0.0) {
        const double view_rad = (lidar.beams - 1) * lidar.increment_rad;
        lidar.increment_rad = source.sick_resolution_rad;
        lidar.beams = static_cast<std::uint32_t>(std::floor(view_rad / lidar.increment_rad + 0.5)) + 1;
    }
}

/// The usual one where none is told.
RectifiedCamera camera_of(const StereoConfig& config) {
    const int width = static_cast<int>(config.width_px);
    const int height = static_cast<int>(config.height_px);
    if (config.calibration.empty() && config.calibration_text.empty()) {
        return usual_camera(width, height);
    }
    const std::string name = config.calibration.empty() ? "[stereo] calibration_text" : config.calibration;
    const StereoCalibration calibration = config.calibration.empty()
                                              ? parse_stereo_calibration(config.calibration_text, name)
                                              : read_stereo_calibration(config.calibration);
    if (!calibration.rectified) {
        throw InputError(name +
                         ": is of cameras with lenses' errors, and simulated ones have none; give the calibration of a "
                         "rectified pair, or none");
    }
    return {.width = width,
            .height = height,
            .focal_px = calibration.left.fx_px,
            .cx_px = calibration.left.cx_px,
            .cy_px = calibration.left.cy_px,
            .baseline_m = -calibration.T_m[0]};
}

}  // namespace

Carried carried(const Config& config) {
    Carried out{nullptr, nullptr};
    for (const SourceConfig& source : config.sources) {
        if (!source.record_only) {
            if (is_lidar(source.driver)) {
                out.lidar = &source;
            } else if (source.driver == SourceDriver::kCan) {
                out.base = &source;
            }
        }
    }
    if (out.lidar == nullptr || (out.base == nullptr && config.stereo.device.empty())) {
        throw InputError(
            "--config: the simulated robot has a lidar and a CAN bus, or a stereo camera in place of the bus; give a "
            "file with a [source.NAME] for each, or with [stereo] device");
    }
    return out;
}

void carry(const Config& config, SimulationParams& params) {
    const Carried sources = carried(config);
    check_mounting(config.slam.lidar, config.slam.obstacles);
    if (sources.lidar->driver == SourceDriver::kVelodyne) {
        check_velodyne(*sources.lidar);
    }
    if (sources.lidar->driver == SourceDriver::kSick) {
        set_up(*sources.lidar, params.lidar);
    }
    params.P_base_lidar = config.slam.lidar.P_base_lidar;
    params.robot.lidar_height_m = config.slam.obstacles.lidar_height_m;
    params.robot.height_m = config.slam.obstacles.vehicle_height_m;
    if (sources.base == nullptr) {
        return;
    }
    if (std::holds_alternative<WheelParams>(sources.base->can.odometer)) {
        params.robot.wheel_span_m = config.slam.odometry.wheel_span_m;
    }
    if (std::holds_alternative<AckermannParams>(sources.base->can.odometer)) {
        params.robot.wheel_base_m = config.slam.odometry.wheel_base_m;
    }
}

StereoRigParams stereo_of(const StereoConfig& config) {
    return {.camera = {.camera = camera_of(config), .mounting = config.odometry.mounting},
            .rate_hz = config.rate_hz,
            .blind = {}};
}

}  // namespace crspf::sim
