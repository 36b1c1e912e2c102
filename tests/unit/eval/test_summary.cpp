#include <catch2/catch.hpp>
#include <cmath>

#include "tools/eval/summary.hpp"

using crspf::eval::summarise;
using crspf::eval::Summary;

TEST_CASE("A summary of nothing is all zero", "[eval][summary]") {
    const Summary s = summarise({});
    CHECK(s.count == 0);
    CHECK(s.mean == 0.0);
    CHECK(s.std == 0.0);
    CHECK(s.max == 0.0);
}

TEST_CASE("A summary of one value is that value", "[eval][summary]") {
    const Summary s = summarise({2.5});
    CHECK(s.count == 1);
    CHECK(s.mean == 2.5);
    CHECK(s.std == 0.0);
    CHECK(s.rms == 2.5);
    CHECK(s.median == 2.5);
    CHECK(s.p95 == 2.5);
    CHECK(s.max == 2.5);
}

TEST_CASE("A summary does not depend on the order of the values", "[eval][summary]") {
    const Summary s = summarise({4.0, 1.0, 3.0, 2.0});
    CHECK(s.count == 4);
    CHECK(s.mean == 2.5);
    CHECK(s.std == Approx(std::sqrt(1.25)));
    CHECK(s.rms == Approx(std::sqrt(7.5)));
    CHECK(s.median == 2.5);
    CHECK(s.p95 == Approx(3.85));
    CHECK(s.max == 4.0);
}
