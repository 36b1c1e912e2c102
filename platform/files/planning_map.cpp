#include "platform/files/planning_map.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace crspf {
namespace {

using Counts = std::vector<std::uint16_t>;

/// Of each cell, how many of the square of 2 `reach` + 1 cells round it are of the kind; beyond the map none is.
Counts count_around(const GridMap& map, GridCell kind, int reach) {
    const auto index = [&map](int column, int row) {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(map.width) + static_cast<std::size_t>(column);
    };
    // Along the rows, then along the columns.
    Counts rows(map.cells.size());
    Counts out(map.cells.size());
    for (int row = 0; row < map.height; ++row) {
        for (int column = 0; column < map.width; ++column) {
            std::uint16_t count = 0;
            for (int c = std::max(column - reach, 0); c <= std::min(column + reach, map.width - 1); ++c) {
                count = static_cast<std::uint16_t>(count + (map.at(c, row) == kind ? 1 : 0));
            }
            rows[index(column, row)] = count;
        }
    }
    for (int row = 0; row < map.height; ++row) {
        for (int column = 0; column < map.width; ++column) {
            std::uint16_t count = 0;
            for (int r = std::max(row - reach, 0); r <= std::min(row + reach, map.height - 1); ++r) {
                count = static_cast<std::uint16_t>(count + rows[index(column, r)]);
            }
            out[index(column, row)] = count;
        }
    }
    return out;
}

GridMap expanded(const GridMap& map) {
    GridMap out = map;
    const Counts obstacles = count_around(map, GridCell::kOccupied, 1);
    for (std::size_t i = 0; i < out.cells.size(); ++i) {
        if (obstacles[i] > 0) {
            out.cells[i] = GridCell::kOccupied;
        }
    }
    return out;
}

}  // namespace

GridMap planning_map(const GridMap& map) {
    constexpr int kReach = 2;
    const auto span = [](int at, int size) { return std::min(at + kReach, size - 1) - std::max(at - kReach, 0) + 1; };
    const Counts obstacles = count_around(expanded(map), GridCell::kOccupied, kReach);
    const Counts free = count_around(map, GridCell::kFree, 1);
    const Counts unknown = count_around(map, GridCell::kUnknown, 1);
    GridMap filtered = map;
    std::size_t i = 0;
    for (int row = 0; row < map.height; ++row) {
        for (int column = 0; column < map.width; ++column, ++i) {
            const bool alone = 2 * obstacles[i] <= span(column, map.width) * span(row, map.height);
            if (map.cells[i] == GridCell::kOccupied && alone) {
                filtered.cells[i] = free[i] >= unknown[i] ? GridCell::kFree : GridCell::kUnknown;
            }
        }
    }
    return expanded(filtered);
}

}  // namespace crspf
