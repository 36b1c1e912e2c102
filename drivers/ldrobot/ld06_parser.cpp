#include "drivers/ldrobot/ld06_parser.hpp"

namespace crspf {

void Ld06Parser::clear() {
    drop(buffer_.pending().size());
}

void Ld06Parser::drop(std::size_t n) {
    buffer_.consume(n);
    counters_.bytes_dropped += n;
}

bool Ld06Parser::next(Ld06Packet& packet) {
    while (!buffer_.pending().empty()) {
        const std::span<const std::uint8_t> pending = buffer_.pending();
        if (pending[0] != kLd06Start || (pending.size() > 1 && pending[1] != kLd06Kind)) {
            drop(1);
            continue;
        }
        if (pending.size() < kLd06Bytes) {
            return false;
        }
        if (!decode_ld06(pending.first(kLd06Bytes), packet)) {
            ++counters_.bad_sum;
            drop(1);  // the next packet may begin within this one
            continue;
        }
        if (!is_plausible(packet)) {
            ++counters_.implausible;
            drop(kLd06Bytes);
            continue;
        }
        buffer_.consume(kLd06Bytes);
        ++counters_.packets;
        return true;
    }
    return false;
}

}  // namespace crspf
