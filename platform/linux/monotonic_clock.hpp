// CLOCK_MONOTONIC, and waiting by it.
#pragma once

#include <ctime>

#include "platform/ports/clock.hpp"

namespace crspf {

[[nodiscard]] Stamp monotonic_now();

/// Of a system clock (time.h).
[[nodiscard]] Stamp clock_now(int clock_id);

void sleep_until(Stamp deadline);

/// Of an instant on the monotonic clock; before its beginning: its beginning; 68 years or more after that: then.
[[nodiscard]] timespec timespec_of(Stamp stamp);

/// poll() for one descriptor: what happened of `events`, POLLERR, POLLHUP and POLLNVAL; 0 where nothing did in time.
[[nodiscard]] short wait_for(int fd, short events, Duration wait);

class MonotonicClock final : public Clock {
 public:
    [[nodiscard]] Stamp now() override { return monotonic_now(); }
};

}  // namespace crspf
