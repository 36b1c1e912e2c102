#include "tools/sim/map_walls.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace crspf::sim {
namespace {

bool is_free(const GridMap& map, int column, int row) {
    return map.contains(column, row) && map.at(column, row) == GridCell::kFree;
}

Point corner(const GridMap& map, double column, double row) {
    const Pose2 p =
        map.P_map_origin * Pose2{.x_m = column * map.resolution_m, .y_m = row * map.resolution_m, .theta_rad = 0.0};
    return {p.x_m, p.y_m};
}

std::size_t index(const GridMap& map, int column, int row) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(map.width) + static_cast<std::size_t>(column);
}

// Calls emit(from, to) for each longest run of positions 0 .. count-1 at which `is_border` holds.
template <typename IsBorder, typename Emit>
void for_each_run(int count, IsBorder is_border, Emit emit) {
    int from = 0;
    bool open = false;
    for (int i = 0; i <= count; ++i) {
        const bool border = i < count && is_border(i);
        if (border && !open) {
            from = i;
        } else if (!border && open) {
            emit(from, i);
        }
        open = border;
    }
}

}  // namespace

std::vector<Segment> walls_of(const GridMap& map) {
    std::vector<Segment> walls;
    for (int c = 0; c <= map.width; ++c) {
        for_each_run(
            map.height, [&](int r) { return is_free(map, c - 1, r) != is_free(map, c, r); },
            [&](int from, int to) {
                walls.push_back({corner(map, c, from), corner(map, c, to)});
            });
    }
    for (int r = 0; r <= map.height; ++r) {
        for_each_run(
            map.width, [&](int c) { return is_free(map, c, r - 1) != is_free(map, c, r); },
            [&](int from, int to) {
                walls.push_back({corner(map, from, r), corner(map, to, r)});
            });
    }
    return walls;
}

Point most_open_place(const GridMap& map) {
    // Distance to the nearest cell that is not free, counting diagonal steps as one: two sweeps suffice.
    std::vector<int> steps(map.cells.size(), 0);
    const auto at = [&](int c, int r) { return map.contains(c, r) ? steps[index(map, c, r)] : 0; };
    for (int r = 0; r < map.height; ++r) {
        for (int c = 0; c < map.width; ++c) {
            if (is_free(map, c, r)) {
                steps[index(map, c, r)] =
                    1 + std::min({at(c - 1, r - 1), at(c, r - 1), at(c + 1, r - 1), at(c - 1, r)});
            }
        }
    }
    int best = 0;
    Point place;
    for (int r = map.height - 1; r >= 0; --r) {
        for (int c = map.width - 1; c >= 0; --c) {
            int& here = steps[index(map, c, r)];
            if (here > 0) {
                here = std::min(here, 1 + std::min({at(c - 1, r + 1), at(c, r + 1), at(c + 1, r + 1), at(c + 1, r)}));
            }
            if (here > best) {
                best = here;
                place = corner(map, c + 0.5, r + 0.5);
            }
        }
    }
    return place;
}

GridMap rasterize(const World& world, Point inside, double resolution_m) {
    GridMap map;
    map.resolution_m = resolution_m;
    map.P_map_origin = {.x_m = world.lower().x_m, .y_m = world.lower().y_m, .theta_rad = 0.0};
    map.width = static_cast<int>(std::ceil((world.upper().x_m - world.lower().x_m) / resolution_m));
    map.height = static_cast<int>(std::ceil((world.upper().y_m - world.lower().y_m) / resolution_m));
    map.cells.assign(static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height), GridCell::kUnknown);
    const auto cell_of = [&](Point p) {
        return std::pair{static_cast<int>(std::floor((p.x_m - world.lower().x_m) / resolution_m)),
                         static_cast<int>(std::floor((p.y_m - world.lower().y_m) / resolution_m))};
    };

    // Points closer than a cell leave no gap that a flood by edges could pass.
    for (const Segment& wall : world.walls()) {
        const int count = 1 + static_cast<int>(std::ceil(4.0 * distance(wall.a, wall.b) / resolution_m));
        for (int i = 0; i <= count; ++i) {
            const double u = static_cast<double>(i) / count;
            const auto [c, r] =
                cell_of({wall.a.x_m + u * (wall.b.x_m - wall.a.x_m), wall.a.y_m + u * (wall.b.y_m - wall.a.y_m)});
            map.cells[index(map, c, r)] = GridCell::kOccupied;
        }
    }

    std::vector<std::pair<int, int>> open{cell_of(inside)};
    while (!open.empty()) {
        const auto [c, r] = open.back();
        open.pop_back();
        if (map.contains(c, r) && map.at(c, r) == GridCell::kUnknown) {
            map.cells[index(map, c, r)] = GridCell::kFree;
            open.insert(open.end(), {{c - 1, r}, {c + 1, r}, {c, r - 1}, {c, r + 1}});
        }
    }

    // The inside of a thick wall is nobody's business.
    for (int r = 0; r < map.height; ++r) {
        for (int c = 0; c < map.width; ++c) {
            bool seen = false;
            for (int dr = -1; dr <= 1; ++dr) {
                for (int dc = -1; dc <= 1; ++dc) {
                    seen = seen || is_free(map, c + dc, r + dr);
                }
            }
            if (!seen) {
                map.cells[index(map, c, r)] = GridCell::kUnknown;
            }
        }
    }
    return map;
}

}  // namespace crspf::sim
