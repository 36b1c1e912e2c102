// CLOCK_MONOTONIC, and waiting by it.
#pragma once

#include "platform/ports/clock.hpp"

namespace crspf {

[[nodiscard]] Stamp monotonic_now();

/// Of a system clock (time.h).
[[nodiscard]] Stamp clock_now(int clock_id);

void sleep_until(Stamp deadline);

/// poll() for one descriptor: what happened of `events`, POLLERR, POLLHUP and POLLNVAL; 0 where nothing did in time.
[[nodiscard]] short wait_for(int fd, short events, Duration wait);

class MonotonicClock final : public Clock {
 public:
    [[nodiscard]] Stamp now() override { return monotonic_now(); }
};

}  // namespace crspf
