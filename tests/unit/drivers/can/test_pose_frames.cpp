#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <string>

#include "core/base/rng.hpp"
#include "core/base/trig.hpp"
#include "drivers/can/crc8.hpp"
#include "drivers/can/pose_frames.hpp"
#include "tests/unit/drivers/can/can_files.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

PoseReport example() {
    PoseReport out;
    out.P_map_base = {.x_m = 12.345, .y_m = -6.789, .theta_rad = -3.0001};
    out.speed_mps = 1.25;
    out.yaw_rate_radps = -0.5;
    out.covariance = {.xx = 0.04, .xy = -0.006, .yy = 0.01, .xt = 0.0004, .yt = 0.0001, .tt = 0.0001};
    out.M = 1234.5;
    out.age = {.ns = 23'400'000};
    out.matched = out.result = out.degenerate = true;
    out.resets = 7;
    return out;
}

std::optional<PoseReport> feed(PoseDecoder& decoder, const std::array<CanFrame, kPoseFrames>& frames) {
    std::optional<PoseReport> report;
    for (const CanFrame& frame : frames) {
        report = decoder.on_frame(frame);
    }
    return report;
}

}  // namespace

TEST_CASE("crc8: the published check value") {
    const std::array<std::uint8_t, 9> digits{'1', '2', '3', '4', '5', '6', '7', '8', '9'};
    CHECK(crc8_j1850(digits) == 0x4B);
    CHECK(crc8_j1850(std::span(digits).subspan(4), crc8_j1850(std::span(digits).first(4))) == 0x4B);
}

TEST_CASE("pose frames: what goes in comes out, to the last unit") {
    PoseEncoder encoder;
    PoseDecoder decoder;
    Rng rng(9);
    for (int i = 0; i < 1000; ++i) {
        PoseReport in = example();
        in.P_map_base = {
            .x_m = 8000 * rng.symmetric(), .y_m = 8000 * rng.symmetric(), .theta_rad = 9 * rng.symmetric()};
        in.speed_mps = 30 * rng.symmetric();
        in.lost = i % 2 == 0;
        auto frames = encoder.encode(in);
        REQUIRE(frames);
        std::reverse(frames->begin(), frames->begin() + static_cast<std::ptrdiff_t>(rng.next() % 6));
        const auto out = feed(decoder, *frames);
        REQUIRE(out);
        CHECK(std::abs(out->P_map_base.x_m - in.P_map_base.x_m) <= 0.00051);
        CHECK(std::abs(out->P_map_base.y_m - in.P_map_base.y_m) <= 0.00051);
        CHECK(std::abs(wrap_angle(out->P_map_base.theta_rad - in.P_map_base.theta_rad)) <= 0.000051);
        CHECK(std::abs(out->speed_mps - in.speed_mps) <= 0.00051);
        CHECK(out->yaw_rate_radps == Approx(in.yaw_rate_radps));
        CHECK(out->M == Approx(in.M));
        CHECK(out->age.ns == in.age.ns);
        CHECK(out->covariance.xx == Approx(in.covariance.xx));
        CHECK(out->covariance.xy == Approx(in.covariance.xy));
        CHECK(out->covariance.xt == Approx(in.covariance.xt));
        CHECK(out->covariance.yt == Approx(in.covariance.yt));
        CHECK(out->covariance.tt == Approx(in.covariance.tt));
        CHECK(out->lost == in.lost);
        CHECK(out->matched);
        CHECK(out->result);
        CHECK(out->degenerate);
        CHECK_FALSE(out->saturated);
        CHECK(out->resets == 7);
    }
    CHECK(decoder.counters().poses == 1000);
    CHECK(decoder.counters().incomplete == 0);
    CHECK(decoder.counters().missed == 0);
}

