// The time, for those who must not ask the system themselves.
#pragma once

#include "core/base/time.hpp"

namespace crspf {

class Clock {
 public:
    virtual ~Clock() = default;
    /// Never runs back, whatever happens to the calendar.
    [[nodiscard]] virtual Stamp now() = 0;
};

}  // namespace crspf
