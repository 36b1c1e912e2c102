#include "drivers/sick/lms2xx_parser.hpp"

#include "drivers/common/byte_reader.hpp"

namespace crspf {
namespace {

constexpr std::uint8_t kStx = 0x02;
constexpr std::size_t kHeader = 4;

}  // namespace

void Lms2xxParser::reset() {
    counters_.bytes_skipped += end_ - begin_;
    begin_ = end_ = 0;
}

void Lms2xxParser::drop(std::size_t n) {
    begin_ += n;
    counters_.bytes_skipped += n;
}

std::size_t Lms2xxParser::append(std::span<const std::uint8_t> bytes) {
    if (begin_ > 0) {
        std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_),
                  buffer_.begin() + static_cast<std::ptrdiff_t>(end_), buffer_.begin());
        end_ -= begin_;
        begin_ = 0;
    }
    const std::size_t n = std::min(bytes.size(), buffer_.size() - end_);
    std::copy_n(bytes.begin(), n, buffer_.begin() + static_cast<std::ptrdiff_t>(end_));
    end_ += n;
    return n;
}

bool Lms2xxParser::next(Lms2xxMessage& message) {
    while (begin_ < end_) {
        const std::span<const std::uint8_t> pending = std::span(buffer_).subspan(begin_, end_ - begin_);
        if (pending[0] == kLms2xxAck || pending[0] == kLms2xxNack) {
            message = {pending[0] == kLms2xxAck ? Lms2xxMessage::Kind::kAck : Lms2xxMessage::Kind::kNack, 0, {}};
            ++begin_;
            return true;
        }
        if (pending[0] != kStx || (pending.size() > 1 && (pending[1] & 0x7FU) != 0)) {
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
        begin_ += length + kLms2xxFrame;
        ++counters_.telegrams;
        return true;
    }
    return false;
}

}  // namespace crspf
