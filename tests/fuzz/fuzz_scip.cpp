// Whatever a SCIP sensor, or something that is none, sends: scans that keep their promises, and no end of attempts.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "drivers/scip/scip_device.hpp"
#include "drivers/scip/scip_session.hpp"

namespace {

void require(bool promise) {
    if (!promise) {
        std::abort();
    }
}

void check_scan(const crspf::Scan& scan) {
    require(scan.count > 0 && scan.count <= crspf::capacity::kBeams);
    require(std::isfinite(scan.angle_min_rad) && scan.angle_increment_rad > 0.0);
    for (std::uint32_t i = 0; i < scan.count; ++i) {
        require(scan.beam[i] != crspf::Beam::kHit || scan.range_m[i] > 0.0F);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) {
        return 0;
    }
    // The first byte chooses the settings; blocks of the rest come 10 ms apart.
    crspf::ScipParams params;
    params.baud = (data[0] & 1U) != 0 ? 115'200 : 0;
    params.encoding = static_cast<crspf::ScipEncoding>((data[0] >> 1U) % 3);
    params.synchronise = (data[0] & 8U) != 0;
    static crspf::ScipSession session(params);
    session = crspf::ScipSession(params);
    static crspf::ScipDevice device({});
    device.power_on({});
    static std::uint8_t reply[1U << 16U];

    crspf::Bytes rest(data + 1, size - 1);
    crspf::Stamp now{1'000'000'000};
    while (!rest.empty()) {
        session.on_time(now);
        if (session.wants_port()) {
            session.on_open(now);
        }
        session.sent(now);
        std::size_t length = 1;
        while (length < rest.size() && !(rest[length - 1] == '\n' && rest[length] == '\n')) {
            ++length;
        }
        length = length < rest.size() ? length + 1 : length;
        session.on_bytes(rest.first(length), now, check_scan);
        crspf::ByteWriter out(reply);
        device.on_bytes(rest.first(length), now, out);
        device.on_revolution(now, {}, {}, out);
        rest = rest.subspan(length);
        now.ns += 10'000'000;
    }
    return 0;
}
