#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/rng.hpp"
#include "drivers/motion/crc32.hpp"
#include "drivers/motion/motion_codec.hpp"
#include "drivers/motion/motion_decoder.hpp"

using namespace crspf;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLargest = std::numeric_limits<double>::max();
constexpr Duration kPeriod{50'000'000};
constexpr Duration kAge{30'000'000};

using Bytes = std::array<std::uint8_t, kMotionBytes>;

Bytes bytes_of(const MotionDatagram& datagram) {
    Bytes bytes{};
    REQUIRE(encode(datagram, bytes) == kMotionBytes);
    return bytes;
}

/// A sender that drives in a circle: 0.1 m and 0.05 rad with each datagram.
class Sender {
 public:
    static constexpr Pose2 kStep{.x_m = 0.1, .y_m = 0.0, .theta_rad = 0.05};

    explicit Sender(std::uint32_t session, std::uint32_t sequence = 0) {
        sum_.session = session;
        sum_.sequence = sequence;
        sum_.age = kAge;
    }
    MotionDatagram next(bool blind = false) {
        sum_.blind = blind;
        ++sum_.sequence;
        sum_.P_odom_base = sum_.P_odom_base * kStep;
        sum_.translation_variance_m2 += 1e-4;
        sum_.rotation_variance_rad2 += 1e-5;
        return sum_;
    }

 private:
    MotionDatagram sum_;
};

/// A decoder that gets a datagram each period.
class Receiver {
 public:
    std::optional<MotionSample> hear(const MotionDatagram& datagram) {
        received_ = received_ + kPeriod;
        return decoder.on_datagram(bytes_of(datagram), received_);
    }
    [[nodiscard]] Stamp received() const { return received_; }
    [[nodiscard]] const MotionCounters& counters() const { return decoder.counters(); }

    MotionDecoder decoder;

 private:
    Stamp received_{7'000'000'000};
};

bool near(const Pose2& a, const Pose2& b) {
    return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m) < 1e-12 && std::abs(wrap_angle(a.theta_rad - b.theta_rad)) < 1e-12;
}

}  // namespace

TEST_CASE("crc32: zlib's check value") {
    constexpr std::string_view kText = "123456789";
    std::vector<std::uint8_t> bytes(kText.begin(), kText.end());
    CHECK(crc32(bytes) == 0xCBF43926U);
    CHECK(crc32({}) == 0);
}

TEST_CASE("motion: a datagram as docs/motion-protocol.md has it") {
    const MotionDatagram datagram{.blind = true,
                                  .session = 0x01020304,
                                  .sequence = 0x05060708,
                                  .age = {0x1122334455},
                                  .P_odom_base = {.x_m = 1.0, .y_m = -2.0, .theta_rad = 0.5},
                                  .translation_variance_m2 = 0.25,
                                  .rotation_variance_rad2 = 4.0};
    const Bytes bytes = bytes_of(datagram);
    // By Python: struct.pack("<4sBBHIIqddddd", ...) and zlib.crc32().
    const Bytes expected{'C',  'R',  'S',  'M',  0x01, 0x01, 0x00, 0x00, 0x04, 0x03, 0x02, 0x01, 0x08, 0x07,
                         0x06, 0x05, 0x55, 0x44, 0x33, 0x22, 0x11, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
                         0x00, 0x00, 0xF0, 0x3F, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xC0, 0x00, 0x00,
                         0x00, 0x00, 0x00, 0x00, 0xE0, 0x3F, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xD0, 0x3F,
                         0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x10, 0x40, 0xAE, 0x3A, 0x54, 0xDC};
    CHECK(bytes == expected);
    MotionDatagram back;
    CHECK(decode(bytes, back) == MotionFault::kNone);
    CHECK(back == datagram);

    Bytes room{};
    CHECK(encode(datagram, std::span(room).first(kMotionBytes - 1)) == 0);
}

