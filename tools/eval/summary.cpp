#include "tools/eval/summary.hpp"

#include <algorithm>
#include <cmath>

namespace crspf::eval {
namespace {

double quantile(const std::vector<double>& sorted, double fraction) {
    const double place = fraction * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const std::size_t above = std::min(below + 1, sorted.size() - 1);
    return sorted[below] + (place - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

}  // namespace

Summary summarise(std::vector<double> values) {
    if (values.empty()) {
        return {};
    }
    std::sort(values.begin(), values.end());
    const auto n = static_cast<double>(values.size());
    double sum = 0.0;
    double sum_of_squares = 0.0;
    for (const double v : values) {
        sum += v;
        sum_of_squares += v * v;
    }
    const double mean = sum / n;
    double sum_of_deviations = 0.0;  // a second pass: mean(v^2) - mean^2 would cancel
    for (const double v : values) {
        sum_of_deviations += (v - mean) * (v - mean);
    }
    return {.count = values.size(),
            .mean = mean,
            .std = std::sqrt(sum_of_deviations / n),
            .rms = std::sqrt(sum_of_squares / n),
            .median = quantile(values, 0.5),
            .p95 = quantile(values, 0.95),
            .max = values.back()};
}

}  // namespace crspf::eval
