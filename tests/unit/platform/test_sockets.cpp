#include <catch2/catch.hpp>
#include <optional>

#include "platform/linux/tcp_client.hpp"
#include "platform/linux/udp_receiver.hpp"
#include "tests/unit/platform/port_peers.hpp"

using crspf::Datagram;
using crspf::Duration;
using crspf::IoStatus;
using crspf::Stamp;
using crspf::TcpClient;
using crspf::to_monotonic;
using crspf::UdpReceiver;
using crspf::UniqueFd;
using crspf::test::as_bytes;
using crspf::test::Effort;
using crspf::test::effort_of;
using crspf::test::free_port;
using crspf::test::kSpinLoad;
using crspf::test::kStep;
using crspf::test::kStepsMax;
using crspf::test::LoopbackSocket;
using crspf::test::opens;
using crspf::test::read_some;
using crspf::test::read_text;

namespace {

constexpr std::uint32_t kLocal = 0x7F000001;
constexpr Duration kPatience{kStepsMax * kStep.ns};

std::string text_of(const std::array<std::uint8_t, 2048>& buffer, const Datagram& datagram) {
    return {buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(datagram.io.bytes)};
}

}  // namespace

TEST_CASE("udp: datagrams with their source and their arrival", "[real-kernel]") {
    const std::uint16_t port = free_port(SOCK_DGRAM);
    UdpReceiver receiver({.own_address = kLocal, .port = port});
    const LoopbackSocket sensor(SOCK_DGRAM);
    std::array<std::uint8_t, 2048> buffer{};
    REQUIRE(receiver.receive(buffer, kStep).io.status == IoStatus::kRetry);
    const Stamp before = crspf::monotonic_now();
    sensor.send_to(port, "one");
    sensor.send_to(port, "");
    sensor.send_to(port, "three");
    const Stamp after = crspf::monotonic_now();
    crspf::sleep_until(after + Duration{200'000'000});  // it is the arrival that is stamped, not the reading
    const Datagram first = receiver.receive(buffer, kPatience);
    REQUIRE(first.io.status == IoStatus::kOk);
    CHECK(text_of(buffer, first) == "one");
    CHECK(first.source_address == kLocal);
    CHECK(first.source_port == sensor.port());
    constexpr Duration kClocks{100'000'000};  // what may pass between the readings of two clocks on a busy machine
    CHECK(first.io.stamp >= before - kClocks);
    CHECK(first.io.stamp <= after + kClocks);
    CHECK_FALSE(first.io.truncated);
    const Datagram second = receiver.receive(buffer, kPatience);
    CHECK((second.io.status == IoStatus::kOk && second.io.bytes == 0));
    CHECK(text_of(buffer, receiver.receive(buffer, kPatience)) == "three");
    CHECK(receiver.receive(buffer, {}).io.status == IoStatus::kRetry);
    CHECK(receiver.counters().received == 3);
}

TEST_CASE("udp: others' datagrams are refused and counted", "[real-kernel]") {
    const std::uint16_t port = free_port(SOCK_DGRAM);
    UdpReceiver receiver({.port = port, .source_address = 0x7F000002});
    const LoopbackSocket sensor(SOCK_DGRAM, 2);
    const LoopbackSocket other(SOCK_DGRAM, 3);
    std::array<std::uint8_t, 2048> buffer{};
    REQUIRE(receiver.receive(buffer, kStep).io.status == IoStatus::kRetry);
    other.send_to(port, "other");
    CHECK(receiver.receive(buffer, kStep).io.status == IoStatus::kRetry);
    other.send_to(port, "other");
    sensor.send_to(port, "sensor");
    const Datagram datagram = receiver.receive(buffer, kPatience);
    CHECK(text_of(buffer, datagram) == "sensor");
    CHECK(datagram.source_address == 0x7F000002);
    CHECK(receiver.counters().refused == 2);
}

