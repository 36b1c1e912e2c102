// A number for a trajectory: two runs that found the same poses, to the bit, have the same.
#pragma once

#include <span>
#include <string>

#include "platform/files/trajectory.hpp"

namespace crspf {

/// SHA-256 of the poses' bits, as hexadecimal digits. Stamps do not count.
[[nodiscard]] std::string digest_of(std::span<const TimedPose> trajectory);

}  // namespace crspf
