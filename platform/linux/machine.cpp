#include "platform/linux/machine.hpp"

#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <sys/socket.h>
#include <sys/timex.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>
#include <limits>
#include <system_error>
#include <thread>

#include "platform/files/unique_fd.hpp"
#include "platform/linux/socket_options.hpp"

namespace crspf {
namespace {

int try_fifo(int priority) {
    int error = 0;
    std::thread([&error, priority] {
        const sched_param wanted{.sched_priority = priority};
        error = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &wanted);
    }).join();
    return error;
}

std::int64_t timer_resolution_ns() {
    timespec resolution{};
    if (::clock_getres(CLOCK_MONOTONIC, &resolution) != 0) {
        return std::numeric_limits<std::int64_t>::max();
    }
    return std::int64_t{resolution.tv_sec} * 1'000'000'000 + resolution.tv_nsec;
}

std::optional<bool> clock_synchronised() {
    timex state{};  // no mode: reads
    const int status = ::adjtimex(&state);
    if (status < 0) {
        return std::nullopt;
    }
    return status != TIME_ERROR && (static_cast<unsigned>(state.status) & unsigned{STA_UNSYNC}) == 0;
}

int access_of(const std::filesystem::path& file) {
    return ::faccessat(AT_FDCWD, file.c_str(), R_OK | W_OK, AT_EACCESS) == 0 ? 0 : errno;
}

std::optional<std::uint64_t> free_bytes(const std::filesystem::path& directory) {
    std::error_code error;
    const std::filesystem::space_info space = std::filesystem::space(directory, error);
    return error ? std::nullopt : std::optional<std::uint64_t>(space.available);
}

int try_udp(std::uint32_t address, std::uint16_t port) {
    const UniqueFd fd(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    const sockaddr_in own = socket_address(address, port);
    return fd.valid() && ::bind(fd.get(), any_address(own), sizeof(own)) == 0 ? 0 : errno;
}

int route_to(std::uint32_t address) {
    // To connect a datagram socket looks up the route and sends nothing. The port does not matter, but must not be 0.
    const UniqueFd fd(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    const sockaddr_in to = socket_address(address, 9);
    return fd.valid() && ::connect(fd.get(), any_address(to), sizeof(to)) == 0 ? 0 : errno;
}

}  // namespace

Machine this_machine() {
    return {.root = "/",
            .try_fifo = try_fifo,
            .timer_resolution_ns = timer_resolution_ns,
            .clock_synchronised = clock_synchronised,
            .access = access_of,
            .free_bytes = free_bytes,
            .try_udp = try_udp,
            .route_to = route_to,
            .can_link = read_can_link};
}

}  // namespace crspf