TEST_CASE("udp: what is cut or lost is told", "[real-kernel]") {
    const std::uint16_t port = free_port(SOCK_DGRAM);
    UdpReceiver receiver({.own_address = kLocal, .port = port, .buffer_bytes = 1});  // the kernel's least
    const LoopbackSocket sensor(SOCK_DGRAM);
    std::array<std::uint8_t, 2048> buffer{};
    REQUIRE(receiver.receive(buffer, kStep).io.status == IoStatus::kRetry);
    sensor.send_to(port, std::string(100, 'x'));
    const Datagram cut = receiver.receive(std::span(buffer).first(99), kPatience);
    CHECK((cut.io.status == IoStatus::kOk && cut.io.truncated && cut.io.bytes == 99));
    constexpr std::uint64_t kSent = 200;
    for (std::uint64_t i = 0; i < kSent; ++i) {
        sensor.send_to(port, std::string(1206, 'x'));
    }
    std::uint64_t dropped = 0;
    while (receiver.receive(buffer, {}).io.status == IoStatus::kOk) {
    }
    sensor.send_to(port, "after");  // the loss is told by the next one that arrives
    dropped += receiver.receive(buffer, kPatience).io.dropped;
    CHECK(dropped > 0);
    CHECK(receiver.counters().dropped == dropped);
    CHECK(receiver.counters().received + dropped == kSent + 2);
    CHECK(receiver.counters().truncated == 1);
}

TEST_CASE("udp: a port in use is waited for without a spin", "[real-kernel]") {
    std::optional<LoopbackSocket> holder(std::in_place, SOCK_DGRAM);
    UdpReceiver receiver({.own_address = kLocal, .port = holder->port()});
    std::array<std::uint8_t, 16> buffer{};
    const Effort effort = effort_of([&] { CHECK(receiver.receive(buffer, kStep).io.status == IoStatus::kClosed); });
    CHECK(receiver.error() == EADDRINUSE);
    CHECK(effort.calls <= 40);
    CHECK(effort.load < kSpinLoad);
    holder.reset();
    int steps = 0;
    while (receiver.receive(buffer, kStep).io.status == IoStatus::kClosed && steps < kStepsMax) {
        ++steps;
    }
    CHECK(steps < kStepsMax);
}

TEST_CASE("udp: a calendar that is set in between does not move the arrival") {
    const Stamp real{1'700'000'000'000'000'000};
    const Stamp now{50'000'000'000};
    CHECK(to_monotonic(real, real + Duration{1'000}, now) == now - Duration{1'000});
    CHECK(to_monotonic(real, real, now) == now);
    CHECK(to_monotonic(real, real - Duration{1}, now) == now);
    CHECK(to_monotonic(real, real + Duration{1'000'000'001}, now) == now);
}

TEST_CASE("tcp: bytes both ways, the end after the last of them, and a new connection") {
    std::optional<LoopbackSocket> sensor(std::in_place, SOCK_STREAM);
    const std::uint16_t port = sensor->port();
    TcpClient client(kLocal, port);
    CHECK(client.write(as_bytes("early")).status == IoStatus::kClosed);
    for (int i = 0; i < 2; ++i) {
        REQUIRE(opens(client));
        UniqueFd connection = sensor->accept();
        CHECK(client.set_baud(115200) == IoStatus::kOk);
        CHECK(client.write(as_bytes("request")).bytes == 7);
        std::array<char, 7> request{};
        CHECK(::recv(connection.get(), request.data(), request.size(), MSG_WAITALL) == 7);
        CHECK(::send(connection.get(), "reply", 5, MSG_NOSIGNAL) == 5);
        CHECK(read_text(client, 5) == "reply");
        // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): text as bytes
        CHECK(client.read({reinterpret_cast<std::uint8_t*>(request.data()), 7}, kStep).status == IoStatus::kRetry);
        CHECK(::send(connection.get(), "last", 4, MSG_NOSIGNAL) == 4);
        connection = UniqueFd();
        std::string last;
        while (read_some(client, last).status == IoStatus::kOk) {
        }
        CHECK(last == "last");
        CHECK(client.error() != 0);
        CHECK(client.write(as_bytes("x")).status == IoStatus::kClosed);
    }
}

TEST_CASE("tcp: a sensor that is off is tried without a spin, and found when it is on") {
    const std::uint16_t port = free_port(SOCK_STREAM);
    TcpClient client(kLocal, port);
    std::array<std::uint8_t, 16> buffer{};
    const Effort effort = effort_of([&] { CHECK(client.read(buffer, kStep).status == IoStatus::kClosed); });
    CHECK(client.error() == ECONNREFUSED);
    CHECK(effort.calls <= 40);
    CHECK(effort.load < kSpinLoad);
    const LoopbackSocket sensor(SOCK_STREAM, 1, port);
    REQUIRE(opens(client));
    client.close();
    CHECK(client.read(buffer, {}).status == IoStatus::kClosed);
    CHECK(opens(client));
}
