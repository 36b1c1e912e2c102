#include "drivers/scip/scip_codec.hpp"

#include <algorithm>
#include <array>

namespace crspf {
namespace {

// Digits only: true and their value.
bool read_decimal(Bytes digits, std::uint32_t& value) {
    value = 0;
    for (const std::uint8_t c : digits) {
        if (c < '0' || c > '9') {
            return false;
        }
        value = value * 10 + (c - std::uint32_t{'0'});
    }
    return true;
}

struct StatusText {
    char code[3];
    const char* text;
};

constexpr std::array<StatusText, 9> kGeneral{{
    {"0A", "cannot build the reply"},
    {"0B", "buffer full, or command repeated"},
    {"0C", "too few parameters"},
    {"0D", "unknown command"},
    {"0E", "unknown command, or not now"},
    {"0F", "too few parameters"},
    {"0G", "string longer than 16 characters"},
    {"0H", "character that is not allowed in the string"},
    {"0I", "firmware update mode"},
}};
constexpr std::array<StatusText, 11> kScans{{
    {"00", "accepted"},
    {"01", "start is no number"},
    {"02", "end is no number"},
    {"03", "cluster is no number"},
    {"04", "end is out of range"},
    {"05", "end is before start"},
    {"06", "interval is no number"},
    {"07", "count is no number"},
    {"10", "laser is off"},
    {"98", "works again after an error"},
    {"99", "data"},
}};

template <std::size_t N>
const char* find(const std::array<StatusText, N>& table, Bytes code) {
    const auto* const at = std::find_if(table.begin(), table.end(), [&](const StatusText& row) {
        return row.code[0] == static_cast<char>(code[0]) && row.code[1] == static_cast<char>(code[1]);
    });
    return at == table.end() ? nullptr : at->text;
}

}  // namespace

void put_decimal(ByteWriter& out, std::uint32_t value, std::size_t digits) {
    std::array<std::uint8_t, 10> text{};
    digits = std::min(digits, text.size());
    for (std::size_t i = digits; i > 0; --i) {
        text[i - 1] = static_cast<std::uint8_t>('0' + value % 10);
        value /= 10;
    }
    out.bytes(Bytes(text).first(digits));
}

void scip_encode(ByteWriter& out, std::uint32_t value, std::size_t chars) {
    for (std::size_t i = chars; i > 0; --i) {
        out.byte(static_cast<std::uint8_t>(((value >> (6 * (i - 1))) & 0x3FU) + kScipZero));
    }
}

bool scip_line_ok(Bytes line) {
    return line.size() >= 2 && scip_sum(line.first(line.size() - 1)) == line.back();
}

bool scip_text_line_ok(Bytes line) {
    if (scip_line_ok(line)) {
        return true;
    }
    if (line.size() < 3 || line[line.size() - 2] != ';') {
        return false;
    }
    const Bytes text = line.first(line.size() - 2);
    if (scip_sum(text) == line.back()) {
        return true;
    }
    for (std::size_t i = 0; i + 1 < text.size(); ++i) {
        if (text[i] == '<' && text[i + 1] == '-') {
            return scip_sum(text.first(i)) == line.back();
        }
    }
    return false;
}

void put_request(ByteWriter& out, const ScipScanRequest& request) {
    out.byte(request.continuous ? 'M' : 'G');
    constexpr std::array<std::uint8_t, 3> kLetters{'D', 'S', 'E'};
    out.byte(kLetters[static_cast<std::size_t>(request.encoding)]);
    put_decimal(out, request.start, 4);
    put_decimal(out, request.end, 4);
    put_decimal(out, request.cluster, 2);
    if (request.continuous) {
        put_decimal(out, request.skip, 1);
        put_decimal(out, request.count, 2);
    }
}

bool read_request(Bytes line, ScipScanRequest& request) {
    if (line.size() < 12 || (line[0] != 'M' && line[0] != 'G')) {
        return false;
    }
    request = ScipScanRequest{};
    request.continuous = line[0] == 'M';
    const std::size_t size = request.continuous ? 15 : 12;
    if (line.size() < size || (line.size() > size && line[size] != ';')) {
        return false;
    }
    switch (line[1]) {
        case 'D': request.encoding = ScipEncoding::kThreeChars; break;
        case 'S': request.encoding = ScipEncoding::kTwoChars; break;
        case 'E': request.encoding = ScipEncoding::kWithIntensity; break;
        default: return false;
    }
    return read_decimal(line.subspan(2, 4), request.start) && read_decimal(line.subspan(6, 4), request.end) &&
           read_decimal(line.subspan(10, 2), request.cluster) && request.start <= request.end &&
           (!request.continuous ||
            (read_decimal(line.subspan(12, 1), request.skip) && read_decimal(line.subspan(13, 2), request.count)));
}

void put_status(ByteWriter& out, Bytes two_chars) {
    out.bytes(two_chars);
    out.byte(scip_sum(two_chars));
    out.byte('\n');
}

void put_text_line(ByteWriter& out, Bytes text) {
    out.bytes(text);
    out.byte(';');
    out.byte(scip_sum(text));
    out.byte('\n');
}

void put_payload(ByteWriter& out, Bytes chars) {
    while (!chars.empty()) {
        const Bytes line = chars.first(std::min(chars.size(), kScipLineChars));
        out.bytes(line);
        out.byte(scip_sum(line));
        out.byte('\n');
        chars = chars.subspan(line.size());
    }
}

const char* scip_status_text(Bytes two_chars, bool of_scans) {
    if (two_chars.size() != 2) {
        return "no status";
    }
    if (const char* const text = find(kGeneral, two_chars)) {
        return text;
    }
    if (!of_scans) {
        return is_text(two_chars, "00") ? "accepted" : "refused, or already so";
    }
    if (const char* const text = find(kScans, two_chars)) {
        return text;
    }
    std::uint32_t code = 0;
    if (!read_decimal(two_chars, code)) {
        return "unknown status";
    }
    return code >= 50 ? "hardware trouble" : code >= 21 && code <= 49 ? "stopped to verify an error" : "unknown status";
}

}  // namespace crspf
