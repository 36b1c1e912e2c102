// Not oftener than each so long.
#pragma once

#include "core/base/time.hpp"

namespace crspf::mqtt {

class Pace {
 public:
    explicit Pace(Duration period) : period_(period) {}

    /// The first time always.
    [[nodiscard]] bool due(Stamp now) const { return !done_ || now - last_ >= period_; }
    void done(Stamp now) {
        done_ = true;
        last_ = now;
    }

 private:
    Duration period_;
    bool done_ = false;
    Stamp last_;
};

}  // namespace crspf::mqtt
