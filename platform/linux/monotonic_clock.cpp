#include "platform/linux/monotonic_clock.hpp"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <limits>

namespace crspf {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

}  // namespace

timespec timespec_of(Stamp stamp) {
    const std::int64_t ns = std::max<std::int64_t>(stamp.ns, 0);
    // 68 years after the start is never, and all that fits where std::time_t has 32 bits.
    constexpr std::int64_t kLast = std::numeric_limits<std::int32_t>::max();
    return {.tv_sec = static_cast<std::int32_t>(std::min(ns / kSecond_ns, kLast)),
            .tv_nsec = static_cast<std::int32_t>(ns % kSecond_ns)};
}

Stamp clock_now(int clock_id) {
    timespec now{};
    ::clock_gettime(clock_id, &now);
    return {std::int64_t{now.tv_sec} * kSecond_ns + now.tv_nsec};
}

Stamp monotonic_now() {
    return clock_now(CLOCK_MONOTONIC);
}

void sleep_until(Stamp deadline) {
    const timespec until = timespec_of(deadline);
    while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
    }
}

short wait_for(int fd, short events, Duration wait) {
    pollfd entry{.fd = fd, .events = events, .revents = 0};
    const timespec timeout = timespec_of(Stamp{} + wait);
    return ::ppoll(&entry, 1, &timeout, nullptr) > 0 ? entry.revents : short{0};
}

}  // namespace crspf
