#include "platform/capture/candump.hpp"

#include <algorithm>
#include <charconv>
#include <optional>

#include "platform/capture/frames.hpp"
#include "platform/capture/line_source.hpp"
#include "platform/files/fields.hpp"

namespace crspf {
namespace {

constexpr std::size_t kSourcesMax = 256;  // a bound on what a hostile file allocates
constexpr std::uint32_t kErrorFlag = 0x20000000;

/// All of `text` as a number, digits only.
template <typename Number>
std::optional<Number> number_of(std::string_view text, int base) {
    Number value{};
    const char* const end = text.data() + text.size();
    const auto [read, error] = std::from_chars(text.data(), end, value, base);
    if (text.empty() || error != std::errc{} || read != end || text.front() == '-') {
        return std::nullopt;
    }
    return value;
}

/// `(seconds.fraction)`, a fraction of 1 to 9 digits.
std::optional<Stamp> stamp_of(std::string_view text) {
    const std::size_t point = text.find('.');
    if (text.size() < 2 || text.front() != '(' || text.back() != ')' || point == text.npos) {
        return std::nullopt;
    }
    const std::string_view digits = text.substr(point + 1, text.size() - point - 2);
    const auto seconds = number_of<std::int64_t>(text.substr(1, point - 1), 10);
    const auto fraction = number_of<std::int64_t>(digits, 10);
    constexpr std::int64_t kSecondsMax = 9'000'000'000;  // of what 64 bits of nanoseconds hold
    if (!seconds || !fraction || digits.size() > 9 || *seconds > kSecondsMax) {
        return std::nullopt;
    }
    std::int64_t ns = *fraction;
    for (std::size_t i = digits.size(); i < 9; ++i) {
        ns *= 10;
    }
    return Stamp{*seconds * 1'000'000'000 + ns};
}

/// Pairs of hexadecimal digits.
bool parse_data(std::string_view text, CanFrame& frame) {
    if (text.size() % 2 != 0 || text.size() / 2 > (frame.fd ? CanFrame::kBytesMax : 8)) {
        return false;
    }
    for (std::size_t i = 0; i < text.size(); i += 2) {
        const auto byte = number_of<std::uint8_t>(text.substr(i, 2), 16);
        if (!byte) {
            return false;
        }
        frame.data[i / 2] = *byte;
    }
    frame.length = static_cast<std::uint8_t>(text.size() / 2);
    return true;
}

/// `123#0102`, `12345678#0102`, `123#R4`, `123##1010203`; a raw length code `_F` behind 8 bytes is passed over.
bool parse_frame(std::string_view text, CanFrame& frame) {
    const std::size_t mark = text.find('#');
    if (mark != 3 && mark != 8) {
        return false;
    }
    const auto id = number_of<std::uint32_t>(text.substr(0, mark), 16);
    if (!id) {
        return false;
    }
    frame = {};
    frame.error = mark == 8 && (*id & kErrorFlag) != 0;
    frame.extended = mark == 8 && !frame.error;
    frame.id = *id & ~(frame.error ? kErrorFlag : 0U);
    std::string_view rest = text.substr(mark + 1);
    if (rest.starts_with('#')) {
        frame.fd = true;
        return rest.size() >= 2 && number_of<std::uint8_t>(rest.substr(1, 1), 16) &&
               parse_data(rest.substr(2), frame) && is_valid(frame);
    }
    if (const std::size_t raw = rest.find('_'); raw != rest.npos) {
        if (rest.size() != raw + 2 || !number_of<std::uint8_t>(rest.substr(raw + 1), 16)) {
            return false;
        }
        rest = rest.substr(0, raw);
    }
    if (rest.starts_with('R')) {
        frame.remote = true;
        const auto length = rest.size() == 1 ? std::uint8_t{0} : number_of<std::uint8_t>(rest.substr(1), 16);
        frame.length = length.value_or(255);
        return is_valid(frame);
    }
    return parse_data(rest, frame) && is_valid(frame);
}

bool is_ignored(std::string_view text) {
    const std::string_view word = Fields(text).word();
    return word.empty() || word.starts_with('#') || word.starts_with("DROPCOUNT");
}

class CandumpReader final : public CaptureReader {
 public:
    explicit CandumpReader(UnpackedFile file) : lines_(std::move(file)) {}

    bool next(CaptureRecord& record) override {
        LineSource::Line text;
        while (lines_.next(text)) {
            if (!text.too_long && is_ignored(text.text)) {
                ++counts_.ignored;
                continue;
            }
            CandumpLine line;
            const char* damage = text.too_long ? "too long" : parse_candump_line(text.text, line);
            const std::size_t source = damage == nullptr ? source_of(line.interface) : 0;
            if (damage == nullptr && source == kSourcesMax) {
                damage = "too many interfaces";
            }
            if (damage != nullptr) {
                count_unusable(damage);
                continue;
            }
            bytes_.clear();
            static_cast<void>(append_can_frame(bytes_, line.frame));  // the parser gives valid ones only
            record = {.source = static_cast<std::uint32_t>(source),
                      .link = LinkKind::kCan,
                      .direction = line.direction,
                      .cut = false,
                      .stamp = line.stamp,
                      .bytes = bytes_};
            ++counts_.records;
            return true;
        }
        return false;
    }

    [[nodiscard]] const std::vector<CaptureSource>& sources() const override { return sources_; }
    [[nodiscard]] const std::string& comment() const override { return comment_; }
    [[nodiscard]] const CaptureCounts& counts() const override { return counts_; }
    [[nodiscard]] double progress() const override { return lines_.progress(); }
    [[nodiscard]] const char* format() const override { return "candump"; }

 private:
    std::size_t source_of(std::string_view interface) {
        const auto known = std::find_if(sources_.begin(), sources_.end(),
                                        [&](const CaptureSource& source) { return source.name == interface; });
        const auto index = static_cast<std::size_t>(known - sources_.begin());
        if (known == sources_.end() && index < kSourcesMax) {
            sources_.push_back({.name = std::string(interface), .description = {}, .link = LinkKind::kCan});
        }
        return index;
    }

    void count_unusable(const char* reason) {
        if (counts_.unusable++ == 0) {
            counts_.first_unusable = lines_.name() + ":" + std::to_string(lines_.line_number()) + ": " + reason;
        }
    }

    LineSource lines_;
    std::vector<std::uint8_t> bytes_;
    std::vector<CaptureSource> sources_;
    std::string comment_;
    CaptureCounts counts_;
};

}  // namespace

const char* parse_candump_line(std::string_view text, CandumpLine& line) {
    Fields fields(text);
    const std::optional<Stamp> stamp = stamp_of(fields.word());
    if (!stamp) {
        return "no stamp in brackets";
    }
    line.stamp = *stamp;
    line.interface = fields.word();
    constexpr std::size_t kInterfaceMax = 21;  // what canplayer reads
    if (line.interface.empty() || line.interface.size() > kInterfaceMax) {
        return "no name of an interface";
    }
    if (!parse_frame(fields.word(), line.frame)) {
        return "not a CAN frame";
    }
    const std::string_view direction = fields.word();
    line.direction = direction == "R"   ? Direction::kReceived
                     : direction == "T" ? Direction::kSent
                                        : Direction::kUnknown;
    return nullptr;
}

bool looks_like_candump(std::string_view content) {
    while (!content.empty()) {
        const std::size_t end = content.find('\n');
        CandumpLine line;
        if (parse_candump_line(content.substr(0, end), line) == nullptr) {
            return true;
        }
        content.remove_prefix(end == content.npos ? content.size() : end + 1);
    }
    return false;
}

std::unique_ptr<CaptureReader> open_candump(UnpackedFile file) {
    return std::make_unique<CandumpReader>(std::move(file));
}

}  // namespace crspf
