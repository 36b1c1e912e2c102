#include "drivers/sick/lms2xx_parser.hpp"

#include "drivers/common/byte_reader.hpp"

namespace crspf {
namespace {

constexpr std::size_t kHeader = 4;

}  // namespace

void Lms2xxParser::reset() {
    counters_.bytes_skipped += buffer_.pending().size();
    buffer_.clear();
}

void Lms2xxParser::drop(std::size_t n) {
    buffer_.consume(n);
    counters_.bytes_skipped += n;
}

bool Lms2xxParser::next(Lms2xxMessage& message) {
    while (!buffer_.pending().empty()) {
        const std::span<const std::uint8_t> pending = buffer_.pending();
        if (pending[0] == kLms2xxAck || pending[0] == kLms2xxNack) {
            message = {pending[0] == kLms2xxAck ? Lms2xxMessage::Kind::kAck : Lms2xxMessage::Kind::kNack, 0, {}};
            buffer_.consume(1);
            return true;
        }
        if (pending[0] != kLms2xxStart || (pending.size() > 1 && (pending[1] & 0x7FU) != 0)) {
            drop(1);
            continue;
        }
        if (pending.size() < kHeader) {
            return false;
        }
        ByteReader reader(pending.subspan(2));
        const std::size_t length = reader.little<std::uint16_t>();
        if (length == 0 || length > kLargestLms2xxPayload) {
            drop(1);
            continue;
        }
        if (pending.size() < length + kLms2xxFrame) {
            return false;
        }
        message = {Lms2xxMessage::Kind::kTelegram, pending[1], reader.take(length)};
        if (reader.little<std::uint16_t>() != lms2xx_crc(pending.first(kHeader + length))) {
            ++counters_.bad_sums;
            drop(1);
            continue;
        }
        buffer_.consume(length + kLms2xxFrame);
        ++counters_.telegrams;
        return true;
    }
    return false;
}

}  // namespace crspf
