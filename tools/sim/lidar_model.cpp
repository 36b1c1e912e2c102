#include "tools/sim/lidar_model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/trig.hpp"
#include "platform/files/input_error.hpp"

namespace crspf::sim {
namespace {

int to_mm(double metres) {
    return static_cast<int>(std::floor(metres * 1000.0 + 0.5));
}

}  // namespace

double LidarModel::time_per_beam_s() const {
    return revolution_s * increment_rad / (2.0 * kPi);
}

LidarModel lidar_model(const std::string& name) {
    if (name == "urg") {
        return {.name = name,
                .beams = 682,  // steps 44 to 725 of 1024; step 384 looks forward
                .angle_min_rad = (44 - 384) * 2.0 * kPi / 1024.0,
                .increment_rad = 2.0 * kPi / 1024.0,
                .revolution_s = 0.1,
                .scan_rate_hz = 10.0,
                .range_min_m = 0.02,
                .range_max_m = 5.6,
                .no_return_m = 0.0,
                .noise_m = 0.010,
                .noise_fraction = 0.01,
                .dropout = 0.002};
    }
    if (name == "lms") {
        return {.name = name,
                .driver = SourceDriver::kLms2xx,
                .beams = 181,
                .angle_min_rad = -kPi / 2.0,
                .increment_rad = kPi / 180.0,
                .revolution_s = 1.0 / 75.0,
                .scan_rate_hz = 37.5,
                .range_min_m = 0.05,
                .range_max_m = 80.0,
                .no_return_m = 81.83,
                .noise_m = 0.010,
                .noise_fraction = 0.0,
                .dropout = 0.001};
    }
    if (name == "lms1xx") {
        return {.name = name,
                .driver = SourceDriver::kSick,
                .beams = 541,
                .angle_min_rad = -kPi * 270.0 / 360.0,
                .increment_rad = kPi / 360.0,
                .revolution_s = 0.02,
                .scan_rate_hz = 50.0,
                .range_min_m = 0.5,
                .range_max_m = 20.0,
                .no_return_m = 20.0,
                .noise_m = 0.012,
                .noise_fraction = 0.0,
                .dropout = 0.001};
    }
    if (name == "lms5xx") {
        return {.name = name,
                .driver = SourceDriver::kSick,
                .beams = 381,
                .angle_min_rad = -kPi * 190.0 / 360.0,
                .increment_rad = kPi / 360.0,
                .revolution_s = 0.02,
                .scan_rate_hz = 50.0,
                .range_min_m = 0.7,
                .range_max_m = 80.0,
                .no_return_m = 80.0,
                .noise_m = 0.010,
                .noise_fraction = 0.0,
                .dropout = 0.001};
    }
    if (name == "scan270") {
        return {.name = name,
                .beams = 1081,
                .angle_min_rad = -kPi * 540.0 / 720.0,
                .increment_rad = kPi / 720.0,
                .revolution_s = 0.025,
                .scan_rate_hz = 40.0,
                .range_min_m = 0.06,
                .range_max_m = 30.0,
                .no_return_m = 65.533,
                .noise_m = 0.012,
                .noise_fraction = 0.0,
                .dropout = 0.001};
    }
    if (name == "velodyne" || name == "hdl32e") {
        return {.name = name,
                .driver = SourceDriver::kVelodyne,
                .velodyne = name == "hdl32e" ? VelodyneModel::kHdl32e : VelodyneModel::kVlp16,
                .beams = 1800,
                .angle_min_rad = -kPi,
                .increment_rad = 2.0 * kPi / 1800.0,
                .revolution_s = 0.1,
                .scan_rate_hz = 10.0,
                .range_min_m = 0.5,
                .range_max_m = name == "hdl32e" ? 70.0 : 100.0,
                .no_return_m = 0.0,
                .noise_m = 0.02,
                .noise_fraction = 0.0,
                .dropout = 0.001};
    }
    throw InputError("--lidar " + name + ": no such lidar; give urg, lms, lms1xx, lms5xx, scan270, velodyne or hdl32e");
}

LidarModel all_round_lidar(std::uint32_t beams) {
    return {.name = "all round",
            .beams = beams,
            .angle_min_rad = -kPi,
            .increment_rad = 2.0 * kPi / beams,
            .revolution_s = 0.0,
            .scan_rate_hz = 10.0,
            .range_min_m = 0.05,
            .range_max_m = 10.0,
            .no_return_m = 0.0,
            .noise_m = 0.01,
            .noise_fraction = 0.0,
            .dropout = 0.0};
}

Lidar::Lidar(LidarModel model, std::uint64_t seed) : model_(std::move(model)), random_(seed, RandomStream::kLidar) {}

int Lidar::read_mm(const World& world, const Movers& movers, const Pose2& P_world_lidar, std::uint32_t beam) {
    const Point origin{P_world_lidar.x_m, P_world_lidar.y_m};
    const SinCos direction = sin_cos(P_world_lidar.theta_rad + (model_.angle_min_rad + beam * model_.increment_rad));
    double range_m = world.cast(origin, direction, model_.range_max_m);
    for (const Circle& leg : movers.legs) {
        range_m = std::min(range_m, cast_on_circle(origin, direction, leg));
    }
    for (const Box& car : movers.cars) {
        const Part part = part_over(origin, direction, car);
        range_m = part.empty() ? range_m : std::min(range_m, part.from_m);
    }
    // Drawn for every beam, so that a person in view does not change the noise of the others.
    const bool dropped = random_.uniform() < model_.dropout;
    const double noise = random_.normal();
    if (!(range_m <= model_.range_max_m)) {
        return to_mm(model_.no_return_m);
    }
    range_m += noise * std::max(model_.noise_m, model_.noise_fraction * range_m);
    if (dropped || range_m < model_.range_min_m) {
        return 0;
    }
    return range_m < model_.range_max_m ? to_mm(range_m) : to_mm(model_.no_return_m);
}

}  // namespace crspf::sim
