#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <string>

#include "core/base/rng.hpp"
#include "drivers/can/canopen.hpp"
#include "drivers/can/motion_decoders.hpp"
#include "drivers/can/wheel_decoder.hpp"
#include "tests/unit/drivers/can/can_files.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

constexpr std::int64_t kMs = 1'000'000;

/// Both wheels in one frame, left from bit 0, right from bit 32, with an alive counter in bits 28 to 31 and a validity
/// bit 27.
struct Bench {
    explicit Bench(std::uint8_t width, ByteOrder order = ByteOrder::kIntel) {
        const auto start = [&](unsigned bit) {
            return static_cast<std::uint16_t>(order == ByteOrder::kIntel ? bit : bit + 7);
        };
        left.layout = {.start_bit = start(0), .length = width, .order = order};
        right.layout = {.start_bit = start(32), .length = width, .order = order};
        left.id = right.id = 0x311;
    }
    CanFrame frame(std::uint64_t l, std::uint64_t r) const {
        CanFrame out{.id = 0x311, .length = 8};
        insert_bits(left.layout, out.data, l);
        insert_bits(right.layout, out.data, r);
        return out;
    }
    WheelParams params(double scale) const {
        WheelParams out;
        out.left.signal = {.signal = left, .scale = scale};
        out.right.signal = {.signal = right, .scale = scale};
        return out;
    }

    FrameSignal left;
    FrameSignal right;
};

FrameSignal bits(std::uint32_t id, std::uint16_t start, std::uint8_t length) {
    FrameSignal out;
    out.id = id;
    out.layout = {.start_bit = start, .length = length};
    return out;
}

}  // namespace

TEST_CASE("counted: the short way round, both ways, any modulus") {
    CHECK(counted(254, 3, 256) == 5);
    CHECK(counted(3, 254, 256) == -5);
    CHECK(counted(999, 2, 1001) == 4);
    CHECK(counted(2, 999, 1001) == -4);
    CHECK(counted(0, 128, 256) == -128);
    CHECK(counted(0, 127, 256) == 127);
    CHECK(counted(0, 0xFFFFFFFFFFFFFFFF, 0) == -1);
    CHECK(counted(0xFFFFFFFFFFFFFFFF, 1, 0) == 2);
    Rng rng(3);
    std::uint64_t wrong = 0;
    for (int i = 0; i < 200000; ++i) {
        const std::uint64_t modulus = 2 + rng.next() % 100000;
        const std::uint64_t before = rng.next() % modulus;
        const std::int64_t low = -static_cast<std::int64_t>(modulus / 2);
        const std::int64_t step = low + static_cast<std::int64_t>(rng.next() % modulus);
        const auto signed_modulus = static_cast<std::int64_t>(modulus);
        const std::int64_t after = (static_cast<std::int64_t>(before) + step + signed_modulus) % signed_modulus;
        wrong += counted(before, static_cast<std::uint64_t>(after), modulus) == step ? 0U : 1U;
    }
    CHECK(wrong == 0);
}

