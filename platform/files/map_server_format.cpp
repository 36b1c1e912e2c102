#include "platform/files/map_server_format.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>

#include "platform/files/fields.hpp"
#include "platform/files/input_error.hpp"

namespace crspf {
namespace {

[[noreturn]] void fail(const std::string& name, int line, const std::string& reason) {
    throw InputError(name + ":" + std::to_string(line) + ": " + reason);
}

std::string key_name(std::string_view key) {
    return std::string("`").append(key).append("`");
}

// ---- YAML

struct Entry {
    std::string value;
    int line = 0;
};
using Entries = std::map<std::string, Entry, std::less<>>;

std::string_view trim(std::string_view text) {
    constexpr std::string_view kBlanks = " \t\r";
    const std::size_t begin = text.find_first_not_of(kBlanks);
    return begin == text.npos ? "" : text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

// A `#` starts a comment at the start of a line or after a blank, unless it stands in quotes.
std::string_view without_comment(std::string_view line) {
    char quote = '\0';
    char before = ' ';
    for (std::size_t i = 0; i < line.size(); ++i) {
        const char c = line[i];
        const bool after_blank = before == ' ' || before == '\t';
        if (quote != '\0') {
            const bool doubled = quote == '\'' && line.substr(i, 2) == "''";  // stands for one
            i += doubled ? 1U : 0U;
            quote = c == quote && !doubled ? '\0' : quote;
        } else if (after_blank && (c == '"' || c == '\'')) {
            quote = c;
        } else if (after_blank && c == '#') {
            return line.substr(0, i);
        }
        before = c;
    }
    return line;
}

Entries read_entries(std::string_view text, const std::string& name) {
    Entries entries;
    Entry* last = nullptr;
    int number = 0;
    while (!text.empty()) {
        const std::size_t end = text.find('\n');
        const std::string_view line = trim(without_comment(text.substr(0, end)));
        text.remove_prefix(end == text.npos ? text.size() : end + 1);
        ++number;
        if (line.empty() || line == "---" || line == "..." || line.front() == '%') {
            continue;
        }
        if (line.starts_with("- ") && last != nullptr) {
            last->value.append(last->value.empty() ? "" : ",").append(trim(line.substr(2)));
            continue;
        }
        const std::size_t colon = line.find(':');
        if (colon == line.npos || (colon + 1 < line.size() && line[colon + 1] != ' ' && line[colon + 1] != '\t')) {
            fail(name, number, "not a `key: value` line; a map is described as map_saver does it");
        }
        const auto [entry, added] = entries.try_emplace(std::string(trim(line.substr(0, colon))),
                                                        Entry{std::string(trim(line.substr(colon + 1))), number});
        if (!added) {
            fail(name, number, key_name(entry->first) + " stands twice; keep one");
        }
        last = &entry->second;
    }
    return entries;
}

const Entry& required(const Entries& entries, std::string_view key, const std::string& name) {
    const auto found = entries.find(key);
    if (found == entries.end()) {
        fail(name, 1, key_name(key) + " is missing; add it, as map_saver does");
    }
    return found->second;
}

double number_of(const Entries& entries, std::string_view key, double min, double max, const char* range,
                 const std::string& name) {
    const Entry& entry = required(entries, key, name);
    Fields fields(entry.value);
    double value = 0.0;
    if (!fields.number(value) || !fields.at_end() || !(value >= min && value <= max)) {
        fail(name, entry.line, key_name(key).append(" must be a number from ").append(range));
    }
    return value;
}

Pose2 origin_of(const Entries& entries, const std::string& name) {
    const Entry& entry = required(entries, "origin", name);
    std::string list = entry.value;
    if (list.size() >= 2 && list.front() == '[' && list.back() == ']') {
        list = list.substr(1, list.size() - 2);
    }
    std::replace(list.begin(), list.end(), ',', ' ');
    Fields fields(list);
    Pose2 origin;
    if (!fields.numbers(origin.x_m, origin.y_m, origin.theta_rad) || !fields.at_end() || !std::isfinite(origin.x_m) ||
        !std::isfinite(origin.y_m) || !std::isfinite(origin.theta_rad)) {
        fail(name, entry.line, "`origin` must be [x, y, yaw] in metres and radians, on one line");
    }
    origin.theta_rad = wrap_angle(origin.theta_rad);
    return origin;
}

bool negate_of(const Entries& entries, const std::string& name) {
    const Entry& entry = required(entries, "negate", name);
    if (entry.value == "0" || entry.value == "false") {
        return false;
    }
    if (entry.value == "1" || entry.value == "true") {
        return true;
    }
    fail(name, entry.line, "`negate` must be 0 or 1");
}

std::string unquoted(const std::string& value) {
    const bool in_quotes = value.size() >= 2 && value.front() == value.back() && (value[0] == '"' || value[0] == '\'');
    if (!in_quotes) {
        return value;
    }
    std::string text;
    for (std::size_t i = 1; i + 1 < value.size(); ++i) {
        text += value[i];
        const bool doubled = value[0] == '\'' && value.compare(i, 2, "''") == 0;  // stands for one
        i += doubled ? 1U : 0U;
    }
    return text;
}

// ---- PGM

// The head of a PGM file, and all of a P2: decimal numbers between blanks and comments.
class PgmText {
 public:
    PgmText(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

    int number(const char* what, int max) {
        skip_blanks_and_comments();
        int value = 0;
        const auto [end, error] = std::from_chars(bytes_.data() + at_, bytes_.data() + bytes_.size(), value);
        if (error == std::errc::invalid_argument || value < 0) {
            fail(name_, line_, std::string(what) + " is missing; the file is no PGM image, or damaged");
        }
        if (error != std::errc{} || value > max) {
            fail(name_, line_,
                 std::string(what) + " is larger than " + std::to_string(max) + ", which is not supported");
        }
        at_ = static_cast<std::size_t>(end - bytes_.data());
        return value;
    }

    [[nodiscard]] std::string_view rest() const { return bytes_.substr(at_); }
    [[nodiscard]] int line() const { return line_; }

 private:
    void skip_blanks_and_comments() {
        bool comment = false;
        for (; at_ < bytes_.size(); ++at_) {
            const char c = bytes_[at_];
            if (c == '\n') {
                ++line_;
                comment = false;
            } else if (c == '#') {
                comment = true;
            } else if (!comment && c != ' ' && !(c >= '\t' && c <= '\r')) {
                return;
            }
        }
    }

    std::string_view bytes_;
    const std::string& name_;
    std::size_t at_ = 2;  // behind the magic number
    int line_ = 1;
};

// What each shade means; map_server's arithmetic, scaled where maxval is not 255.
std::array<GridCell, 256> shades(const MapDescription& description, int maxval) {
    std::array<GridCell, 256> cells{};
    for (int shade = 0; shade <= maxval; ++shade) {
        const double occupied = static_cast<double>(description.negate ? shade : maxval - shade) / maxval;
        cells[static_cast<std::size_t>(shade)] = occupied > description.occupied_thresh ? GridCell::kOccupied
                                                 : occupied < description.free_thresh   ? GridCell::kFree
                                                                                        : GridCell::kUnknown;
    }
    return cells;
}

}  // namespace

MapDescription parse_map_yaml(std::string_view text, const std::string& name) {
    const Entries entries = read_entries(text, name);
    MapDescription description;
    const Entry& image = required(entries, "image", name);
    description.image = unquoted(image.value);
    if (description.image.empty()) {
        fail(name, image.line, "`image` is empty; name the PGM file");
    }
    description.resolution_m = number_of(entries, "resolution", 1e-4, 1e3, "0.0001 to 1000 (metres a cell)", name);
    description.P_map_origin = origin_of(entries, name);
    description.negate = negate_of(entries, name);
    description.occupied_thresh = number_of(entries, "occupied_thresh", 0.0, 1.0, "0 to 1", name);
    description.free_thresh = number_of(entries, "free_thresh", 0.0, 1.0, "0 to 1", name);
    if (description.free_thresh > description.occupied_thresh) {
        fail(name, required(entries, "free_thresh", name).line, "`free_thresh` is above `occupied_thresh`; swap them");
    }
    if (const auto mode = entries.find("mode"); mode != entries.end()) {
        const std::string value = unquoted(mode->second.value);
        if (value != "trinary" && value != "scale") {
            fail(name, mode->second.line, "`mode` must be trinary or scale; save the map again in one of these");
        }
    }
    return description;
}

GridMap parse_pgm(std::string_view bytes, const MapDescription& description, const std::string& name) {
    const bool plain = bytes.starts_with("P2");
    if (!plain && !bytes.starts_with("P5")) {
        fail(name, 1, "not a PGM image (P5 or P2); convert it, as with `convert map.png map.pgm`");
    }
    PgmText text(bytes, name);
    GridMap map;
    map.width = text.number("the width", kMapSideMax);
    map.height = text.number("the height", kMapSideMax);
    const int maxval = text.number("maxval", 255);
    map.resolution_m = description.resolution_m;
    map.P_map_origin = description.P_map_origin;
    const auto width = static_cast<std::size_t>(map.width);
    const auto height = static_cast<std::size_t>(map.height);
    const std::size_t count = width * height;
    if (count == 0 || count > kMapCellsMax || maxval == 0) {
        fail(name, text.line(),
             std::to_string(width) + " x " + std::to_string(height) + " cells, maxval " + std::to_string(maxval) +
                 ": a map has 1 to " + std::to_string(kMapCellsMax) + " cells, maxval 1 to 255; crop or convert it");
    }
    // One byte ends the head; then a cell takes a byte, or in P2 a digit and a blank. Held before memory is asked for.
    const std::string_view raster = text.rest().substr(std::min<std::size_t>(1, text.rest().size()));
    if (raster.size() < (plain ? 2 * count - 1 : count)) {
        fail(name, text.line(),
             "the image ends before its " + std::to_string(count) + " cells; the file is cut short, copy it again");
    }

    const std::array<GridCell, 256> meaning = shades(description, maxval);
    map.cells.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        const int shade = plain ? text.number("a cell", maxval) : static_cast<std::uint8_t>(raster[i]);
        if (shade > maxval) {
            fail(name, text.line(), "cell " + std::to_string(i) + " is brighter than maxval; the file is damaged");
        }
        const std::size_t row_from_top = i / width;
        map.cells[(height - 1 - row_from_top) * width + i % width] = meaning[static_cast<std::size_t>(shade)];
    }
    return map;
}

}  // namespace crspf
