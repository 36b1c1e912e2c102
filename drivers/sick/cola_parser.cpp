#include "drivers/sick/cola_parser.hpp"

#include <algorithm>

namespace crspf {
namespace {

constexpr std::size_t kBinaryHeader = 8;
constexpr std::size_t kKind = 4;  // three letters and a space
constexpr std::size_t kLeastPayload = 5;

// Whether `bytes` begin as a CoLa-B telegram does, as far as they go.
bool begins_binary(std::span<const std::uint8_t> bytes) {
    for (std::size_t i = 0; i < std::min<std::size_t>(4, bytes.size()); ++i) {
        if (bytes[i] != kColaStart) {
            return false;
        }
    }
    if (bytes.size() < kBinaryHeader) {
        return true;
    }
    ByteReader reader(bytes.subspan(4));
    const auto length = reader.big<std::uint32_t>();
    if (length < kLeastPayload || length > kLargestColaPayload) {
        return false;
    }
    return bytes.size() < kBinaryHeader + kKind ||
           (is_cola_kind(bytes.subspan(kBinaryHeader, kKind - 1)) && bytes[kBinaryHeader + kKind - 1] == ' ');
}

}  // namespace

void ColaParser::reset() {
    counters_.bytes_skipped += buffer_.pending().size();
    buffer_.clear();
    looked_at_ = 0;
}

ColaParser::Step ColaParser::drop(std::size_t n) {
    buffer_.consume(n);
    looked_at_ = 0;
    counters_.bytes_skipped += n;
    return Step::kDropped;
}

bool ColaParser::next(ColaTelegram& telegram) {
    for (;;) {
        const std::span<const std::uint8_t> all = buffer_.pending();
        const auto stx = std::find(all.begin(), all.end(), kColaStart);
        const auto junk = static_cast<std::size_t>(stx - all.begin());
        if (junk > 0) {
            drop(junk);
        }
        const std::span<const std::uint8_t> pending = all.subspan(junk);
        if (pending.size() < 2) {
            return false;
        }
        switch (pending[1] == kColaStart ? binary(pending, telegram) : ascii(pending, telegram)) {
            case Step::kTelegram: ++counters_.telegrams; return true;
            case Step::kNeedMore: return false;
            case Step::kDropped: break;
        }
    }
}

ColaParser::Step ColaParser::binary(std::span<const std::uint8_t> pending, ColaTelegram& telegram) {
    if (!begins_binary(pending)) {
        return drop(1);
    }
    if (pending.size() < kBinaryHeader + kKind) {
        return Step::kNeedMore;
    }
    ByteReader reader(pending.subspan(4));
    const std::size_t length = reader.big<std::uint32_t>();
    if (pending.size() < length + kColaFrame) {
        // Twelve bytes that all fit a header do not occur within ranges.
        std::size_t at = std::max<std::size_t>(looked_at_, 1);
        for (; at + kBinaryHeader + kKind <= pending.size(); ++at) {
            if (pending[at] == kColaStart && begins_binary(pending.subspan(at))) {
                ++counters_.broken_off;
                return drop(at);
            }
        }
        looked_at_ = at;
        return Step::kNeedMore;
    }
    telegram = {ColaDialect::kBinary, pending.subspan(kBinaryHeader, length)};
    if (cola_sum(telegram.payload) != pending[kBinaryHeader + length]) {
        ++counters_.bad_sums;
        return drop(1);
    }
    buffer_.consume(length + kColaFrame);
    looked_at_ = 0;
    return Step::kTelegram;
}

ColaParser::Step ColaParser::ascii(std::span<const std::uint8_t> pending, ColaTelegram& telegram) {
    if (pending[1] != 's' ||
        (pending.size() > kKind && (!is_cola_kind(pending.subspan(1, kKind - 1)) || pending[kKind] != ' '))) {
        return drop(1);
    }
    std::size_t at = std::max<std::size_t>(looked_at_, 1);
    while (at < pending.size() && pending[at] >= ' ') {
        ++at;
    }
    if (at > 1 + kLargestColaPayload || (at < pending.size() && pending[at] != kColaEnd)) {
        ++counters_.bad_characters;
        return drop(1);
    }
    if (at == pending.size()) {
        looked_at_ = at;
        return Step::kNeedMore;
    }
    if (at < 1 + kLeastPayload) {
        return drop(1);
    }
    telegram = {ColaDialect::kAscii, pending.subspan(1, at - 1)};
    buffer_.consume(at + 1);
    looked_at_ = 0;
    return Step::kTelegram;
}

}  // namespace crspf