TEST_CASE("wheels: a counter of any width that goes round in either direction loses no way") {
    Rng rng(5);
    for (const ByteOrder order : {ByteOrder::kIntel, ByteOrder::kMotorola}) {
        for (std::uint8_t width = 10; width <= 27; ++width) {
            CAPTURE(width);
            const Bench bench(width, order);
            const double scale = 0.01;
            WheelDecoder decoder(bench.params(scale));
            const std::uint64_t mask = (std::uint64_t{1} << width) - 1;
            std::int64_t left = 0;
            std::int64_t right = 0;
            double left_m = 0.0;
            double right_m = 0.0;
            const std::int64_t laps = width <= 14 ? 3 * static_cast<std::int64_t>(mask + 1) : 1000;
            Stamp now;
            for (int leg = 0; leg < 2; ++leg) {  // there and, further, back
                for (std::int64_t moved = 0; moved < laps * (leg + 1);) {
                    const auto step = static_cast<std::int64_t>(rng.next() % 40);
                    moved += step + 1;
                    left += leg == 0 ? step : -step;
                    right += leg == 0 ? step + 1 : -step - 1;
                    now = now + Duration{100 * kMs};
                    const auto sample = decoder.on_frame(
                        bench.frame(static_cast<std::uint64_t>(left) & mask, static_cast<std::uint64_t>(right) & mask),
                        now);
                    if (sample) {
                        left_m += sample->left_m;
                        right_m += sample->right_m;
                    } else if (moved == step + 1 && leg == 0) {  // the first frame sets the counters' beginning
                        left = right = 0;
                        decoder = WheelDecoder(bench.params(scale));
                        decoder.on_frame(bench.frame(0, 0), now);
                    }
                }
            }
            CHECK(left_m == Approx(scale * static_cast<double>(left)).margin(1e-6));
            CHECK(right_m == Approx(scale * static_cast<double>(right)).margin(1e-6));
            CHECK(decoder.counters().jumps == 0);
            CHECK(decoder.counters().restarts == 0);
        }
    }
}

TEST_CASE("wheels: frames of two drives are paired, and a lost one loses no way") {
    const std::string text = dbc_text("dbc/canopen_402.dbc");
    WheelParams params;
    params.left.signal = {.signal = signal_of(text, "LeftPosition", "LeftPositionActual"), .scale = 0.001};
    // The right motor is mounted the other way round.
    params.right.signal = {.signal = signal_of(text, "RightPosition", "RightPositionActual"), .scale = -0.001};
    WheelDecoder decoder(params);
    const auto feed = [&](std::uint32_t id, std::int32_t counts, std::int64_t ms) {
        CanFrame frame{.id = id, .length = 6};
        insert_bits(params.left.signal.signal.layout, frame.data, static_cast<std::uint32_t>(counts));
        return decoder.on_frame(frame, Stamp{ms * kMs});
    };
    CHECK_FALSE(feed(0x381, 0x7FFFFFFF, 0));
    CHECK_FALSE(feed(0x382, 10, 1));
    CHECK_FALSE(feed(0x381, -0x7FFFFFFF - 1 + 9, 20));  // round 2^31: ten counts on
    const auto first = feed(0x382, 0, 21);
    REQUIRE(first);
    CHECK(first->left_m == Approx(0.010));
    CHECK(first->right_m == Approx(0.010));
    CHECK(first->stamp.ns == 21 * kMs);
    CHECK_FALSE(feed(0x381, -0x7FFFFFFF - 1 + 19, 40));  // the right one's at 41 is lost
    CHECK_FALSE(feed(0x381, -0x7FFFFFFF - 1 + 29, 60));
    const auto second = feed(0x382, -20, 61);
    REQUIRE(second);
    CHECK(second->left_m == Approx(0.020));
    CHECK(second->right_m == Approx(0.020));
    CHECK(decoder.counters().unpaired == 1);
    CHECK_FALSE(feed(0x381, -0x7FFFFFFF - 1 + 39, 80));
    CHECK_FALSE(feed(0x382, -30, 99));  // too far apart: waits for the left one's next
    const auto third = feed(0x381, -0x7FFFFFFF - 1 + 49, 100);
    REQUIRE(third);
    CHECK(third->left_m == Approx(0.020));
    CHECK(third->right_m == Approx(0.010));
    CHECK(decoder.counters().samples == 3);
    CHECK(decoder.left_counters().frames == 6);
    // The left drive is reset: the right one's way of that time, told before or after, would be a turn.
    CHECK_FALSE(feed(0x381, 0, 120));
    CHECK_FALSE(feed(0x382, -60, 121));
    CHECK_FALSE(feed(0x381, 10, 140));
    const auto fourth = feed(0x382, -70, 141);
    REQUIRE(fourth);
    CHECK(fourth->left_m == Approx(0.010));
    CHECK(fourth->right_m == Approx(0.010));
    CHECK_FALSE(feed(0x382, -90, 160));
    CHECK_FALSE(feed(0x381, 0x40000000, 161));
    CHECK_FALSE(feed(0x382, -100, 180));
    const auto fifth = feed(0x381, 0x4000000A, 181);
    REQUIRE(fifth);
    CHECK(fifth->left_m == Approx(0.010));
    CHECK(fifth->right_m == Approx(0.010));
    CHECK(decoder.counters().jumps == 2);
}