TEST_CASE("pose frames: config/crspf.dbc says the same") {
    const std::string text = dbc_text("crspf.dbc");
    PoseEncoder encoder;
    encoder.encode(example());
    const auto frames = encoder.encode(example());
    REQUIRE(frames);
    const auto value = [&](std::size_t frame, const char* message, const char* signal) {
        return value_in(signal_of(text, message, signal), (*frames)[frame]).value();
    };
    CHECK(value(0, "PosePosition", "X") == Approx(12.345));
    CHECK(value(0, "PosePosition", "Y") == Approx(-6.789));
    CHECK(value(0, "PosePosition", "PositionAlive") == 1.0);
    CHECK(value(1, "PoseMotion", "Heading") == Approx(-3.0001));
    CHECK(value(1, "PoseMotion", "Speed") == Approx(1.25));
    CHECK(value(1, "PoseMotion", "YawRate") == Approx(-0.5));
    CHECK(value(2, "PoseQuality", "Match") == Approx(1234.5));
    CHECK(value(2, "PoseQuality", "Age") == Approx(0.0234));
    CHECK(value(2, "PoseQuality", "Matched") == 1.0);
    CHECK(value(2, "PoseQuality", "Result") == 1.0);
    CHECK(value(2, "PoseQuality", "Degenerate") == 1.0);
    CHECK(value(2, "PoseQuality", "Lost") == 0.0);
    CHECK(value(2, "PoseQuality", "Saturated") == 0.0);
    CHECK(value(2, "PoseQuality", "Resets") == 7.0);
    CHECK(value(3, "PoseDeviation", "DeviationX") == Approx(0.2));
    CHECK(value(3, "PoseDeviation", "DeviationY") == Approx(0.1));
    CHECK(value(3, "PoseDeviation", "DeviationHeading") == Approx(0.01));
    CHECK(value(4, "PoseCorrelation", "CorrelationXY") == Approx(-0.3));
    CHECK(value(4, "PoseCorrelation", "CorrelationXHeading") == Approx(0.2));
    CHECK(value(4, "PoseCorrelation", "CorrelationYHeading") == Approx(0.1));
    CHECK(value(4, "PoseCorrelation", "CorrelationAlive") == 1.0);
    // A vector for other people's decoders.
    CHECK((*frames)[0] == make_frame(0x780, {0x39, 0x30, 0x00, 0x7B, 0xE5, 0xFF, 0x01, (*frames)[0].data[7]}));
    const std::array<std::uint8_t, 9> covered{0x80, 0x07, 0x39, 0x30, 0x00, 0x7B, 0xE5, 0xFF, 0x01};
    CHECK((*frames)[0].data[7] == crc8_j1850(covered));
}

TEST_CASE("pose frames: damage, loss and strangers are seen") {
    PoseEncoder encoder;
    PoseDecoder decoder;
    const auto first = encoder.encode(example());
    const auto second = encoder.encode(example());
    const auto third = encoder.encode(example());
    std::uint64_t bad = 0;
    for (unsigned bit = 0; bit < 64; ++bit) {  // any single bit
        CanFrame frame = (*first)[2];
        frame.data[bit / 8] = static_cast<std::uint8_t>(frame.data[bit / 8] ^ (1U << (bit % 8)));
        CHECK_FALSE(decoder.on_frame(frame));
        CHECK(decoder.counters().bad_crc == ++bad);
    }
    CanFrame moved = (*first)[3];  // under another frame's id
    moved.id = kPoseBaseId + 4;
    CHECK_FALSE(decoder.on_frame(moved));
    CHECK(decoder.counters().bad_crc == ++bad);
    CHECK(feed(decoder, *first));
    decoder.on_frame((*second)[0]);
    CHECK(feed(decoder, *third));
    CHECK(decoder.counters().incomplete == 1);
    CHECK(decoder.counters().missed == 0);
    encoder.encode(example());
    encoder.encode(example());
    CHECK(feed(decoder, *encoder.encode(example())));
    CHECK(decoder.counters().missed == 2);
    CHECK_FALSE(decoder.on_frame(make_frame(0x77F, {5})));
    CHECK_FALSE(decoder.on_frame(make_frame(0x785, {5})));
    CHECK(decoder.counters().bad_crc == bad);
}

TEST_CASE("pose frames: what has no number is not sent, what does not fit is said") {
    PoseEncoder encoder;
    for (double PoseReport::*member : {&PoseReport::speed_mps, &PoseReport::yaw_rate_radps, &PoseReport::M}) {
        PoseReport report = example();
        report.*member = std::numeric_limits<double>::quiet_NaN();
        CHECK_FALSE(encoder.encode(report));
    }
    PoseReport report = example();
    report.covariance.xt = std::numeric_limits<double>::infinity();
    CHECK_FALSE(encoder.encode(report));

    PoseDecoder decoder;
    report = example();
    report.P_map_base.x_m = 9000;
    report.covariance = {.xx = 1e6, .xy = 0, .yy = -1, .xt = 0, .yt = 0, .tt = 0};
    report.age = {.ns = 60'000'000'000};
    const auto out = feed(decoder, *encoder.encode(report));
    REQUIRE(out);
    CHECK(out->saturated);
    CHECK(out->P_map_base.x_m == Approx(8388.607));
    CHECK(out->covariance.xx == Approx(6.5535 * 6.5535));
    CHECK(out->covariance.yy == 0.0);
    CHECK(out->age.seconds() == Approx(6.5535));
}
