// Errors of measurements, the same on every machine.
#pragma once

#include "core/base/rng.hpp"

namespace crspf::test {

/// Almost normal, of standard deviation 1: a sum of three uniform numbers, each of a variance of a third.
inline double scatter(Rng& random) {
    return random.symmetric() + random.symmetric() + random.symmetric();
}

}  // namespace crspf::test