TEST_CASE("wheels: a drive that was reset is a jump, a long silence of a small counter a restart") {
    const Bench wide(27);
    WheelDecoder decoder(wide.params(0.001));
    CHECK_FALSE(decoder.on_frame(wide.frame(100000, 100000), Stamp{0}));
    CHECK(decoder.on_frame(wide.frame(100010, 100010), Stamp{20 * kMs}));
    // The left drive begins anew: neither wheel's way counts, or the robot would turn.
    CHECK_FALSE(decoder.on_frame(wide.frame(0, 100030), Stamp{40 * kMs}));
    CHECK(decoder.counters().jumps == 1);
    const auto after = decoder.on_frame(wide.frame(10, 100040), Stamp{60 * kMs});
    REQUIRE(after);
    CHECK(after->left_m == Approx(0.010));
    CHECK(after->right_m == Approx(0.010));

    // 10 bits of 10 mm go round in 10 m: after 3 s at up to 3 m/s nobody knows.
    const Bench narrow(10);
    WheelDecoder small(narrow.params(0.01));
    small.on_frame(narrow.frame(0, 0), Stamp{0});
    small.on_frame(narrow.frame(1, 1), Stamp{20 * kMs});
    small.on_time(Stamp{1000 * kMs});
    small.on_time(Stamp{2000 * kMs});
    CHECK_FALSE(small.fresh(Stamp{1000 * kMs}));
    CHECK(small.left_counters().timeouts == 1);
    CHECK_FALSE(small.on_frame(narrow.frame(101, 101), Stamp{3000 * kMs}));
    CHECK(small.counters().restarts == 1);
    WheelBinding binding = narrow.params(0.01).left;
    CHECK(unambiguous(binding, 3.0));  // 3 m of 5.12 m in twice 0.5 s
    CHECK_FALSE(unambiguous(binding, 6.0));
    binding.signal.timeout = Duration::from_seconds(0.1);
    CHECK(unambiguous(binding, 6.0));
    binding.signal.signal.layout.type = SignalType::kFloat32;
    CHECK_FALSE(unambiguous(binding, 6.0));
    binding.signal.signal.layout.type = SignalType::kUnsigned;
    binding.modulus = 100;
    CHECK_FALSE(unambiguous(binding, 6.0));
    const auto on = small.on_frame(narrow.frame(102, 103), Stamp{3020 * kMs});
    REQUIRE(on);
    CHECK(on->left_m == Approx(0.01));
    CHECK(on->right_m == Approx(0.02));
    // A wide counter tells the way even across a silence.
    CHECK(decoder.on_frame(wide.frame(1010, 101040), Stamp{3000 * kMs})->left_m == Approx(1.0));
}

