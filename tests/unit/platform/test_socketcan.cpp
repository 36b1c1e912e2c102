#include "platform/linux/socketcan.hpp"

#include <linux/can.h>
#include <linux/can/error.h>

#include <catch2/catch.hpp>

#include "platform/linux/can_error.hpp"
#include "tests/unit/platform/port_peers.hpp"

using crspf::CanFrame;
using crspf::CanHealth;
using crspf::CanState;
using crspf::Duration;
using crspf::IoStatus;
using crspf::SocketCan;
using crspf::UniqueFd;
using crspf::test::Effort;
using crspf::test::effort_of;
using crspf::test::kSpinLoad;
using crspf::test::kStep;

namespace {

/// Two sockets that pass frames to each other: what stands in for a bus where the kernel has none.
struct FakeBus {
    FakeBus() {
        std::array<int, 2> ends{};
        REQUIRE(::socketpair(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()) == 0);
        ours = UniqueFd(ends[0]);
        theirs = UniqueFd(ends[1]);
    }
    void send(const can_frame& frame) const {
        REQUIRE(::send(theirs.get(), &frame, sizeof(frame), 0) == sizeof(frame));
    }
    UniqueFd ours;
    UniqueFd theirs;
};

can_frame raw(std::uint32_t id, std::initializer_list<std::uint8_t> data) {
    can_frame frame{};
    frame.can_id = id;
    frame.can_dlc = static_cast<std::uint8_t>(data.size());  // NOLINT(*-union-access): the kernel declares it so
    std::copy(data.begin(), data.end(), std::begin(frame.data));
    return frame;
}

CanHealth after(std::initializer_list<can_frame> errors) {
    CanHealth health;
    for (const can_frame& error : errors) {
        CanFrame frame{.id = error.can_id & CAN_ERR_MASK, .error = true, .length = 8};
        std::copy(std::begin(error.data), std::end(error.data), frame.data.begin());
        note_can_error(frame, health);
    }
    return health;
}

}  // namespace

TEST_CASE("socketcan: frames of every kind, both ways") {
    FakeBus bus;
    SocketCan can(std::move(bus.ours));
    bus.send(raw(0x221, {1, 2, 3}));
    bus.send(raw(0x18FEF100U | CAN_EFF_FLAG, {4}));
    bus.send(raw(0x123U | CAN_RTR_FLAG, {}));
    canfd_frame fd{};
    fd.can_id = 0x55;
    fd.len = 12;
    fd.data[11] = 9;
    REQUIRE(::send(bus.theirs.get(), &fd, sizeof(fd), 0) == sizeof(fd));
    CanFrame frame;
    const auto received = can.receive(frame, kStep);
    REQUIRE(received.status == IoStatus::kOk);
    CHECK(received.bytes == 3);
    CHECK(received.stamp > crspf::Stamp{});
    CHECK(frame == CanFrame{.id = 0x221, .length = 3, .data = {1, 2, 3}});
    REQUIRE(can.receive(frame, kStep).status == IoStatus::kOk);
    CHECK(frame == CanFrame{.id = 0x18FEF100, .extended = true, .length = 1, .data = {4}});
    REQUIRE(can.receive(frame, kStep).status == IoStatus::kOk);
    CHECK(frame == CanFrame{.id = 0x123, .remote = true});
    REQUIRE(can.receive(frame, kStep).status == IoStatus::kOk);
    CHECK((frame.fd && frame.id == 0x55 && frame.length == 12 && frame.data[11] == 9));
    CHECK(can.receive(frame, kStep).status == IoStatus::kRetry);

    REQUIRE(can.send({.id = 0x18FEF100, .extended = true, .length = 2, .data = {7, 8}}, {}) == IoStatus::kOk);
    can_frame sent{};
    REQUIRE(::recv(bus.theirs.get(), &sent, sizeof(sent), 0) == CAN_MTU);
    CHECK(sent.can_id == (0x18FEF100U | CAN_EFF_FLAG));
    CHECK(sent.can_dlc == 2);  // NOLINT(*-union-access): the kernel declares it so
    CHECK(sent.data[1] == 8);
    REQUIRE(can.send({.id = 1, .fd = true, .length = 64}, {}) == IoStatus::kOk);
    CHECK(::recv(bus.theirs.get(), &fd, sizeof(fd), 0) == CANFD_MTU);
    CHECK(can.send({.id = 0x800}, {}) == IoStatus::kError);
    CHECK(can.send({.id = 0x40, .error = true}, {}) == IoStatus::kError);
}

