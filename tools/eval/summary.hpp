// What a report says about a set of errors.
#pragma once

#include <cstddef>
#include <vector>

namespace crspf::eval {

/// All in the unit of the values; all 0 where there are no values.
struct Summary {
    std::size_t count = 0;
    double mean = 0.0;
    double std = 0.0;  ///< of the population: divided by count
    double rms = 0.0;
    double median = 0.0;
    double p95 = 0.0;  ///< 95th percentile; between two values it is interpolated
    double max = 0.0;
};

/// `values` are finite.
[[nodiscard]] Summary summarise(std::vector<double> values);

}  // namespace crspf::eval