TEST_CASE("wheels: pulses that only count up, with direction, quality, alive counter and a modulus of their own") {
    const std::string text = dbc_text("dbc/vw_mqb_wheels.dbc");
    WheelParams params;
    const auto bind = [&](const char* pulses, const char* quality, const char* direction) {
        WheelBinding out;
        out.signal = {.signal = signal_of(text, "ESP_10", pulses),
                      .scale = 0.02,
                      .validity = signal_of(text, "ESP_10", quality),
                      .valid_bits = 0,
                      .alive = signal_of(text, "ESP_10", "PulseCounter")};
        out.modulus = 1001;
        out.direction = signal_of(text, "ESP_10", direction);
        return out;
    };
    params.left = bind("PulsesRearLeft", "PulsesRearLeftQuality", "DirectionRearLeft");
    params.right = bind("PulsesRearRight", "PulsesRearRightQuality", "DirectionRearRight");
    WheelDecoder decoder(params);
    std::int64_t ms = 0;
    const auto feed = [&](std::uint64_t l, std::uint64_t r, std::uint64_t direction, std::uint64_t alive,
                          std::uint64_t bad = 0) {
        CanFrame frame{.id = 0x116, .length = 8};
        insert_bits(params.left.signal.signal.layout, frame.data, l);
        insert_bits(params.right.signal.signal.layout, frame.data, r);
        insert_bits(params.left.direction->layout, frame.data, direction);
        insert_bits(params.right.direction->layout, frame.data, direction);
        insert_bits(params.left.signal.alive->layout, frame.data, alive);
        insert_bits(params.left.signal.validity->layout, frame.data, bad);
        ms += 20;
        return decoder.on_frame(frame, Stamp{ms * kMs});
    };
    feed(998, 999, 0, 14);
    const auto forward = feed(1, 1, 0, 15);
    REQUIRE(forward);
    CHECK(forward->left_m == Approx(0.08));
    CHECK(forward->right_m == Approx(0.06));
    const auto backward = feed(3, 2, 1, 0);  // alive 15 to 0 is one step
    REQUIRE(backward);
    CHECK(backward->left_m == Approx(-0.04));
    CHECK(backward->right_m == Approx(-0.02));
    CHECK_FALSE(feed(5, 4, 1, 0));  // stands: an old frame once more
    CHECK(decoder.left_counters().alive_stuck == 1);
    CHECK(feed(5, 4, 1, 3));  // two were lost
    CHECK(decoder.left_counters().alive_jumped == 1);
    CHECK_FALSE(feed(6, 5, 1, 4, 1));
    CHECK(decoder.left_counters().invalid == 1);
    CHECK(decoder.right_counters().invalid == 0);
    const auto again = feed(7, 6, 1, 5);
    REQUIRE(again);
    CHECK(again->left_m == Approx(-0.04));
    CHECK(again->right_m == Approx(-0.04));
    CHECK_FALSE(decoder.on_frame(make_frame(0x116, {1, 2, 3}), Stamp{ms * kMs}));
    CHECK(decoder.left_counters().absent == 1);
}

TEST_CASE("wheels: speeds become ways") {
    const std::string text = dbc_text("dbc/vw_mqb_wheels.dbc");
    WheelParams params;
    params.left.signal = {.signal = signal_of(text, "ESP_19", "SpeedRearLeft"), .scale = 1 / 3.6};
    params.right.signal = {.signal = signal_of(text, "ESP_19", "SpeedRearRight"), .scale = 1 / 3.6};
    params.left.is_speed = params.right.is_speed = true;
    params.speed_max_mps = 60;
    WheelDecoder decoder(params);
    const auto feed = [&](double left_kmh, double right_kmh, std::int64_t ms) {
        CanFrame frame{.id = 0x0B2, .length = 8};
        REQUIRE(encode(params.left.signal.signal.layout, frame.data, left_kmh));
        REQUIRE(encode(params.right.signal.signal.layout, frame.data, right_kmh));
        return decoder.on_frame(frame, Stamp{ms * kMs});
    };
    CHECK_FALSE(feed(36, 36, 0));
    const auto sample = feed(36, 72, 100);
    REQUIRE(sample);
    CHECK(sample->left_m == Approx(1.0).margin(1e-3));
    CHECK(sample->right_m == Approx(1.5).margin(1e-3));
    CHECK_FALSE(feed(36, 36, 5000));  // who knows what it drove meanwhile
    CHECK(decoder.counters().restarts == 1);
}

