#include "platform/service/opencv_yaml.hpp"

#include <charconv>
#include <cmath>
#include <utility>

#include "platform/files/input_error.hpp"

namespace crspf {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";
constexpr std::string_view kSeparators = " \t\r\n,";

std::string_view without(std::string_view text, std::string_view front) {
    const std::size_t at = text.find_first_not_of(front);
    return at == std::string_view::npos ? std::string_view{} : text.substr(at);
}

std::string_view trimmed(std::string_view text) {
    const std::string_view front = without(text, kBlanks);
    return front.substr(0, front.find_last_not_of(kBlanks) + 1);
}

/// Takes `word` from the front, and the blanks before it.
bool take(std::string_view& text, std::string_view word) {
    const std::string_view at = without(text, kBlanks);
    if (!at.starts_with(word)) {
        return false;
    }
    text = at.substr(word.size());
    return true;
}

template <typename Number>
bool take_number(std::string_view& text, Number& value) {
    const std::string_view at = without(text, kBlanks);
    const auto [end, error] = std::from_chars(at.data(), at.data() + at.size(), value);
    if (error != std::errc{}) {
        return false;
    }
    text = at.substr(static_cast<std::size_t>(end - at.data()));
    return true;
}

}  // namespace

OpenCvYaml::OpenCvYaml(std::string_view text, std::string name) : name_(std::move(name)) {
    Entry* open = nullptr;
    std::size_t number = 0;
    while (!text.empty()) {
        ++number;
        const std::size_t end = text.find('\n');
        const std::string_view line = text.substr(0, end);
        text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
        const std::string_view content = trimmed(line);
        if (content.empty() || content.front() == '#' || line.front() == '%' || content == "---" || content == "...") {
            continue;
        }
        if (line.front() == ' ' || line.front() == '\t' || line.front() == '-') {
            if (open == nullptr) {
                fail(number, "no key before this line");
            }
            open->text = {open->text.data(), static_cast<std::size_t>(line.data() + line.size() - open->text.data())};
            continue;
        }
        const std::size_t colon = line.find(':');
        if (colon == std::string_view::npos) {
            fail(number, "neither \"key: value\" nor indented");
        }
        const std::string_view key = trimmed(line.substr(0, colon));
        const auto [entry, fresh] = entries_.try_emplace(key, Entry{line.substr(colon + 1), number});
        if (!fresh) {
            fail(number, std::string("\"").append(key).append("\" stands twice"));
        }
        open = &entry->second;
    }
}

void OpenCvYaml::fail(std::size_t line, const std::string& reason) const {
    throw InputError(name_ + ":" + std::to_string(line) + ": " + reason +
                     "; give a file that `crspf calibrate stereo` or OpenCV wrote");
}

std::size_t OpenCvYaml::line_of(std::string_view key) const {
    const auto found = entries_.find(key);
    return found == entries_.end() ? 1 : found->second.line;
}

std::optional<int> OpenCvYaml::whole_number(std::string_view key) const {
    const auto found = entries_.find(key);
    if (found == entries_.end()) {
        return std::nullopt;
    }
    std::string_view text = found->second.text;
    int value = 0;
    if (!take_number(text, value) || !trimmed(text).empty()) {
        fail(found->second.line, std::string(key) + " is no whole number");
    }
    return value;
}

std::optional<YamlMatrix> OpenCvYaml::matrix(std::string_view key) const {
    const auto found = entries_.find(key);
    if (found == entries_.end()) {
        return std::nullopt;
    }
    std::string_view text = found->second.text;
    YamlMatrix matrix;
    matrix.line = found->second.line;
    const bool head = take(text, "!!opencv-matrix") && take(text, "rows:") && take_number(text, matrix.rows) &&
                      take(text, "cols:") && take_number(text, matrix.cols) && take(text, "dt:") &&
                      (take(text, "d") || take(text, "f")) && take(text, "data:") && take(text, "[");
    if (!head) {
        fail(matrix.line, std::string(key) + " is no matrix of numbers (!!opencv-matrix, rows, cols, dt, data)");
    }
    if (matrix.rows == 0 || matrix.cols == 0 || matrix.rows > kElementsMax || matrix.cols > kElementsMax ||
        matrix.rows * matrix.cols > kElementsMax) {
        fail(matrix.line, std::string(key) + " has no elements, or more than " + std::to_string(kElementsMax));
    }
    double value = 0.0;
    while (matrix.data.size() < matrix.rows * matrix.cols && take_number(text, value) && std::isfinite(value)) {
        matrix.data.push_back(value);
        text = without(text, kSeparators);
    }
    if (matrix.data.size() != matrix.rows * matrix.cols || trimmed(text) != "]") {
        fail(matrix.line, std::string(key) + " does not hold " + std::to_string(matrix.rows) + " x " +
                              std::to_string(matrix.cols) + " numbers");
    }
    return matrix;
}

}  // namespace crspf
