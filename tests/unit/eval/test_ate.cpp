#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "tools/eval/ate.hpp"

using namespace crspf;
using namespace crspf::eval;

namespace {

constexpr Pose2 kPlanted{.x_m = 4.0, .y_m = -7.0, .theta_rad = 2.8};

std::vector<TimedPose> curve() {
    std::vector<TimedPose> trajectory;
    Pose2 pose{.x_m = 1.0, .y_m = 2.0, .theta_rad = 0.3};
    for (int i = 0; i < 200; ++i) {
        trajectory.push_back({.stamp_s = 0.1 * i, .P_map_base = pose});
        pose = pose * Pose2{.x_m = 0.1, .y_m = 0.0, .theta_rad = i < 100 ? 0.02 : -0.03};
    }
    return trajectory;
}

std::vector<TimedPose> moved(const std::vector<TimedPose>& trajectory, const Pose2& by) {
    auto result = trajectory;
    for (TimedPose& pose : result) {
        pose.P_map_base = by * pose.P_map_base;
    }
    return result;
}

/// Straight on along x, a pose every second and metre.
std::vector<TimedPose> straight(int count) {
    std::vector<TimedPose> trajectory;
    trajectory.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        trajectory.push_back({.stamp_s = 1.0 * i, .P_map_base = {.x_m = 1.0 * i}});
    }
    return trajectory;
}

}  // namespace

TEST_CASE("The planted transform is found and leaves no error", "[eval][ate]") {
    const auto estimate = curve();
    const auto truth = moved(estimate, kPlanted);
    const Alignment alignment = GENERATE(Alignment::kBestFit, Alignment::kFirstPose);
    const auto report = absolute_trajectory_error(estimate, truth, {.alignment = alignment});
    REQUIRE(report);
    CHECK(report->P_truth_map.x_m == Approx(kPlanted.x_m));
    CHECK(report->P_truth_map.y_m == Approx(kPlanted.y_m));
    CHECK(report->P_truth_map.theta_rad == Approx(kPlanted.theta_rad));
    CHECK(report->position_m.count == 200);
    CHECK(report->unmatched == 0);
    CHECK(report->position_m.max < 1e-9);
    CHECK(report->heading_deg.max < 1e-9);
    CHECK(report->end.position_m < 1e-9);
}

TEST_CASE("The order of the true poses makes no difference", "[eval][ate]") {
    auto truth = moved(curve(), kPlanted);
    std::reverse(truth.begin(), truth.end());
    const auto report = absolute_trajectory_error(curve(), truth, {});
    REQUIRE(report);
    CHECK(report->position_m.count == 200);
    CHECK(report->position_m.max < 1e-9);
}

TEST_CASE("Best fit spreads a scale error evenly, the first pose keeps it for the end", "[eval][ate]") {
    // Five poses, each metre measured as 1.1 m: errors of 0, 0.1 ... 0.4 m from the first pose, -0.2 ... 0.2 m about
    // the middle.
    const auto truth = straight(5);
    auto estimate = truth;
    for (TimedPose& pose : estimate) {
        pose.P_map_base.x_m *= 1.1;
    }
    const auto fit = absolute_trajectory_error(estimate, truth, {});
    REQUIRE(fit);
    CHECK(fit->position_m.rms == Approx(std::sqrt(0.02)));
    CHECK(fit->position_m.mean == Approx(0.12));
    CHECK(fit->position_m.median == Approx(0.1));
    CHECK(fit->position_m.max == Approx(0.2));
    const auto first = absolute_trajectory_error(estimate, truth, {.alignment = Alignment::kFirstPose});
    REQUIRE(first);
    CHECK(first->position_m.mean == Approx(0.2));
    CHECK(first->position_m.max == Approx(0.4));
    CHECK(fit->end.position_m == Approx(0.4));
    CHECK(fit->end.along_m == Approx(0.4));
    CHECK(first->end.along_m == Approx(0.4));
}

TEST_CASE("The end error along an axis has a sign, is in the truth frame and sees no drift across", "[eval][ate]") {
    // The truth drives north. The estimate, in a frame of its own, falls 0.3 m short and slips 0.4 m to the left.
    const auto truth = moved(straight(11), {.x_m = 3.0, .y_m = 4.0, .theta_rad = kPi / 2.0});
    auto estimate = straight(11);
    estimate.back().P_map_base = {.x_m = 9.7, .y_m = 0.4, .theta_rad = radians(5.0)};
    const auto north = absolute_trajectory_error(estimate, truth, {.along = {.x = 0.0, .y = 1.0}});
    REQUIRE(north);
    CHECK(north->end.position_m == Approx(0.5));
    CHECK(north->end.along_m == Approx(-0.3));
    CHECK(north->end.heading_deg == Approx(5.0));
    const auto east = absolute_trajectory_error(estimate, truth, {.along = {.x = 1.0, .y = 0.0}});
    REQUIRE(east);
    CHECK(east->end.along_m == Approx(-0.4));
}

TEST_CASE("Heading errors are measured the short way round", "[eval][ate]") {
    auto truth = straight(3);
    auto estimate = truth;
    truth[1].P_map_base.theta_rad = radians(179.0);
    estimate[1].P_map_base.theta_rad = radians(-178.0);
    const auto report = absolute_trajectory_error(estimate, truth, {});
    REQUIRE(report);
    CHECK(report->heading_deg.max == Approx(3.0));
    CHECK(report->heading_deg.mean == Approx(1.0));
}

TEST_CASE("Poses without a truth near enough are left out and counted", "[eval][ate]") {
    const auto truth = straight(5);
    auto estimate = truth;
    estimate[1].stamp_s += 0.019;
    estimate[3].stamp_s += 0.021;
    const auto report = absolute_trajectory_error(estimate, truth, {});
    REQUIRE(report);
    CHECK(report->position_m.count == 4);
    CHECK(report->unmatched == 1);
    CHECK(absolute_trajectory_error(estimate, truth, {.max_gap_s = 0.03})->unmatched == 0);
    CHECK_FALSE(absolute_trajectory_error(moved(truth, {}), {}, {}));
    CHECK_FALSE(absolute_trajectory_error({}, truth, {}));
}

TEST_CASE("A robot that stood still is aligned at its first pose", "[eval][ate]") {
    const std::vector<TimedPose> estimate(3, {.stamp_s = 1.0, .P_map_base = {.x_m = 1.0}});
    const auto report = absolute_trajectory_error(estimate, moved(estimate, kPlanted), {});
    REQUIRE(report);
    CHECK(report->P_truth_map.theta_rad == Approx(kPlanted.theta_rad));
    CHECK(report->position_m.max < 1e-9);
    CHECK(report->heading_deg.max < 1e-9);
}