TEST_CASE("ackermann: speed as the mean of two wheels, steering through the gear, silence") {
    AckermannParams params;
    const SignalBinding wheel{.signal = bits(0x10, 0, 16), .scale = 0.01, .timeout{100 * kMs}};
    params.speed.signal = wheel;
    params.speed.second = wheel;
    params.speed.second->signal = bits(0x10, 16, 16);
    params.steering = {.signal = bits(0x11, 0, 16), .scale = 0.001 / 16, .timeout{100 * kMs}};
    params.steering.signal.layout.type = SignalType::kSigned;
    params.steering_zero_rad = 0.01;
    AckermannDecoder decoder(params);
    CHECK_FALSE(decoder.on_frame(make_frame(0x10, {100, 0, 200, 0}), Stamp{0}));
    CHECK(decoder.counters().incomplete == 1);
    const auto sample = decoder.on_frame(make_frame(0x11, {0x80, 0x3E}), Stamp{10 * kMs});
    REQUIRE(sample);
    CHECK(sample->speed_mps == Approx(1.5));
    CHECK(sample->steering_rad == Approx(0.99));
    CHECK_FALSE(decoder.on_frame(make_frame(0x12, {0, 0}), Stamp{11 * kMs}));
    CHECK_FALSE(decoder.on_frame(make_frame(0x11, {0, 0}), Stamp{150 * kMs}));  // the speed has fallen silent
    decoder.on_time(Stamp{150 * kMs});
    CHECK(decoder.speed().counters().timeouts == 1);
    CHECK(decoder.counters().samples == 1);
}

TEST_CASE("imu: one sample for each yaw rate, with the speed that holds") {
    ImuParams params;
    params.speed.emplace().signal = {.signal = bits(0x20, 0, 16), .scale = 0.001, .timeout{1500 * kMs}};
    params.yaw_rate = {.signal = bits(0x21, 0, 16), .scale = -0.001, .validity = bits(0x21, 16, 1)};
    params.yaw_rate.signal.layout.type = SignalType::kSigned;
    params.yaw_rate_bias_radps = 0.002;
    ImuDecoder decoder(params);
    CHECK_FALSE(decoder.on_frame(make_frame(0x21, {0x64, 0, 1}), Stamp{0}));
    CHECK_FALSE(decoder.on_frame(make_frame(0x20, {0xE8, 3}), Stamp{1 * kMs}));
    const auto sample = decoder.on_frame(make_frame(0x21, {0x64, 0, 1}), Stamp{10 * kMs});
    REQUIRE(sample);
    CHECK(sample->yaw_rate_radps == Approx(-0.102));
    CHECK(sample->speed_mps == Approx(1.0));
    CHECK_FALSE(decoder.on_frame(make_frame(0x21, {0x64, 0, 0}), Stamp{20 * kMs}));
    CHECK(decoder.yaw_rate_counters().invalid == 1);
    CHECK_FALSE(decoder.on_frame(make_frame(0x21, {0x64, 0, 1}), Stamp{2000 * kMs}));
    CHECK(decoder.counters().incomplete == 2);
}

TEST_CASE("imu: without a speed, each yaw rate says so") {
    ImuParams params;
    params.yaw_rate = {.signal = bits(0x21, 0, 16), .scale = 0.001};
    ImuDecoder decoder(params);
    decoder.on_time(Stamp{0});
    const auto sample = decoder.on_frame(make_frame(0x21, {0x64, 0, 1}), Stamp{10 * kMs});
    REQUIRE(sample);
    CHECK_FALSE(sample->speed_told);
    CHECK(sample->speed_mps == 0.0);
    CHECK(sample->yaw_rate_radps == Approx(0.1));
    CHECK(decoder.fresh(Stamp{11 * kMs}));
    CHECK_FALSE(decoder.speed());
}