TEST_CASE("motion: damage anywhere is seen") {
    const Bytes good = bytes_of(Sender(5).next());
    MotionDatagram out;
    for (std::size_t i = 0; i < good.size(); ++i) {
        for (int bit = 0; bit < 8; ++bit) {
            Bytes bad = good;
            bad[i] = static_cast<std::uint8_t>(bad[i] ^ (1U << bit));
            const MotionFault fault = decode(bad, out);
            INFO("byte " << i << " bit " << bit);
            REQUIRE(fault == (i < 4 ? MotionFault::kMagic : i == 4 ? MotionFault::kVersion : MotionFault::kCrc));
        }
    }
    std::vector<std::uint8_t> longer(good.begin(), good.end());
    longer.push_back(0);
    CHECK(decode(longer, out) == MotionFault::kLength);
    CHECK(decode(std::span(good).first(kMotionBytes - 1), out) == MotionFault::kLength);
    CHECK(decode({}, out) == MotionFault::kLength);

    SECTION("bits of a later version, whose sum is right") {
        for (const std::size_t at : {5U, 6U, 7U}) {
            Bytes later = good;
            later[at] = 0x80;
            const std::uint32_t sum = crc32(std::span(later).first(kMotionBytes - 4));
            for (std::size_t i = 0; i < 4; ++i) {
                later[kMotionBytes - 4 + i] = static_cast<std::uint8_t>(sum >> (8 * i));
            }
            CHECK(decode(later, out) == MotionFault::kVersion);
        }
    }
}

TEST_CASE("motion: increments between poses, of the instant that the sender means") {
    Sender sender(1);
    Receiver receiver;
    const auto first = receiver.hear(sender.next());
    REQUIRE(first);
    CHECK(first->P_previous_base == Pose2{});  // where it was before is not known
    CHECK(first->translation_variance_m2 == 0.0);
    CHECK(first->stamp == receiver.received() - kAge);
    for (int i = 0; i < 200; ++i) {  // one and a half times round
        const auto sample = receiver.hear(sender.next());
        REQUIRE(sample);
        REQUIRE(near(sample->P_previous_base, Sender::kStep));
        REQUIRE(sample->stamp == receiver.received() - kAge);
        REQUIRE(sample->translation_variance_m2 == Approx(1e-4));
        REQUIRE(sample->rotation_variance_rad2 == Approx(1e-5));
        REQUIRE_FALSE(sample->blind);
    }
    CHECK(receiver.counters().samples == 201);
    CHECK(receiver.counters().lost == 0);
}

TEST_CASE("motion: what is lost on the way loses neither motion nor doubt") {
    Rng rng(11);
    Sender sender(1, 0xFFFFFFF0U);  // over the end of the numbers, too
    Receiver receiver;
    MotionDatagram newest = sender.next();
    const Pose2 begin = newest.P_odom_base;
    REQUIRE(receiver.hear(newest));
    Pose2 P_begin_base;
    double variance_m2 = 0.0;
    std::uint64_t lost = 0;
    for (int i = 0; i < 100; ++i) {
        newest = sender.next();
        if (i < 99 && rng.symmetric() > 0.0) {
            ++lost;
            continue;
        }
        const auto sample = receiver.hear(newest);
        REQUIRE(sample);
        P_begin_base = P_begin_base * sample->P_previous_base;
        variance_m2 += sample->translation_variance_m2;
    }
    REQUIRE(lost > 30);
    CHECK(receiver.counters().lost == lost);
    CHECK(near(begin * P_begin_base, newest.P_odom_base));
    CHECK(variance_m2 == Approx(0.01));
}

TEST_CASE("motion: what was overtaken, comes twice or steps back in time is left out, and the next has its motion") {
    Sender sender(1);
    Receiver receiver;
    const MotionDatagram a = sender.next();
    MotionDatagram b = sender.next();
    const MotionDatagram c = sender.next();
    REQUIRE(receiver.hear(a));
    SECTION("overtaken") {
        const auto sample = receiver.hear(c);
        REQUIRE(sample);
        CHECK(near(sample->P_previous_base, Sender::kStep * Sender::kStep));
        CHECK_FALSE(receiver.hear(b));
        CHECK(receiver.counters().lost == 1);
    }
    SECTION("twice") {
        CHECK_FALSE(receiver.hear(a));
        REQUIRE(receiver.hear(b));
    }
    SECTION("an instant that is not later") {
        b.age = {kAge.ns + kPeriod.ns};
        CHECK_FALSE(receiver.hear(b));
        const auto sample = receiver.hear(c);
        REQUIRE(sample);
        CHECK(near(sample->P_previous_base, Sender::kStep * Sender::kStep));
    }
    CHECK(receiver.counters().ran_back == 1);
}

