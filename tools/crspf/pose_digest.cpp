#include "tools/crspf/pose_digest.hpp"

#include <array>
#include <bit>
#include <climits>
#include <cstddef>
#include <cstdint>

#include "platform/files/sha256.hpp"

namespace crspf {

std::string digest_of(std::span<const TimedPose> trajectory) {
    Sha256 sha;
    for (const TimedPose& pose : trajectory) {
        std::array<std::byte, 24> bytes{};
        std::size_t at = 0;
        for (const double v : {pose.P_map_base.x_m, pose.P_map_base.y_m, pose.P_map_base.theta_rad}) {
            const auto bits = std::bit_cast<std::uint64_t>(v);
            for (unsigned shift = 0; shift < 64; shift += CHAR_BIT) {
                bytes.at(at++) = static_cast<std::byte>(bits >> shift);
            }
        }
        sha.update(bytes);
    }
    return sha.hex();
}

}  // namespace crspf