TEST_CASE("imu: the other axes come along while all of them speak") {
    ImuParams params;
    params.speed.emplace().signal = {.signal = bits(0x20, 0, 16), .timeout{1500 * kMs}};
    params.yaw_rate = {.signal = bits(0x21, 32, 16), .scale = 0.001};
    const auto axis = [](std::uint32_t id, std::uint16_t start, double scale) {
        SignalBinding binding{.signal = bits(id, start, 16), .scale = scale, .timeout{100 * kMs}};
        binding.signal.layout.type = SignalType::kSigned;
        return binding;
    };
    params.inertial = {.roll_rate = axis(0x21, 0, 0.001),
                       .pitch_rate = axis(0x21, 16, -0.001),
                       .acceleration_x = axis(0x22, 0, 0.01),
                       .acceleration_y = axis(0x22, 16, 0.01),
                       .acceleration_z = axis(0x22, 32, 0.01)};
    ImuDecoder decoder(params);
    const CanFrame rates = make_frame(0x21, {10, 0, 20, 0, 30, 0});
    CHECK_FALSE(decoder.on_frame(make_frame(0x20, {2, 0}), Stamp{0}));
    const auto alone = decoder.on_frame(rates, Stamp{1 * kMs});
    REQUIRE(alone);
    CHECK_FALSE(alone->inertial);  // no acceleration yet
    CHECK_FALSE(decoder.on_frame(make_frame(0x22, {0x9C, 0xFF, 50, 0, 0xD5, 3}), Stamp{2 * kMs}));
    const auto whole = decoder.on_frame(rates, Stamp{11 * kMs});
    REQUIRE(whole);
    REQUIRE(whole->inertial);
    CHECK(whole->yaw_rate_radps == Approx(0.03));
    CHECK(whole->inertial->roll_rate_radps == Approx(0.01));
    CHECK(whole->inertial->pitch_rate_radps == Approx(-0.02));
    CHECK(whole->inertial->acceleration_x_mps2 == Approx(-1.0));
    CHECK(whole->inertial->acceleration_y_mps2 == Approx(0.5));
    CHECK(whole->inertial->acceleration_z_mps2 == Approx(9.81));
    decoder.on_time(Stamp{200 * kMs});
    CHECK(decoder.inertial()->signals()[4].counters().timeouts == 1);
    const auto silent = decoder.on_frame(rates, Stamp{210 * kMs});
    REQUIRE(silent);
    CHECK_FALSE(silent->inertial);
}

TEST_CASE("canopen: a node that waits is started, one that falls silent is seen") {
    CHECK(nmt_command(NmtCommand::kStart, 2) == make_frame(0x000, {1, 2}));
    CHECK(nmt_command(NmtCommand::kResetCommunication, 0) == make_frame(0x000, {130, 0}));
    CHECK(canopen_sync() == make_frame(0x080, {}));
    HeartbeatWatch watch(2, Duration{300 * kMs});
    CHECK_FALSE(watch.state().has_value());
    CHECK_FALSE(watch.on_frame(make_frame(0x701, {0}), Stamp{0}));
    CHECK(watch.on_frame(make_frame(0x702, {0}), Stamp{0}) == make_frame(0x000, {1, 2}));
    CHECK(watch.on_frame(make_frame(0x702, {127}), Stamp{100 * kMs}) == make_frame(0x000, {1, 2}));
    CHECK_FALSE(watch.operational(Stamp{100 * kMs}));
    CHECK_FALSE(watch.on_frame(make_frame(0x702, {5}), Stamp{200 * kMs}));
    CHECK(watch.operational(Stamp{500 * kMs}));
    CHECK_FALSE(watch.operational(Stamp{501 * kMs}));
    watch.on_time(Stamp{501 * kMs});
    watch.on_time(Stamp{900 * kMs});
    CHECK(watch.counters().timeouts == 1);
    CHECK_FALSE(watch.on_frame(make_frame(0x702, {4}), Stamp{1000 * kMs}));  // stopped by somebody
    CHECK(watch.state() == NodeState::kStopped);
    CHECK_FALSE(watch.on_frame(make_frame(0x702, {9}), Stamp{1000 * kMs}));
    CHECK_FALSE(watch.on_frame(make_frame(0x702, {5, 5}), Stamp{1000 * kMs}));
    CHECK(watch.counters().unknown == 2);
    CHECK(watch.counters().boot_ups == 1);
}