TEST_CASE("motion: a sender that begins anew makes no jump") {
    Sender before(1);
    Receiver receiver;
    for (int i = 0; i < 50; ++i) {
        REQUIRE(receiver.hear(before.next()));
    }
    Sender after(2);
    const auto first = receiver.hear(after.next());
    REQUIRE(first);
    CHECK(first->P_previous_base == Pose2{});
    CHECK(first->stamp == receiver.received() - kAge);
    CHECK(near(receiver.hear(after.next())->P_previous_base, Sender::kStep));
    CHECK(receiver.counters().restarts == 1);
    CHECK(receiver.counters().ran_back == 0);
}

TEST_CASE("motion: what is no motion is refused or left out, and counted") {
    Sender sender(1);
    Receiver receiver;
    REQUIRE(receiver.hear(sender.next()));
    SECTION("numbers that are none") {
        for (const double bad : {kNan, kInfinity, -kInfinity}) {
            for (double MotionDatagram::*field :
                 {&MotionDatagram::translation_variance_m2, &MotionDatagram::rotation_variance_rad2}) {
                MotionDatagram datagram = sender.next();
                datagram.*field = bad;
                CHECK_FALSE(receiver.hear(datagram));
            }
            for (double Pose2::*field : {&Pose2::x_m, &Pose2::y_m, &Pose2::theta_rad}) {
                MotionDatagram datagram = sender.next();
                datagram.P_odom_base.*field = bad;
                CHECK_FALSE(receiver.hear(datagram));
            }
        }
        MotionDatagram turned = sender.next();
        turned.P_odom_base.theta_rad = 1e7;
        CHECK_FALSE(receiver.hear(turned));
        CHECK(receiver.counters().not_finite == 16);
    }
    SECTION("ages that cannot be") {
        for (const std::int64_t ns :
             {std::int64_t{-1}, kMotionAgeMax.ns + 1, std::numeric_limits<std::int64_t>::min()}) {
            MotionDatagram datagram = sender.next();
            datagram.age = {ns};
            CHECK_FALSE(receiver.hear(datagram));
        }
        CHECK(receiver.counters().bad_age == 3);
    }
    SECTION("a step that no vehicle makes, sums that fall: it goes on from there") {
        MotionDatagram datagram = sender.next();
        for (const double far_m : {20.0, 1e300, -kLargest}) {
            datagram.P_odom_base.x_m = far_m;
            ++datagram.sequence;
            CHECK(receiver.hear(datagram)->P_previous_base == Pose2{});
        }
        datagram.P_odom_base.x_m = 0.0;
        ++datagram.sequence;
        CHECK(receiver.hear(datagram)->P_previous_base == Pose2{});
        CHECK(receiver.counters().implausible == 4);
        ++datagram.sequence;
        datagram.translation_variance_m2 = 0.0;
        const auto fallen = receiver.hear(datagram);
        REQUIRE(fallen);
        CHECK(fallen->translation_variance_m2 == 0.0);
        CHECK(receiver.counters().implausible == 5);
        ++datagram.sequence;
        datagram.P_odom_base = datagram.P_odom_base * Sender::kStep;
        CHECK(near(receiver.hear(datagram)->P_previous_base, Sender::kStep));
    }
    SECTION("datagrams that are damaged") {
        Bytes bytes = bytes_of(sender.next());
        CHECK_FALSE(receiver.decoder.on_datagram(std::span(bytes).first(20), receiver.received()));
        bytes[20] = 1;
        CHECK_FALSE(receiver.decoder.on_datagram(bytes, receiver.received()));
        bytes[4] = 2;
        CHECK_FALSE(receiver.decoder.on_datagram(bytes, receiver.received()));
        bytes[0] = 'X';
        CHECK_FALSE(receiver.decoder.on_datagram(bytes, receiver.received()));
        CHECK(receiver.counters().bad_length == 1);
        CHECK(receiver.counters().bad_crc == 1);
        CHECK(receiver.counters().bad_version == 1);
        CHECK(receiver.counters().bad_magic == 1);
    }
}

TEST_CASE("motion: since when the odometer is blind") {
    Sender sender(1);
    Receiver receiver;
    REQUIRE(receiver.hear(sender.next()));
    CHECK_FALSE(receiver.decoder.blind_since());
    const auto blind = receiver.hear(sender.next(true));
    REQUIRE(blind);
    CHECK(blind->blind);
    REQUIRE(receiver.hear(sender.next(true)));
    CHECK(receiver.decoder.blind_since() == blind->stamp);
    CHECK(receiver.counters().blind == 2);
    REQUIRE(receiver.hear(sender.next()));
    CHECK_FALSE(receiver.decoder.blind_since());
}
