// How long to wait before the next attempt, when attempts keep failing.
#pragma once

#include <algorithm>

#include "core/base/time.hpp"

namespace crspf {

/// Doubles from `first` up to `longest`, for as long as it is asked; never gives up. Wait-free.
class Backoff {
 public:
    constexpr Backoff(Duration first, Duration longest) : first_(first), longest_(longest), next_(first) {}

    /// The wait before the coming attempt; the one after it waits twice as long.
    constexpr Duration next() {
        const Duration wait = next_;
        next_.ns = next_.ns > longest_.ns / 2 ? longest_.ns : next_.ns * 2;
        return std::min(wait, longest_);
    }
    /// An attempt succeeded.
    constexpr void reset() { next_ = first_; }

 private:
    Duration first_;
    Duration longest_;
    Duration next_;
};

}  // namespace crspf
