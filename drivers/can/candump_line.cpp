#include "drivers/can/candump_line.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <system_error>

namespace crspf {
namespace {

constexpr std::size_t kInterfaceMax = 21;            // as canplayer reads it
constexpr std::int64_t kSecondsMax = 9'223'372'035;  // their nanoseconds fit: the year 2262
constexpr std::uint32_t kErrorFlag = 0x20000000;
constexpr std::uint32_t kIdMax = 0x1FFFFFFF;
constexpr std::uint32_t kStandardIdMax = 0x7FF;

/// The value of a hexadecimal digit, 16 for anything else.
unsigned nibble(char c) {
    if (c >= '0' && c <= '9') {
        return static_cast<unsigned>(c - '0');
    }
    const char upper = c >= 'a' && c <= 'f' ? static_cast<char>(c - 'a' + 'A') : c;
    return upper >= 'A' && upper <= 'F' ? static_cast<unsigned>(upper - 'A') + 10 : 16;
}

constexpr std::array<std::uint8_t, 16> kFdLengths = {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};

bool fd_length(std::size_t bytes) {
    return std::find(kFdLengths.begin(), kFdLengths.end(), bytes) != kFdLengths.end();
}

class Reader {
 public:
    explicit Reader(std::string_view line) : line_(line) {}

    CandumpLine read() {
        while (!line_.empty() && (line_.back() == '\n' || line_.back() == '\r')) {
            line_.remove_suffix(1);
        }
        skip_spaces();
        if (at_end()) {
            return out_;
        }
        if (line_.substr(at_).starts_with("DROPCOUNT:")) {
            out_.kind = CandumpLine::Kind::kDrops;
            return out_;
        }
        const bool good = read_stamp() && read_interface() && read_id() && read_frame() && read_direction();
        out_.kind = good ? CandumpLine::Kind::kFrame : CandumpLine::Kind::kBad;
        return out_;
    }

 private:
    [[nodiscard]] bool at_end() const { return at_ == line_.size(); }
    [[nodiscard]] char peek() const { return at_end() ? '\0' : line_[at_]; }
    [[nodiscard]] bool at_space() const { return peek() == ' ' || peek() == '\t'; }
    void skip_spaces() {
        while (at_space()) {
            ++at_;
        }
    }
    bool take(char c) {
        const bool is = !at_end() && line_[at_] == c;
        at_ += is ? 1 : 0;
        return is;
    }
    bool fail(const char* reason) {
        out_.column = at_ + 1;
        out_.reason = reason;
        return false;
    }

    bool read_stamp() {
        if (!take('(')) {
            return fail("expected '(' before the time");
        }
        std::int64_t seconds = 0;
        const char* const end = line_.data() + line_.size();
        const auto whole = std::from_chars(line_.data() + at_, end, seconds);
        if (whole.ec != std::errc{} || seconds < 0 || seconds > kSecondsMax) {
            return fail("expected seconds");
        }
        at_ = static_cast<std::size_t>(whole.ptr - line_.data());
        if (!take('.')) {
            return fail("expected '.' behind the seconds");
        }
        std::int64_t fraction_ns = 0;
        std::size_t digits = 0;
        for (; peek() >= '0' && peek() <= '9' && digits < 9; ++digits, ++at_) {
            fraction_ns = fraction_ns * 10 + (peek() - '0');
        }
        if (digits != 6 && digits != 9) {
            return fail("expected 6 or 9 decimals");
        }
        out_.stamp.ns = seconds * 1'000'000'000 + fraction_ns * (digits == 6 ? 1000 : 1);
        return take(')') || fail("expected ')' behind the time");
    }

    bool read_interface() {
        skip_spaces();
        const std::size_t begin = at_;
        while (!at_end() && !at_space()) {
            ++at_;
        }
        out_.interface = line_.substr(begin, at_ - begin);
        if (out_.interface.empty() || out_.interface.size() > kInterfaceMax) {
            return fail("expected an interface of at most 21 characters");
        }
        skip_spaces();
        return true;
    }

    bool read_id() {
        std::uint32_t id = 0;
        std::size_t digits = 0;
        for (; nibble(peek()) < 16 && digits < 9; ++digits, ++at_) {
            id = (id << 4U) | nibble(peek());
        }
        CanFrame& frame = out_.frame;
        if (digits == 3) {
            frame.id = id;
            return id <= kStandardIdMax || fail("an id of more than 11 bits in 3 digits");
        }
        if (digits != 8) {
            return fail("expected an id of 3 or 8 hexadecimal digits");
        }
        frame.error = (id & kErrorFlag) != 0;
        frame.extended = !frame.error;
        frame.id = id & ~kErrorFlag;
        return frame.id <= kIdMax || fail("an id of more than 29 bits");
    }

    bool read_frame() {
        CanFrame& frame = out_.frame;
        if (!take('#')) {
            return fail("expected '#' behind the id");
        }
        if (take('R')) {
            frame.remote = true;
            if (peek() >= '0' && peek() <= '8') {
                frame.length = static_cast<std::uint8_t>(peek() - '0');
                ++at_;
            }
            return (!frame.error && ends()) || fail("expected a length of at most 8 behind R");
        }
        if (take('#')) {
            frame.fd = true;
            const unsigned flags = nibble(peek());
            if (flags > 15) {
                return fail("expected the flags of CAN FD, a hexadecimal digit");
            }
            ++at_;
            frame.fd_flags = static_cast<std::uint8_t>(flags & 3U);  // 4 says CAN FD once more
        }
        return read_data();
    }

