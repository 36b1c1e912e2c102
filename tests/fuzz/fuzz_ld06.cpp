// Whatever comes along the line of an LD06: each byte is part of a packet or counted, and what becomes a scan is one.
// The input is records of two bytes that say what comes; the second kind is a packet with a few bytes set and its sum
// put right, so that the search need not find a CRC.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>
#include <utility>

#include "drivers/common/byte_reader.hpp"
#include "drivers/ldrobot/ld06_listener.hpp"

namespace {

using namespace crspf;

void require(bool promise) {
    if (!promise) {
        std::abort();
    }
}

void check(const Scan& scan) {
    require(scan.count > 0 && scan.count <= capacity::kBeams);
    require(scan.angle_increment_rad > 0.0 && scan.time_per_beam_s < 0.0);
    require(std::abs(scan.angle_min_rad) < 7.0);
    require(scan.count * scan.angle_increment_rad < 6.6);
    for (std::uint32_t i = 0; i < scan.count; ++i) {
        require(scan.beam[i] != Beam::kHit || (scan.range_m[i] > 0.0F && scan.range_m[i] < 66.0F));
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    ByteReader in(std::span<const std::uint8_t>(data, size));
    const auto listener = std::make_unique<Ld06Listener>();
    std::array<std::uint8_t, kLd06Bytes> packet{kLd06Start, kLd06Kind, 0x10, 0x0E};
    packet[42] = 0x70;  // 8.8 degrees
    packet[43] = 0x03;
    std::uint64_t fed = 0;
    Stamp now{1'000'000'000};
    while (in.left() > 0) {
        const std::uint8_t kind = in.byte();
        const std::uint8_t length = in.byte();
        now = now + Duration{std::int64_t{1'000'000} << (kind >> 4U)};
        std::span<const std::uint8_t> bytes = packet;
        if (kind % 4 == 0) {
            bytes = in.take(std::min<std::size_t>(in.left(), length));
        } else if (kind % 4 == 1) {
            // The next packet of a sensor that turns: by as much as `length` says, 0.1 degrees a step.
            const unsigned first_cdeg = (unsigned{packet[42]} | unsigned{packet[43]} << 8U) + 80U;
            for (const auto& [at, cdeg] :
                 {std::pair<std::size_t, unsigned>{4, first_cdeg}, {42, first_cdeg + 10U * length}}) {
                packet[at] = static_cast<std::uint8_t>(cdeg % kLd06Turn_cdeg);
                packet[at + 1] = static_cast<std::uint8_t>(cdeg % kLd06Turn_cdeg >> 8U);
            }
        } else {
            for (int change = 0; change < length % 8; ++change) {
                packet[2 + in.byte() % (kLd06Bytes - 3)] = in.byte();
            }
        }
        packet[kLd06Bytes - 1] = ld06_crc(std::span(packet).first(kLd06Bytes - 1));
        if (kind % 16 == 15) {
            listener->on_open();
        }
        listener->on_bytes(bytes, now, check);
        fed += bytes.size();
    }
    listener->on_open();  // what waits for the rest of a packet is dropped
    const Ld06ParserCounters& counters = listener->parser_counters();
    require(counters.packets * kLd06Bytes + counters.bytes_dropped == fed);
    return 0;
}
