#include "config/suggest.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include "config/join.hpp"
#include "config/parameters.hpp"

namespace crspf {

namespace {

constexpr std::string_view kSeeReference = "`crspf config --reference` lists all";
constexpr std::size_t kLongestName = 40;  // longer names resemble none of ours, and would cost time to compare

/// The key without its unit, right or wrong: range_max for range_max, range_max_m and range_max_mm.
std::string_view stem(std::string_view key) {
    constexpr auto kUnits = std::to_array<std::string_view>({"_m", "_mm", "_cm", "_metres", "_meters", "_deg",
                                                             "_degrees", "_rad", "_radians", "_s", "_ms", "_us", "_ns",
                                                             "_seconds", "_cells", "_points", "_counts"});
    for (const std::string_view unit : kUnits) {
        if (key.ends_with(unit)) {
            return key.substr(0, key.size() - unit.size());
        }
    }
    return key;
}

/// Levenshtein's distance: the least number of characters to insert, delete or replace.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = std::exchange(row[0], i + 1);
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i] == b[j] ? 0U : 1U);
            diagonal = row[j + 1];
            row[j + 1] = std::min({replaced, diagonal + 1, row[j] + 1});
        }
    }
    return row[b.size()];
}

/// The name nearest to `wanted`, where it is near enough to be a slip: a third of the letters, at most. Else empty.
template <class Range, class NameOf>
std::string_view nearest(std::string_view wanted, const Range& candidates, NameOf name_of) {
    std::string_view best;
    if (wanted.size() > kLongestName) {
        return best;
    }
    std::size_t best_distance = stem(wanted).size() / 3 + 1;
    for (const auto& candidate : candidates) {
        const std::string_view name = name_of(candidate);
        const std::size_t distance = edit_distance(stem(wanted), stem(name));
        if (!name.empty() && distance < best_distance) {
            best = name;
            best_distance = distance;
        }
    }
    return best;
}

}  // namespace

std::string remedy_for_key(std::string_view table, std::string_view key) {
    const std::string_view best =
        nearest(key, parameters(), [&](const Parameter& p) { return p.table == table ? p.key : std::string_view{}; });
    if (!best.empty()) {
        return join({"did you mean ", best, "?"});
    }
    for (const Parameter& p : parameters()) {
        if (stem(p.key) == stem(key)) {
            return join({"did you mean ", p.key, " of [", p.table, "]?"});
        }
    }
    return std::string(kSeeReference);
}

std::string remedy_for_name(std::string_view name, std::span<const std::string_view> names) {
    const std::string_view best = nearest(name, names, [](std::string_view n) { return n; });
    return best.empty() ? std::string(kSeeReference) : join({"did you mean ", best, "?"});
}

std::string remedy_for_table(std::string_view name) {
    const std::string_view best = nearest(name, sections(), [](const Section& s) { return s.name; });
    return best.empty() ? std::string(kSeeReference) : join({"did you mean [", best, "]?"});
}

}  // namespace crspf
