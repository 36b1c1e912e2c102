// Whatever the datagrams: each is counted once, and what comes of it is a motion. The input is records of one byte that
// says what is received and for how long there was silence. A record of kind 0 holds a whole datagram; other kinds
// change a few bytes of the last one and put its sum right, so that the search need not find a CRC.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "drivers/common/byte_reader.hpp"
#include "drivers/motion/crc32.hpp"
#include "drivers/motion/motion_decoder.hpp"

namespace {

using namespace crspf;

constexpr std::size_t kSumAt = kMotionBytes - 4;

void require(bool promise) {
    if (!promise) {
        std::abort();
    }
}

void check(const MotionSample& sample) {
    const Pose2& step = sample.P_previous_base;
    require(std::hypot(step.x_m, step.y_m) <= 10.0 + 1e-9 && std::abs(step.theta_rad) <= kPi);
    require(sample.translation_variance_m2 >= 0.0 && std::isfinite(sample.translation_variance_m2));
    require(sample.rotation_variance_rad2 >= 0.0 && std::isfinite(sample.rotation_variance_rad2));
}

std::uint64_t sum(const MotionCounters& n) {
    return n.samples + n.bad_length + n.bad_magic + n.bad_version + n.bad_crc + n.bad_age + n.not_finite + n.ran_back;
}

void check_codec(std::span<const std::uint8_t> bytes) {
    MotionDatagram datagram;
    if (decode(bytes, datagram) == MotionFault::kNone) {
        std::array<std::uint8_t, kMotionBytes> again{};
        require(encode(datagram, again) == again.size());
        require(std::equal(again.begin(), again.end(), bytes.begin()));
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    ByteReader in(std::span<const std::uint8_t>(data, size));
    MotionDecoder decoder;
    std::array<std::uint8_t, kMotionBytes> last{};
    Stamp received{1'000'000'000};
    std::uint64_t datagrams = 0;
    while (in.left() > 0) {
        const std::uint8_t kind = in.byte();
        received = received + Duration{std::int64_t{1'000'000} << (kind >> 4U)};
        std::span<const std::uint8_t> datagram = last;
        if (kind % 4 == 0) {
            datagram = in.take(std::min(in.left(), kMotionBytes));
            std::copy(datagram.begin(), datagram.end(), last.begin());
        } else {
            for (int change = 0; change < kind % 4; ++change) {
                const std::size_t at = in.byte() % kSumAt;
                last[at] = in.byte();
            }
            const std::uint32_t right = crc32(std::span(last).first(kSumAt));
            for (std::size_t i = 0; i < 4; ++i) {
                last[kSumAt + i] = static_cast<std::uint8_t>(right >> (8 * i));
            }
        }
        check_codec(datagram);
        if (const auto sample = decoder.on_datagram(datagram, received)) {
            check(*sample);
            require(sample->stamp <= received);
        }
        ++datagrams;
    }
    require(sum(decoder.counters()) == datagrams);
    return 0;
}
