#include "tools/experiments/report/axis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace crspf::experiments {

namespace {

constexpr double kLargest = 1e100;
constexpr double kSmallest = 1e-100;  // on a log axis
constexpr double kRoom = 0.03;        // of the span, at each end
constexpr double kNearZero = 0.3;     // of the far end: from there on the axis begins at 0
constexpr double kRounding = 1e-9;    // of logarithms and of spans

// A single value, or none, needs a span of its own.
bool is_span(const Extent& extent) {
    const double size = std::max(std::abs(extent.low), std::abs(extent.high));
    return extent.high - extent.low > std::max(kRounding * size, kSmallest);
}

Axis around(const Extent& extent) {
    if (extent.empty()) {
        return {};
    }
    const double half = std::abs(extent.low) > kSmallest ? 0.5 * std::abs(extent.low) : 1.0;
    return {.low = extent.low - half, .high = extent.high + half};
}

Axis linear_axis(const Extent& extent) {
    if (!is_span(extent)) {
        return around(extent);
    }
    Axis axis = close_axis_of(extent);
    if (extent.low >= 0.0 && extent.low < kNearZero * extent.high) {
        axis.low = 0.0;
    } else if (extent.high <= 0.0 && extent.high > kNearZero * extent.low) {
        axis.high = 0.0;
    }
    return axis;
}

Axis log_axis(const Extent& extent) {
    if (extent.empty()) {
        return {.low = 1.0, .high = 10.0, .log = true};
    }
    const double low = std::floor(std::log10(extent.low) + kRounding);
    const double high = std::max(std::ceil(std::log10(extent.high) - kRounding), low + 1.0);
    return {.low = std::pow(10.0, low), .high = std::pow(10.0, high), .log = true};
}

std::vector<Tick> linear_ticks(const Axis& axis, int most) {
    constexpr double kPlainLargest = 1e6;
    constexpr double kPlainSmallestStep = 1e-5;
    const double least = (axis.high - axis.low) / most;
    const double magnitude = std::pow(10.0, std::floor(std::log10(least)));
    double step = magnitude;
    for (const double factor : {2.0, 5.0, 10.0}) {
        if (step < least * (1.0 - kRounding)) {
            step = factor * magnitude;
        }
    }
    const double size = std::max(std::abs(axis.low), std::abs(axis.high));
    const bool plain = size < kPlainLargest && step >= kPlainSmallestStep;
    const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + kRounding)));
    const int digits = 1 + static_cast<int>(std::ceil(std::log10(size / step)));
    std::vector<Tick> ticks;
    const long first = std::lround(std::ceil(axis.low / step - kRounding));
    const long last = std::lround(std::floor(axis.high / step + kRounding));
    for (long k = first; k <= last; ++k) {
        const double value = static_cast<double>(k) * step;
        ticks.push_back(
            {value, plain ? fmt::format("{:.{}f}", value, decimals) : fmt::format("{:.{}g}", value, digits)});
    }
    return ticks;
}

std::string power_label(int power, int factor) {
    constexpr int kPlainPower = 5;
    if (power > kPlainPower || power < -kPlainPower) {
        return fmt::format("{}e{}", factor, power);
    }
    return fmt::format("{:.{}f}", factor * std::pow(10.0, power), std::max(0, -power));
}

std::vector<Tick> log_ticks(const Axis& axis, int most) {
    constexpr int kTicksADecade = 3;  // where there is room for them
    const int first = static_cast<int>(std::lround(std::log10(axis.low)));
    const int last = static_cast<int>(std::lround(std::log10(axis.high)));
    const int stride = std::max(1, (last - first + most - 1) / most);
    const bool between = (last - first) * kTicksADecade <= most;
    std::vector<Tick> ticks;
    for (int power = first; power <= last; power += stride) {
        for (const int factor : {1, 2, 5}) {
            if (factor == 1 || (between && power < last)) {
                ticks.push_back({factor * std::pow(10.0, power), power_label(power, factor)});
            }
        }
    }
    return ticks;
}

}  // namespace

void Extent::add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
}

double Axis::share_of(double value) const {
    return log ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
}

bool has_place(double value, bool log) {
    return std::isfinite(value) && std::abs(value) <= kLargest && (!log || value >= kSmallest);
}

Axis axis_of(const Extent& extent, bool log) {
    return log ? log_axis(extent) : linear_axis(extent);
}

Axis close_axis_of(const Extent& extent) {
    if (!is_span(extent)) {
        return around(extent);
    }
    const double room = kRoom * (extent.high - extent.low);
    return {.low = extent.low - room, .high = extent.high + room};
}

std::vector<Tick> ticks_of(const Axis& axis, int most) {
    return axis.log ? log_ticks(axis, most) : linear_ticks(axis, most);
}

}  // namespace crspf::experiments
