#include <catch2/catch.hpp>
#include <limits>

#include "tools/eval/stamp_index.hpp"

using crspf::TimedPose;
using crspf::eval::StampIndex;

namespace {

std::vector<TimedPose> with_stamps(const std::vector<double>& stamps) {
    std::vector<TimedPose> trajectory;
    trajectory.reserve(stamps.size());
    for (const double stamp_s : stamps) {
        trajectory.push_back({.stamp_s = stamp_s, .P_map_base = {}});
    }
    return trajectory;
}

}  // namespace

TEST_CASE("The nearest stamp is found although stamps run back", "[eval][stamps]") {
    const StampIndex index(with_stamps({10.0, 11.0, 10.5, 12.0, 11.25}));
    CHECK(index.nearest(10.0, 0.5) == 0U);
    CHECK(index.nearest(10.6, 0.5) == 2U);
    CHECK(index.nearest(11.2, 0.5) == 4U);
    CHECK(index.nearest(11.7, 0.5) == 3U);
}

TEST_CASE("Before the first and after the last stamp the gap decides", "[eval][stamps]") {
    const StampIndex index(with_stamps({10.0, 11.0}));
    CHECK(index.nearest(9.5, 0.5) == 0U);
    CHECK_FALSE(index.nearest(9.49, 0.5).has_value());
    CHECK(index.nearest(11.5, 0.5) == 1U);
    CHECK_FALSE(index.nearest(11.51, 0.5).has_value());
}

TEST_CASE("Of equal stamps the first in file order is taken, of equally near ones the earlier", "[eval][stamps]") {
    const StampIndex index(with_stamps({11.0, 10.0, 11.0, 10.0}));
    CHECK(index.nearest(10.0, 0.5) == 1U);
    CHECK(index.nearest(11.2, 0.5) == 0U);
    CHECK(index.nearest(10.5, 0.5) == 1U);
}

TEST_CASE("An empty trajectory and a stamp that is no number match nothing", "[eval][stamps]") {
    CHECK_FALSE(StampIndex({}).nearest(1.0, 1e9).has_value());
    CHECK_FALSE(StampIndex(with_stamps({1.0})).nearest(std::numeric_limits<double>::quiet_NaN(), 1e9).has_value());
}
