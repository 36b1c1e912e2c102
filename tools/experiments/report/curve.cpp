#include "tools/experiments/report/curve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

namespace crspf::experiments {

namespace {

// In tenths of a pixel.
std::pair<long, long> rounded(const Spot& spot) {
    return {std::lround(10.0 * spot.x_px), std::lround(10.0 * spot.y_px)};
}

void append(std::string& path, const char* letter, const std::pair<long, long>& tenths) {
    fmt::format_to(std::back_inserter(path), "{}{:g} {:g}", letter, static_cast<double>(tenths.first) / 10.0,
                   static_cast<double>(tenths.second) / 10.0);
}

}  // namespace

Curve thinned(const Curve& curve, std::size_t most) {
    if (curve.size() <= most) {
        return curve;
    }
    constexpr std::size_t kKept = 6;  // first, last, and the outermost in four directions
    const std::size_t buckets = std::max<std::size_t>(most / kKept, 1);
    const std::size_t length = (curve.size() + buckets - 1) / buckets;
    Curve kept;
    for (std::size_t first = 0; first < curve.size(); first += length) {
        const auto begin = curve.begin() + static_cast<std::ptrdiff_t>(first);
        const auto end = curve.begin() + static_cast<std::ptrdiff_t>(std::min(first + length, curve.size()));
        const auto by_x = std::minmax_element(begin, end, [](auto& a, auto& b) { return a.x_px < b.x_px; });
        const auto by_y = std::minmax_element(begin, end, [](auto& a, auto& b) { return a.y_px < b.y_px; });
        std::array places{begin, by_x.first, by_x.second, by_y.first, by_y.second, end - 1};
        std::sort(places.begin(), places.end());
        std::for_each(places.begin(), std::unique(places.begin(), places.end()),
                      [&](auto place) { kept.push_back(*place); });
    }
    return kept;
}

Curve thinned_dots(const Curve& dots, std::size_t most) {
    constexpr double kGrowth = 1.5;
    Curve kept = dots;
    double cell_px = 1.0;
    while (kept.size() > most) {
        std::set<std::pair<long, long>> taken;
        std::erase_if(kept, [&](const Spot& dot) {
            return !taken.insert({std::lround(dot.x_px / cell_px), std::lround(dot.y_px / cell_px)}).second;
        });
        cell_px *= kGrowth;
    }
    return kept;
}

Curve stepped(const Curve& curve) {
    Curve steps;
    for (const Spot& spot : curve) {
        if (!steps.empty()) {
            steps.push_back({spot.x_px, steps.back().y_px});
        }
        steps.push_back(spot);
    }
    return steps;
}

std::string line_path(const Curve& curve) {
    std::string path;
    std::pair<long, long> last;
    bool moved = false;
    for (const Spot& spot : curve) {
        const std::pair<long, long> here = rounded(spot);
        if (path.empty()) {
            append(path, "M", here);
        } else if (here != last) {
            append(path, "L", here);
            moved = true;
        }
        last = here;
    }
    return path.empty() || moved ? path : path + "h0";
}

std::string dots_path(const Curve& dots) {
    std::string path;
    for (const Spot& dot : dots) {
        append(path, "M", rounded(dot));
        path += "h0";
    }
    return path;
}

}  // namespace crspf::experiments
