// Points of a series as the path of an SVG.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace crspf::experiments {

/// A place in the picture, from its upper left corner; not negative.
struct Spot {
    double x_px = 0.0;
    double y_px = 0.0;

    friend bool operator==(const Spot&, const Spot&) = default;
};

using Curve = std::vector<Spot>;

/// More points than pixels are only bytes: of neighbours in a row the outermost are kept, so that every peak stays.
[[nodiscard]] Curve thinned(const Curve& curve, std::size_t most);

/// Dots that cover each other are one. `most` is 1 or more.
[[nodiscard]] Curve thinned_dots(const Curve& dots, std::size_t most);

/// Each value holds until the next one comes.
[[nodiscard]] Curve stepped(const Curve& curve);

/// The `d` of a path, with a precision of 0.1 px. One point alone is a dot, by the line's round cap.
[[nodiscard]] std::string line_path(const Curve& curve);
[[nodiscard]] std::string dots_path(const Curve& dots);

}  // namespace crspf::experiments
