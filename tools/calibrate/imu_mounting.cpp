#include "tools/calibrate/imu_mounting.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/base/trig.hpp"
#include "core/odometry/standing.hpp"

namespace crspf::calibrate {
namespace {

constexpr double kWindow_s = 0.5;          // engine and road shake faster
constexpr std::size_t kLevelWindows = 40;  // a slope, or a bias of the sensor, lasts longer than what driving does
constexpr double kSettled_s = 1.0;
constexpr std::size_t kWindowsMin = 20;

/// Of the plane.
struct Vector2 {
    double x = 0.0;
    double y = 0.0;
};

/// The means of half a second.
struct Window {
    double time_s = 0.0;
    double speed_mps = 0.0;
    double yaw_rate_radps = 0.0;
    Vector2 felt_mps2;
};

std::vector<Window> windows_of(const std::vector<ImuSample>& imu) {
    std::vector<Window> windows;
    Window sum;
    double count = 0.0;
    std::size_t begin = 0;
    for (std::size_t i = 0; i < imu.size(); ++i) {
        const ImuSample& sample = imu[i];
        if (!sample.inertial) {
            continue;
        }
        if ((sample.stamp - imu[begin].stamp).seconds() >= kWindow_s) {
            if (count > 0.0) {
                windows.push_back({.time_s = sum.time_s / count,
                                   .speed_mps = sum.speed_mps / count,
                                   .yaw_rate_radps = sum.yaw_rate_radps / count,
                                   .felt_mps2 = {sum.felt_mps2.x / count, sum.felt_mps2.y / count}});
            }
            sum = {};
            count = 0.0;
            begin = i;
        }
        sum.time_s += (sample.stamp - Stamp{}).seconds();
        sum.speed_mps += sample.speed_mps;
        sum.yaw_rate_radps += sample.yaw_rate_radps;
        sum.felt_mps2.x += sample.inertial->acceleration_x_mps2;
        sum.felt_mps2.y += sample.inertial->acceleration_y_mps2;
        count += 1.0;
    }
    return windows;
}

void take_out_mean(std::vector<Vector2>& values, std::size_t from, std::size_t to) {
    Vector2 mean;
    for (std::size_t i = from; i < to; ++i) {
        mean.x += values[i].x / static_cast<double>(to - from);
        mean.y += values[i].y / static_cast<double>(to - from);
    }
    for (std::size_t i = from; i < to; ++i) {
        values[i].x -= mean.x;
        values[i].y -= mean.y;
    }
}

}  // namespace

std::optional<Estimate> imu_yaw(const std::vector<ImuSample>& imu) {
    const std::vector<Window> windows = windows_of(imu);
    if (windows.size() < kWindowsMin + 2) {
        return std::nullopt;
    }
    std::vector<Vector2> driven;
    std::vector<Vector2> felt;
    for (std::size_t i = 1; i + 1 < windows.size(); ++i) {
        const double between_s = windows[i + 1].time_s - windows[i - 1].time_s;
        if (between_s < 3.0 * kWindow_s) {  // no gap
            driven.push_back({(windows[i + 1].speed_mps - windows[i - 1].speed_mps) / between_s,
                              windows[i].speed_mps * windows[i].yaw_rate_radps});
            felt.push_back(windows[i].felt_mps2);
        }
    }
    if (driven.size() < kWindowsMin) {
        return std::nullopt;
    }
    for (std::size_t from = 0; from < driven.size(); from += kLevelWindows) {
        const std::size_t to = std::min(from + kLevelWindows, driven.size());
        take_out_mean(driven, from, to);
        take_out_mean(felt, from, to);
    }
    // The rotation that lays what was felt on what was driven.
    double along = 0.0;
    double across = 0.0;
    double amount = 0.0;
    for (std::size_t i = 0; i < driven.size(); ++i) {
        along += felt[i].x * driven[i].x + felt[i].y * driven[i].y;
        across += felt[i].x * driven[i].y - felt[i].y * driven[i].x;
        amount += driven[i].x * driven[i].x + driven[i].y * driven[i].y;
    }
    const double yaw_rad = std::atan2(across, along);
    double rest = 0.0;
    for (std::size_t i = 0; i < driven.size(); ++i) {
        const double x = std::cos(yaw_rad) * felt[i].x - std::sin(yaw_rad) * felt[i].y;
        const double y = std::sin(yaw_rad) * felt[i].x + std::cos(yaw_rad) * felt[i].y;
        rest += std::pow(x - driven[i].x, 2) + std::pow(y - driven[i].y, 2);
    }
    const double each = rest / (2.0 * static_cast<double>(driven.size()));
    return Estimate{.value = yaw_rad, .stddev = amount > 0.0 ? std::sqrt(each / amount) : kPi};
}

std::optional<Estimate> standing_bias(const std::vector<ImuSample>& imu) {
    double sum = 0.0;
    double squares = 0.0;
    double count = 0.0;
    Stamp stood_since;
    for (std::size_t i = 0; i < imu.size(); ++i) {
        if (i == 0 || !Standing::is_still(imu[i].speed_mps)) {
            stood_since = imu[i].stamp;
        } else if ((imu[i].stamp - stood_since).seconds() > kSettled_s) {
            sum += imu[i].yaw_rate_radps;
            squares += imu[i].yaw_rate_radps * imu[i].yaw_rate_radps;
            count += 1.0;
        }
    }
    if (count < 2.0) {
        return std::nullopt;
    }
    const double mean = sum / count;
    return Estimate{.value = mean, .stddev = std::sqrt(std::max(squares / count - mean * mean, 0.0) / count)};
}

}  // namespace crspf::calibrate
