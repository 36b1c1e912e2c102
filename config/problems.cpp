#include "config/problems.hpp"

#include <algorithm>

#include "config/join.hpp"
#include "platform/files/input_error.hpp"

namespace crspf {

void Problems::add(const toml::source_position& at, std::initializer_list<std::string_view> text) {
    problems_.push_back({.at = at, .text = join(text)});
}

void Problems::throw_if_any() {
    if (problems_.empty()) {
        return;
    }
    std::stable_sort(problems_.begin(), problems_.end(),
                     [](const Problem& a, const Problem& b) { return a.at < b.at; });
    std::string all;
    for (const auto& [at, text] : problems_) {
        const char* const newline = all.empty() ? "" : "\n";
        all += join({newline, name_, ":", std::to_string(at.line), ":", std::to_string(at.column), ": ", text});
    }
    throw InputError(all);
}

}  // namespace crspf
