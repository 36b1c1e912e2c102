#include "platform/linux/serial_port.hpp"

#include <asm/termbits.h>
#include <sys/ioctl.h>

#include <catch2/catch.hpp>
#include <optional>

#include "tests/unit/platform/port_peers.hpp"
#include "tests/unit/platform/scratch.hpp"

using crspf::IoStatus;
using crspf::SerialPort;
using crspf::test::as_bytes;
using crspf::test::Effort;
using crspf::test::effort_of;
using crspf::test::FakeSerialSensor;
using crspf::test::kSpinLoad;
using crspf::test::kStep;
using crspf::test::opens;
using crspf::test::read_some;
using crspf::test::read_text;
using crspf::test::Scratch;

TEST_CASE("serial port: every byte passes as it is, both ways", "[real-kernel]") {
    const Scratch scratch;
    const FakeSerialSensor sensor(scratch / "tty");
    SerialPort port(scratch / "tty", 115200);
    REQUIRE(opens(port));
    std::string every_byte;
    for (int i = 0; i < 256; ++i) {
        every_byte += static_cast<char>(i);
    }
    sensor.send(every_byte);
    CHECK(read_text(port, 256) == every_byte);
    const auto sent = port.write(as_bytes(every_byte));
    CHECK(sent.status == IoStatus::kOk);
    CHECK(sent.bytes == 256);
    CHECK(sensor.receive(256) == every_byte);
}

TEST_CASE("serial port: no byte is no loss", "[real-kernel]") {
    const Scratch scratch;
    const FakeSerialSensor sensor(scratch / "tty");
    SerialPort port(scratch / "tty", 115200);
    REQUIRE(opens(port));
    std::array<std::uint8_t, 8> buffer{};
    for (int i = 0; i < 3; ++i) {
        CHECK(port.read(buffer, kStep).status == IoStatus::kRetry);
    }
    sensor.send("x");
    const auto received = port.read(buffer, {2'000'000'000});
    CHECK(received.status == IoStatus::kOk);
    CHECK(received.stamp > crspf::Stamp{});
}

TEST_CASE("serial port: speeds, and back to the configured one after a loss", "[real-kernel]") {
    const Scratch scratch;
    std::optional<FakeSerialSensor> sensor(scratch / "tty");
    SerialPort port(scratch / "tty", 19200);
    CHECK(port.set_baud(115200) == IoStatus::kClosed);
    REQUIRE(opens(port));
    const auto speed = [&] {
        struct termios2 line {};
        REQUIRE(::ioctl(sensor->fd(), TCGETS2, &line) == 0);
        return line.c_ospeed;
    };
    CHECK(speed() == 19200);
    CHECK(port.set_baud(115200) == IoStatus::kOk);
    CHECK(speed() == 115200);
    CHECK(port.set_baud(250'000) == IoStatus::kOk);  // none of the C library's speeds
    CHECK(speed() == 250'000);
    sensor.emplace(scratch / "tty");
    std::string none;
    CHECK(read_some(port, none).status == IoStatus::kClosed);
    REQUIRE(opens(port));
    CHECK(speed() == 19200);
}

TEST_CASE("serial port: a sensor unplugged is noticed, and found when it is plugged in again", "[real-kernel]") {
    const Scratch scratch;
    std::optional<FakeSerialSensor> sensor;
    SerialPort port(scratch / "tty", 115200);
    std::array<std::uint8_t, 8> buffer{};
    CHECK(port.read(buffer, {}).status == IoStatus::kClosed);  // not there at first
    CHECK(port.error() == ENOENT);
    for (int i = 0; i < 3; ++i) {
        sensor.emplace(scratch / "tty");
        REQUIRE(opens(port));
        sensor->send("hello");
        CHECK(read_text(port, 5) == "hello");
        sensor.reset();
        std::string none;
        CHECK(read_some(port, none).status == IoStatus::kClosed);
        CHECK(port.error() == EIO);
        CHECK(port.write(as_bytes("x")).status == IoStatus::kClosed);
    }
}

TEST_CASE("serial port: unplugged it does not spin", "[real-kernel]") {
    const Scratch scratch;
    std::optional<FakeSerialSensor> sensor(scratch / "tty");
    SerialPort port(scratch / "tty", 115200);
    REQUIRE(opens(port));
    // Another descriptor of the same line, read as one would that knows nothing of hang-ups.
    const crspf::UniqueFd naive(::open((scratch / "tty").c_str(), O_RDONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    if (!naive.valid()) {
        WARN("skipped: no positive control, the line is exclusive here (errno " << errno << ")");
    }
    sensor.reset();
    std::array<std::uint8_t, 8> buffer{};
    const Effort effort = effort_of([&] { CHECK(port.read(buffer, kStep).status == IoStatus::kClosed); });
    CHECK(effort.calls <= 40);  // 30 of 10 ms, the loss, and the attempts to open
    CHECK(effort.load < kSpinLoad);
    if (naive.valid()) {
        const Effort spinning = effort_of([&] {
            static_cast<void>(crspf::wait_for(naive.get(), POLLIN, kStep));
            static_cast<void>(::read(naive.get(), buffer.data(), buffer.size()));
        });
        CHECK(spinning.calls > 400);
        CHECK(spinning.load > kSpinLoad);
    }
}

TEST_CASE("serial port: it is one process's, and says so", "[real-kernel]") {
    const Scratch scratch;
    const FakeSerialSensor sensor(scratch / "tty");
    SerialPort first(scratch / "tty", 115200);
    SerialPort second(scratch / "tty", 115200);
    REQUIRE(opens(first));
    std::array<std::uint8_t, 8> buffer{};
    CHECK(second.read(buffer, {}).status == IoStatus::kClosed);
    CHECK(second.error() == EBUSY);
    first.close();
    CHECK(opens(second));
}

TEST_CASE("serial port: closed it is free, even where somebody else has the terminal open", "[real-kernel]") {
    const Scratch scratch;
    const FakeSerialSensor sensor(scratch / "tty");
    const crspf::UniqueFd other(::open((scratch / "tty").c_str(), O_RDONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    REQUIRE(other.valid());
    const auto exclusive = [&other] {
        int on = -1;
        REQUIRE(::ioctl(other.get(), TIOCGEXCL, &on) == 0);
        return on != 0;
    };
    {
        SerialPort port(scratch / "tty", 115200);
        REQUIRE(opens(port));
        CHECK(exclusive());
        port.close();
        CHECK_FALSE(exclusive());
        REQUIRE(opens(port));
        CHECK(exclusive());
    }
    CHECK_FALSE(exclusive());
}

TEST_CASE("serial port: what is no line is refused") {
    const Scratch scratch;
    SerialPort port(scratch.file("plain", "text"), 115200);
    std::array<std::uint8_t, 8> buffer{};
    CHECK(port.read(buffer, {}).status == IoStatus::kClosed);
    CHECK(port.error() == ENOTTY);
}