    bool read_data() {
        CanFrame& frame = out_.frame;
        const std::size_t most = frame.fd ? 64 : 8;
        while (nibble(peek()) < 16) {
            const unsigned high = nibble(peek());
            ++at_;
            const unsigned low = nibble(peek());
            if (low > 15) {
                return fail("half a byte");
            }
            if (frame.length == most) {
                return fail("more bytes than a frame holds");
            }
            ++at_;
            frame.data[frame.length++] = static_cast<std::uint8_t>((high << 4U) | low);
            take('.');  // a separator that people write by hand
        }
        if (frame.length == 8 && !frame.fd && take('_')) {  // the controller's raw length of 9 to 15 means 8 bytes, too
            if (nibble(peek()) < 9 || nibble(peek()) > 15) {
                return fail("expected a raw length of 9 to F");
            }
            ++at_;
        }
        if (!fd_length(frame.length)) {
            return fail("a length that CAN FD does not have");
        }
        return ends() || fail("expected hexadecimal digits");
    }

    [[nodiscard]] bool ends() const { return at_end() || at_space(); }

    bool read_direction() {
        skip_spaces();
        if (at_end()) {
            return true;
        }
        if (take('R')) {
            out_.direction = CanDirection::kReceived;
        } else if (take('T')) {
            out_.direction = CanDirection::kTransmitted;
        }
        skip_spaces();
        return (out_.direction != CanDirection::kUnknown && at_end()) || fail("expected R or T, or nothing");
    }

    std::string_view line_;
    std::size_t at_ = 0;
    CandumpLine out_;
};

/// Appends to a buffer that must not run over.
class Writer {
 public:
    explicit Writer(std::span<char> out) : out_(out) {}

    void text(std::string_view characters) {
        for (const char c : characters) {
            ok_ = ok_ && size_ < out_.size();
            if (ok_) {
                out_[size_++] = c;
            }
        }
    }
    void decimal(std::int64_t value, std::size_t digits) {
        std::array<char, 20> reversed{};
        std::size_t n = 0;
        while (value > 0 || n < digits) {
            reversed[n++] = static_cast<char>('0' + value % 10);
            value /= 10;
        }
        while (n > 0) {
            text({&reversed[--n], 1});
        }
    }
    void hex(std::uint32_t value, unsigned digits) {
        while (digits > 0) {
            --digits;
            text(std::string_view("0123456789ABCDEF").substr((value >> (4 * digits)) & 15U, 1));
        }
    }
    [[nodiscard]] std::size_t size() const { return ok_ ? size_ : 0; }

 private:
    std::span<char> out_;
    std::size_t size_ = 0;
    bool ok_ = true;
};

bool writable(const CanFrame& frame) {
    const bool id_fits = frame.id <= (frame.extended || frame.error ? kIdMax : kStandardIdMax);
    const bool length_fits = frame.fd ? fd_length(frame.length) : frame.length <= 8;
    return id_fits && length_fits && !(frame.error && (frame.extended || frame.remote)) &&
           !(frame.fd && frame.remote) && frame.fd_flags <= (frame.fd ? 3 : 0);
}

}  // namespace

CandumpLine parse_candump_line(std::string_view line) {
    return Reader(line).read();
}

std::size_t format_candump_line(const CandumpLine& line, std::span<char> out) {
    const CanFrame& frame = line.frame;
    if (line.kind != CandumpLine::Kind::kFrame || line.stamp.ns < 0 || line.stamp.ns / 1'000'000'000 > kSecondsMax ||
        line.interface.empty() || line.interface.size() > kInterfaceMax ||
        line.interface.find_first_of(" \t\r\n") != line.interface.npos || !writable(frame)) {
        return 0;
    }
    Writer to(out);
    const std::int64_t fraction_ns = line.stamp.ns % 1'000'000'000;
    const bool to_the_ns = fraction_ns % 1000 != 0;
    to.text("(");
    to.decimal(line.stamp.ns / 1'000'000'000, 10);
    to.text(".");
    to.decimal(to_the_ns ? fraction_ns : fraction_ns / 1000, to_the_ns ? 9 : 6);
    to.text(") ");
    to.text(line.interface);
    to.text(" ");
    to.hex(frame.id | (frame.error ? kErrorFlag : 0), frame.extended || frame.error ? 8 : 3);
    to.text("#");
    if (frame.remote) {
        to.text("R");
        if (frame.length > 0) {
            to.hex(frame.length, 1);
        }
    } else {
        if (frame.fd) {
            to.text("#");
            to.hex(frame.fd_flags, 1);
        }
        for (const std::uint8_t byte : frame.payload()) {
            to.hex(byte, 2);
        }
    }
    if (line.direction != CanDirection::kUnknown) {
        to.text(line.direction == CanDirection::kReceived ? " R" : " T");
    }
    return to.size();
}

}  // namespace crspf
