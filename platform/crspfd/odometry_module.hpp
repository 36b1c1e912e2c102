// The odometry's thread (paper Section 3): every sample moves P~ at once, whatever the filter does.
#pragma once

#include "core/odometry/odometry.hpp"
#include "platform/crspfd/exchange.hpp"

namespace crspf {

/// One thread's. turn(): no heap, no lock, no throw; linear in what has come.
class OdometryModule {
 public:
    OdometryModule(const OdometryParams& params, Exchange& exchange) : odometry_(params), exchange_(exchange) {}

    /// Takes what has come. True where a sample was among it.
    bool turn(Stamp now);
    /// From the newest sample's reception to the turn that took it.
    [[nodiscard]] Duration latency() const { return state_.latency; }

 private:
    bool take_corrections();
    bool take_motions(Stamp now);
    void publish();

    Odometry odometry_;
    Exchange& exchange_;
    OdometryState state_;
};

}  // namespace crspf