TEST_CASE("socketcan: a frame that cannot be sent is given up at its deadline") {
    FakeBus bus;
    SocketCan can(std::move(bus.ours));
    int sent = 0;
    while (can.send({.id = 1}, crspf::monotonic_now()) == IoStatus::kOk) {
        REQUIRE(++sent < 1'000'000);
    }
    const CanHealth before = can.health();
    CHECK(before.send_timeouts == 1);
    const crspf::Stamp deadline = crspf::monotonic_now() + Duration{20'000'000};
    CHECK(can.send({.id = 1}, deadline) == IoStatus::kRetry);
    CHECK(crspf::monotonic_now() >= deadline);
    CHECK(can.health().send_timeouts == 2);
    CHECK(can.health().queue_full > before.queue_full + 1);  // tried again, but not without end
    CHECK(can.health().queue_full < before.queue_full + 100);
    can_frame frame{};
    REQUIRE(::recv(bus.theirs.get(), &frame, sizeof(frame), 0) == CAN_MTU);
    CHECK(can.send({.id = 1}, crspf::monotonic_now()) == IoStatus::kOk);
}

TEST_CASE("socketcan: error frames become health, not frames") {
    FakeBus bus;
    SocketCan can(std::move(bus.ours));
    CanFrame frame;
    bus.send(raw(CAN_ERR_FLAG | CAN_ERR_BUSOFF, {0, 0, 0, 0, 0, 0, 0, 0}));
    CHECK(can.receive(frame, kStep).status == IoStatus::kRetry);
    CHECK(can.health().state == CanState::kBusOff);
    bus.send(raw(CAN_ERR_FLAG | CAN_ERR_RESTARTED, {0, 0, 0, 0, 0, 0, 0, 0}));
    bus.send(raw(0x221, {1}));
    CHECK(can.receive(frame, {100'000'000}).status == IoStatus::kOk);
    CHECK(frame.id == 0x221);
    CHECK(can.health().state == CanState::kActive);
    CHECK(can.health().bus_offs == 1);
    CHECK(can.health().restarts == 1);
}

TEST_CASE("socketcan: what error frames say") {
    CHECK(after({raw(CAN_ERR_CRTL, {0, CAN_ERR_CRTL_RX_WARNING})}).state == CanState::kWarning);
    CHECK(after({raw(CAN_ERR_CRTL, {0, CAN_ERR_CRTL_TX_PASSIVE})}).state == CanState::kPassive);
    CHECK(after({raw(CAN_ERR_CRTL, {0, CAN_ERR_CRTL_TX_PASSIVE}), raw(CAN_ERR_CRTL, {0, 0x40})}).state ==
          CanState::kActive);
    CHECK(after({raw(CAN_ERR_CRTL, {0, CAN_ERR_CRTL_RX_OVERFLOW})}).overflows == 1);
    CHECK(after({raw(CAN_ERR_ACK, {}), raw(CAN_ERR_PROT | CAN_ERR_BUSERROR, {})}).bus_errors == 2);
    constexpr std::uint32_t kCounters = 0x200;
    const CanHealth counted = after({raw(kCounters, {0, 0, 0, 0, 0, 0, 127, 96})});
    CHECK((counted.state == CanState::kWarning && counted.transmit_errors == 127 && counted.receive_errors == 96));
    CHECK(after({raw(kCounters, {0, 0, 0, 0, 0, 0, 0, 128})}).state == CanState::kPassive);
    // The counters of a bus that is off are stale: only a restart brings it back.
    CHECK(after({raw(CAN_ERR_BUSOFF, {}), raw(kCounters, {0, 0, 0, 0, 0, 0, 0, 0})}).state == CanState::kBusOff);
    CanHealth health;
    note_can_error({.id = CAN_ERR_BUSOFF}, health);  // a data frame
    CHECK(health.state == CanState::kActive);
}

TEST_CASE("socketcan: a socket that is lost is told, and does not spin") {
    FakeBus bus;
    SocketCan can(std::move(bus.ours));
    CanFrame frame;
    bus.theirs = UniqueFd();
    CHECK(can.send({.id = 1}, {}) == IoStatus::kClosed);
    CHECK(can.health().interface_downs == 1);
    const Effort effort = effort_of([&] { CHECK(can.receive(frame, kStep).status == IoStatus::kClosed); });
    CHECK(effort.calls <= 40);
    CHECK(effort.load < kSpinLoad);
}

TEST_CASE("socketcan: an interface that is not there is waited for without a spin") {
    SocketCan can("nocan0", {{.id = 0x123}});
    CanFrame frame;
    const Effort effort = effort_of([&] { CHECK(can.receive(frame, kStep).status == IoStatus::kClosed); });
    CHECK((can.error() == ENODEV || can.error() == EAFNOSUPPORT));
    CHECK(effort.calls <= 40);
    CHECK(effort.load < kSpinLoad);
    if (can.error() == EAFNOSUPPORT) {
        WARN("skipped: this kernel has no CAN; filters, ENETDOWN and ENOBUFS of a real interface are not tested here");
    }
}
