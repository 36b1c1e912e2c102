#include <sys/socket.h>

#include <array>
#include <catch2/catch.hpp>
#include <cstdint>
#include <limits>
#include <span>

#include "drivers/motion/motion_decoder.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "platform/linux/udp_receiver.hpp"
#include "platform/service/motion_sender.hpp"
#include "tests/support/heap_guard.hpp"
#include "tests/unit/platform/port_peers.hpp"

using namespace crspf;
using crspf::test::free_port;

namespace {

constexpr std::uint32_t kLoopback = 0x7F000001;
constexpr Pose2 kStep{.x_m = 0.2, .y_m = 0.0, .theta_rad = 0.5};

/// The next datagram's content.
MotionDatagram next(UdpReceiver& receiver) {
    std::array<std::uint8_t, 256> buffer{};
    const Datagram got = receiver.receive(buffer, Duration{10'000'000'000});
    REQUIRE(got.io.status == IoStatus::kOk);
    MotionDatagram datagram;
    REQUIRE(decode(std::span(buffer).first(got.io.bytes), datagram) == MotionFault::kNone);
    return datagram;
}

MotionSample step(Stamp stamp, bool blind = false) {
    return {.stamp = stamp,
            .P_previous_base = kStep,
            .translation_variance_m2 = 0.01,
            .rotation_variance_rad2 = 0.001,
            .blind = blind};
}

}  // namespace

TEST_CASE("motion sender: sums, numbers, and how long ago it was", "[real-kernel]") {
    const std::uint16_t port = free_port(SOCK_DGRAM);
    UdpReceiver receiver({.own_address = kLoopback, .port = port});
    std::array<std::uint8_t, 1> none{};
    REQUIRE(receiver.receive(none, {}).io.status == IoStatus::kRetry);
    MotionSender sender(kLoopback, port, 77);
    sender.send(step(monotonic_now() - Duration{20'000'000}));
    sender.send(step(monotonic_now() + Duration{5'000'000'000}, true));
    const MotionDatagram a = next(receiver);
    const MotionDatagram b = next(receiver);
    CHECK(a.session == 77);
    CHECK(b.session == 77);
    CHECK(b.sequence == a.sequence + 1);
    CHECK(a.age >= Duration{20'000'000});
    CHECK(b.age == Duration{});  // a stamp that has not come yet
    CHECK(a.P_odom_base == kStep);
    CHECK(b.P_odom_base == kStep * kStep);
    CHECK(b.translation_variance_m2 == Approx(0.02));
    CHECK(b.rotation_variance_rad2 == Approx(0.002));
    CHECK_FALSE(a.blind);
    CHECK(b.blind);
}

TEST_CASE("motion sender: what is no motion spoils no sum", "[real-kernel]") {
    const std::uint16_t port = free_port(SOCK_DGRAM);
    UdpReceiver receiver({.own_address = kLoopback, .port = port});
    std::array<std::uint8_t, 1> none{};
    REQUIRE(receiver.receive(none, {}).io.status == IoStatus::kRetry);
    MotionSender sender(kLoopback, port, 1);
    MotionSample bad = step({});
    bad.P_previous_base.y_m = std::numeric_limits<double>::quiet_NaN();
    sender.send(bad);
    bad = step({});
    bad.rotation_variance_rad2 = -1.0;
    sender.send(bad);
    sender.send(step({}));
    CHECK(next(receiver).P_odom_base == kStep);
    CHECK(sender.counters().refused == 2);
    CHECK(sender.counters().sent == 1);
}

TEST_CASE("motion sender: nobody listens, and it neither waits nor allocates") {
    MotionSender sender(kLoopback, free_port(SOCK_DGRAM), 1);
    const Stamp stamp = monotonic_now();
    const test::HeapGuard guard;
    for (int i = 0; i < 1000; ++i) {
        sender.send(step(stamp));
    }
    const std::uint64_t calls = guard.calls();
    CHECK(calls == 0);
    CHECK(sender.counters().sent == 1000);
}

TEST_CASE("motion sender: an address that no datagram reaches is counted") {
    MotionSender sender(0xFFFFFFFF, free_port(SOCK_DGRAM), 1);  // broadcast, which a socket must be allowed
    sender.send(step(monotonic_now()));
    CHECK(sender.counters().unsent == 1);
}
