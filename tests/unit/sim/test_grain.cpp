#include <catch2/catch.hpp>
#include <cmath>

#include "tools/sim/grain.hpp"

namespace crspf {

namespace {

/// How samples a step apart vary, and how much they have in common.
struct Statistics {
    double deviation = 0.0;
    double correlation = 0.0;
};

double at(const sim::Grain& grain, sim::Point p, double px_per_m) {
    sim::Grain::Level line(grain);
    line.lead(p, {1.0, 0.0});
    line.ask(0.0, px_per_m);
    return static_cast<double>(line.told()[0]);
}

Statistics along_a_line(const sim::Grain& grain, double pixel_m, int samples) {
    sim::Grain::Level line(grain);
    line.lead({100.0, 50.0}, {0.8, 0.6});
    double sum = 0.0;
    double squares = 0.0;
    double products = 0.0;
    double before = 0.0;
    for (int i = 0; i < samples; ++i) {
        line.ask(pixel_m * i, 1.0 / pixel_m);
    }
    for (const float told : line.told()) {
        const auto value = static_cast<double>(told);
        sum += value;
        squares += value * value;
        products += value * before;
        before = value;
    }
    const double mean = sum / samples;
    const double variance = squares / samples - mean * mean;
    return {std::sqrt(variance), (products / samples - mean * mean) / variance};
}

}  // namespace

TEST_CASE("grain: strong where all of it is seen, and never finer than pixels at any distance") {
    const sim::Grain grain(1);
    const Statistics near = along_a_line(grain, 0.003, 20000);
    CHECK(near.deviation > 0.6);
    CHECK(near.deviation < 1.4);
    for (const double pixel_m : {0.003, 0.01, 0.03, 0.1, 0.3}) {
        CAPTURE(pixel_m);
        const Statistics seen = along_a_line(grain, pixel_m, 5000);
        CHECK(seen.deviation > 0.25);
        CHECK(seen.correlation > 0.75);
    }
    CHECK(at(grain, {3.0, 4.0}, 0.1) == 0.0);
    CHECK(at(grain, {3.0, 4.0}, 0.0) == 0.0);
}

TEST_CASE("grain: upright lines side by side show one pattern, which is as smooth across them as along") {
    const sim::Grain grain(1);
    sim::Grain::Upright here(grain);
    sim::Grain::Upright beside(grain);
    here.stand_at({7.0, -3.0}, 100.0, -0.5, 2.5);
    beside.stand_at({7.0005, -3.0}, 100.0, -0.5, 2.5);
    double across = 0.0;
    double along = 0.0;
    double squares = 0.0;
    for (int i = 0; i <= 2999; ++i) {
        const double height_m = -0.5 + 0.001 * i;
        squares += here.at(height_m) * here.at(height_m);
        across = std::max(across, std::abs(here.at(height_m) - beside.at(height_m)));
        along = std::max(along, std::abs(here.at(height_m) - here.at(std::min(height_m + 0.0005, 2.5))));
    }
    CHECK(squares / 3000.0 > 0.3);
    CHECK(across > 0.0);
    CHECK(across < 0.1);
    CHECK(along < 0.1);
}

TEST_CASE("grain: lines that cross show the same where they do") {
    const sim::Grain grain(1);
    sim::Grain::Level line(grain);
    line.lead({20.0, 5.0}, {0.8, 0.6});
    for (const double way_m : {0.0, 1.5, 30.0}) {
        line.clear();
        line.ask(way_m, 100.0);
        CHECK(static_cast<double>(line.told()[0]) ==
              Approx(at(grain, {20.0 + 0.8 * way_m, 5.0 + 0.6 * way_m}, 100.0)).margin(1e-5));
    }
}

TEST_CASE("grain: the same for the same seed only") {
    CHECK(at(sim::Grain(3), {1.0, 2.0}, 100.0) == at(sim::Grain(3), {1.0, 2.0}, 100.0));
    CHECK(at(sim::Grain(3), {1.0, 2.0}, 100.0) != at(sim::Grain(4), {1.0, 2.0}, 100.0));
}

}  // namespace crspf
