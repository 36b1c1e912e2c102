#include "drivers/motion/motion_codec.hpp"

#include <algorithm>
#include <array>

#include "drivers/common/byte_reader.hpp"
#include "drivers/common/byte_writer.hpp"
#include "drivers/motion/crc32.hpp"

namespace crspf {
namespace {

constexpr std::array<std::uint8_t, 4> kMagic{'C', 'R', 'S', 'M'};
constexpr std::uint8_t kVersion = 1;
constexpr std::uint8_t kBlind = 0x01;
constexpr std::size_t kCrcBytes = 4;

}  // namespace

MotionFault decode(std::span<const std::uint8_t> payload, MotionDatagram& out) {
    if (payload.size() != kMotionBytes) {
        return MotionFault::kLength;
    }
    ByteReader in(payload);
    const auto magic = in.take(kMagic.size());
    if (!std::equal(magic.begin(), magic.end(), kMagic.begin())) {
        return MotionFault::kMagic;
    }
    if (in.byte() != kVersion) {
        return MotionFault::kVersion;
    }
    const std::uint8_t flags = in.byte();
    const auto reserved = in.little<std::uint16_t>();
    out.blind = (flags & kBlind) != 0;
    out.session = in.little<std::uint32_t>();
    out.sequence = in.little<std::uint32_t>();
    out.age = {in.little<std::int64_t>()};
    out.P_odom_base.x_m = in.little_double();
    out.P_odom_base.y_m = in.little_double();
    out.P_odom_base.theta_rad = in.little_double();
    out.translation_variance_m2 = in.little_double();
    out.rotation_variance_rad2 = in.little_double();
    if (in.little<std::uint32_t>() != crc32(payload.first(kMotionBytes - kCrcBytes))) {
        return MotionFault::kCrc;
    }
    return (flags & ~kBlind) != 0 || reserved != 0 ? MotionFault::kVersion : MotionFault::kNone;
}

std::size_t encode(const MotionDatagram& motion, std::span<std::uint8_t> out) {
    if (out.size() < kMotionBytes) {
        return 0;
    }
    ByteWriter to(out.first(kMotionBytes));
    to.bytes(kMagic);
    to.byte(kVersion);
    to.byte(motion.blind ? kBlind : 0);
    to.little(std::uint16_t{0});
    to.little(motion.session);
    to.little(motion.sequence);
    to.little(motion.age.ns);
    to.little_double(motion.P_odom_base.x_m);
    to.little_double(motion.P_odom_base.y_m);
    to.little_double(motion.P_odom_base.theta_rad);
    to.little_double(motion.translation_variance_m2);
    to.little_double(motion.rotation_variance_rad2);
    to.little(crc32(to.written()));
    return to.ok() ? to.position() : 0;
}

}  // namespace crspf
