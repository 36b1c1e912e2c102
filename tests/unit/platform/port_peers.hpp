// The other ends of the ports under test, and how their waiting is measured.
#pragma once

#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string>
#include <string_view>

#include "platform/files/unique_fd.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "platform/linux/socket_options.hpp"
#include "platform/ports/byte_stream.hpp"

namespace crspf::test {

inline constexpr Duration kStep{10'000'000};
inline constexpr int kStepsMax = 2000;  // of patience; a test that passes needs few

inline std::span<const std::uint8_t> as_bytes(std::string_view text) {
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): text as bytes
    return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// A sensor on a serial line that can be unplugged (its object goes) and plugged in again (another one, same link).
class FakeSerialSensor {
 public:
    explicit FakeSerialSensor(const std::filesystem::path& link) : master_(::posix_openpt(O_RDWR | O_NOCTTY)) {
        REQUIRE(master_.valid());
        REQUIRE(::grantpt(master_.get()) == 0);
        REQUIRE(::unlockpt(master_.get()) == 0);
        std::error_code ignored;
        std::filesystem::remove(link, ignored);
        std::filesystem::create_symlink(::ptsname(master_.get()), link);
    }

    [[nodiscard]] int fd() const { return master_.get(); }
    void send(std::string_view text) const {
        REQUIRE(::write(fd(), text.data(), text.size()) == static_cast<ssize_t>(text.size()));
    }
    [[nodiscard]] std::string receive(std::size_t size) const {
        std::string text(size, '\0');
        for (std::size_t at = 0; at < size;) {
            const ssize_t got = ::read(fd(), text.data() + at, size - at);
            REQUIRE(got > 0);
            at += static_cast<std::size_t>(got);
        }
        return text;
    }

 private:
    UniqueFd master_;
};

/// Reads until something but "nothing yet" comes; closed counts as nothing where `connect` is set.
inline Received read_some(ByteStream& stream, std::string& text, bool connect = false) {
    std::array<std::uint8_t, 256> buffer{};
    for (int i = 0; i < kStepsMax; ++i) {
        const Received received = stream.read(buffer, kStep);
        if (received.status == IoStatus::kOk || (received.status == IoStatus::kClosed && !connect)) {
            text.append(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(received.bytes));
            return received;
        }
    }
    return {};
}

inline std::string read_text(ByteStream& stream, std::size_t size) {
    std::string text;
    while (text.size() < size && read_some(stream, text).status == IoStatus::kOk) {
    }
    return text;
}

/// Reads until the port is open.
inline bool opens(ByteStream& stream) {
    std::array<std::uint8_t, 1> buffer{};
    for (int i = 0; i < kStepsMax; ++i) {
        if (stream.read({buffer.data(), 0}, kStep).status != IoStatus::kClosed) {
            return true;
        }
    }
    return false;
}

struct Effort {
    int calls = 0;      ///< that returned within the period
    double load = 0.0;  ///< processor time over time
};

/// A wait that spins takes more than this of a processor even of a busy machine; one that sleeps takes less than this
/// even under a sanitizer, where the attempts to open alone have been seen to cost 0.013.
constexpr double kSpinLoad = 0.1;

/// What it costs to call `wait` over and over for 300 ms. Reads clocks: that is what is to be proven. The processor
/// time is this thread's own, so that a busy machine does not change it.
template <typename Wait>
Effort effort_of(Wait wait) {
    const Stamp begin = monotonic_now();
    const Stamp begin_cpu = clock_now(CLOCK_THREAD_CPUTIME_ID);
    Effort effort;
    while (monotonic_now() - begin < Duration{300'000'000}) {
        wait();
        ++effort.calls;
    }
    effort.load = (clock_now(CLOCK_THREAD_CPUTIME_ID) - begin_cpu).seconds() / (monotonic_now() - begin).seconds();
    return effort;
}

/// A socket on 127.0.0.`host`, on a port that the kernel chooses or on the given one.
class LoopbackSocket {
 public:
    explicit LoopbackSocket(int type, std::uint8_t host = 1, std::uint16_t port = 0)
        : fd_(::socket(AF_INET, type | SOCK_CLOEXEC, 0)) {
        REQUIRE(fd_.valid());
        REQUIRE(set_option(fd_.get(), SOL_SOCKET, SO_REUSEADDR, type == SOCK_STREAM ? 1 : 0));
        const sockaddr_in own = socket_address(0x7F000000U | host, port);
        REQUIRE(::bind(fd_.get(), any_address(own), sizeof(own)) == 0);
        if (type == SOCK_STREAM) {
            REQUIRE(::listen(fd_.get(), 1) == 0);
        }
    }

    [[nodiscard]] int fd() const { return fd_.get(); }
    [[nodiscard]] std::uint16_t port() const {
        sockaddr_in own{};
        socklen_t size = sizeof(own);
        // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): POSIX's way to pass addresses
        REQUIRE(::getsockname(fd(), reinterpret_cast<sockaddr*>(&own), &size) == 0);
        return ntohs(own.sin_port);
    }
    void send_to(std::uint16_t port, std::string_view text) const {
        const sockaddr_in to = socket_address(0x7F000001, port);
        REQUIRE(::sendto(fd(), text.data(), text.size(), 0, any_address(to), sizeof(to)) ==
                static_cast<ssize_t>(text.size()));
    }
    [[nodiscard]] UniqueFd accept() const {
        REQUIRE(wait_for(fd(), POLLIN, {kStepsMax * kStep.ns}) == POLLIN);
        return UniqueFd(::accept4(fd(), nullptr, nullptr, SOCK_CLOEXEC));
    }

 private:
    UniqueFd fd_;
};

/// One that nobody listens on now.
inline std::uint16_t free_port(int type) {
    return LoopbackSocket(type).port();
}

}  // namespace crspf::test
