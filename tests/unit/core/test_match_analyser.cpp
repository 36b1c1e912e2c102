#include <catch2/catch.hpp>

#include "core/slam/match_analyser.hpp"

using namespace crspf;

namespace {

constexpr AnalyserParams kParams{.result_on = 700.0, .result_off = 500.0, .draw_on = 150.0, .draw_off = 75.0};

MatchAnalyser after(std::initializer_list<double> values) {
    MatchAnalyser analyser(kParams);
    for (const double M : values) {
        analyser.update(M);
    }
    return analyser;
}

}  // namespace

TEST_CASE("Result of (12): on above M_u, off below M_l, kept between") {
    CHECK_FALSE(MatchAnalyser(kParams).result());
    CHECK_FALSE(after({0.0}).result());
    CHECK_FALSE(after({699.0}).result());
    CHECK_FALSE(after({700.0}).result());  // not above
    CHECK(after({700.1}).result());
    CHECK(after({700.1, 600.0}).result());
    CHECK(after({700.1, 500.0}).result());  // not below
    CHECK_FALSE(after({700.1, 499.9}).result());
    CHECK_FALSE(after({700.1, 499.9, 600.0}).result());
    CHECK_FALSE(after({700.1, 499.9, 700.0}).result());
    CHECK(after({700.1, 499.9, 701.0}).result());
}

TEST_CASE("Draw of (13): on above M_u^d, off below M_l^d, kept between") {
    CHECK(after({200.0}).draw());
    CHECK(after({200.0, 100.0}).draw());
    CHECK(after({200.0, 75.0}).draw());  // not below
    CHECK_FALSE(after({200.0, 74.9}).draw());
    CHECK_FALSE(after({200.0, 74.9, 100.0}).draw());
    CHECK_FALSE(after({200.0, 74.9, 150.0}).draw());  // not above
    CHECK(after({200.0, 74.9, 150.1}).draw());
}

TEST_CASE("until a map has first matched fairly, every scan is drawn") {
    CHECK(MatchAnalyser(kParams).draw());
    CHECK(after({0.0}).draw());
    CHECK(after({0.0, 10.0, 0.0, 74.0}).draw());
    CHECK(after({0.0, 150.0, 0.0}).draw());  // 150 is not yet fair
    CHECK_FALSE(after({0.0, 150.1, 0.0}).draw());
    CHECK_FALSE(after({0.0, 150.1, 0.0, 10.0}).draw());
}

TEST_CASE("Result and Draw are independent") {
    const MatchAnalyser fair = after({200.0});
    CHECK(fair.draw());
    CHECK_FALSE(fair.result());
    const MatchAnalyser good = after({800.0, 100.0});
    CHECK(good.draw());
    CHECK_FALSE(good.result());
}
