#include "drivers/scip/scip_parser.hpp"

namespace crspf {
namespace {

constexpr std::uint8_t kLineFeed = '\n';

// The next line, without its line feed; moves `from` behind it.
Bytes next_line(Bytes& from) {
    const auto end = std::find(from.begin(), from.end(), kLineFeed);
    const auto length = static_cast<std::size_t>(end - from.begin());
    const Bytes line = from.first(length);
    from = from.subspan(std::min(length + 1, from.size()));
    return line;
}

bool is_upper(std::uint8_t c) {
    return c >= 'A' && c <= 'Z';
}

enum class Verdict { kReply, kNoShape, kBadSum };

// `block` without its blank line: echo, status, lines.
Verdict read_block(Bytes block, ScipReply& reply) {
    Bytes rest = block;
    reply.echo = next_line(rest);
    const Bytes status = next_line(rest);
    if (reply.echo.size() < 2 || !(is_upper(reply.echo[0]) || reply.echo[0] == '%') || !is_upper(reply.echo[1])) {
        return Verdict::kNoShape;
    }
    reply.body = rest;
    if (status.size() == 1) {
        reply.status = status;
        return Verdict::kReply;
    }
    if (status.size() != 3) {
        return Verdict::kNoShape;
    }
    if (!scip_line_ok(status)) {
        return Verdict::kBadSum;
    }
    reply.status = status.first(2);
    const bool text =
        is_text(reply.echo.first(2), "VV") || is_text(reply.echo.first(2), "PP") || is_text(reply.echo.first(2), "II");
    while (!rest.empty()) {
        const Bytes line = next_line(rest);
        if (!(text ? scip_text_line_ok(line) : scip_line_ok(line))) {
            return Verdict::kBadSum;
        }
    }
    return Verdict::kReply;
}

}  // namespace

bool ScipParser::push(std::uint8_t c, Stamp received) {
    const bool blank = c == kLineFeed && last_ == kLineFeed;
    last_ = c;
    if (skipping_) {
        ++counters_.bytes_dropped;
        skipping_ = !blank;
        return false;
    }
    if (size_ == 0) {
        if (c == kLineFeed) {
            return false;
        }
        received_ = received;
    }
    if (blank) {
        return true;
    }
    if (size_ == kBytes) {
        ++counters_.overflow;
        counters_.bytes_dropped += size_ + 1;
        size_ = 0;
        skipping_ = true;
        return false;
    }
    buffer_[size_++] = c;
    return false;
}

bool ScipParser::take(ScipReply& reply) {
    const Bytes block = Bytes(buffer_).first(size_);
    reply.received = received_;
    const Verdict verdict = read_block(block, reply);
    if (verdict == Verdict::kReply) {
        ++counters_.replies;
        return true;
    }
    ++(verdict == Verdict::kBadSum ? counters_.bad_sum : counters_.bad_shape);
    // A reply may begin within: its predecessor lost its blank line. Only a whole one counts: two lines of data are no
    // echo and status, as a status has three characters.
    Bytes rest = block;
    for (static_cast<void>(next_line(rest)); !rest.empty(); static_cast<void>(next_line(rest))) {
        if (read_block(rest, reply) == Verdict::kReply && !reply.scip1()) {
            ++counters_.replies;
            counters_.bytes_dropped += size_ - rest.size();
            return true;
        }
    }
    counters_.bytes_dropped += size_;
    return false;
}

Bytes scip_text_value(Bytes body, Bytes key) {
    while (!body.empty()) {
        const Bytes line = next_line(body);
        if (line.size() >= key.size() && std::equal(key.begin(), key.end(), line.begin())) {
            const Bytes value = line.subspan(key.size());
            for (std::size_t i = value.size(); i > 0; --i) {
                if (value[i - 1] == ';') {
                    return value.first(i - 1);
                }
            }
        }
    }
    return {};
}

bool decode_scan(Bytes body, const ScipScanRequest& request, ScipRanges& out) {
    const std::size_t chars = scip_chars(request.encoding);
    const std::size_t beams = request.beams();
    const Bytes stamp = next_line(body);
    if (beams > capacity::kBeams || stamp.size() != 5 || !std::all_of(stamp.begin(), stamp.end(), is_scip_char)) {
        return false;
    }
    out.stamp_ms = scip_decode(stamp.first(4));
    out.count = 0;
    std::size_t left = beams * chars;
    std::uint32_t value = 0;
    std::uint32_t range = 0;
    std::size_t digits = 0;
    const std::size_t digits_each = chars == 6 ? 3 : chars;
    std::size_t values = 0;
    while (left > 0) {
        const std::size_t length = std::min(left, kScipLineChars);
        const Bytes line = next_line(body);
        if (line.size() != length + 1) {
            return false;
        }
        for (const std::uint8_t c : line.first(length)) {
            if (!is_scip_char(c)) {
                return false;
            }
            value = (value << 6U) | (c - std::uint32_t{kScipZero});
            if (++digits < digits_each) {
                continue;
            }
            if (chars != 6 || values % 2 == 0) {
                if (value > 0xFFFF) {
                    return false;
                }
                range = value;
            }
            if (chars != 6 || values % 2 == 1) {
                out.range_mm[out.count] = range;
                out.intensity[out.count] = chars == 6 ? value : 0;
                ++out.count;
            }
            ++values;
            value = 0;
            digits = 0;
        }
        left -= length;
    }
    return body.empty();
}

}  // namespace crspf
