#include "tools/sim/scene.hpp"

#include <algorithm>
#include <utility>

#include "platform/files/input_error.hpp"
#include "tools/sim/built_in_scenes.hpp"
#include "tools/sim/map_walls.hpp"

namespace crspf::sim {
namespace {

Scene scene_of_map(const std::string& file) {
    GridMap map = read_grid_map(file);
    if (std::count(map.cells.begin(), map.cells.end(), GridCell::kFree) == 0) {
        throw InputError(file + ": the map has no free cell; check its thresholds and `negate`");
    }
    const Point start = most_open_place(map);
    World world(walls_of(map));
    return {.world = std::move(world),
            .P_world_start = {.x_m = start.x_m, .y_m = start.y_m, .theta_rad = 0.0},
            .tour = {},
            .truth = std::move(map)};
}

}  // namespace

Scene make_scene(const std::string& name_or_file) {
    if (name_or_file == "office") {
        return office();
    }
    if (name_or_file == "corridor") {
        return corridor();
    }
    if (name_or_file == "meeting") {
        return meeting();
    }
    if (name_or_file == "hall") {
        return hall();
    }
    if (name_or_file == "lobby") {
        return lobby();
    }
    if (name_or_file == "arena") {
        return arena();
    }
    if (name_or_file == "field") {
        return field();
    }
    if (name_or_file == "campus") {
        return campus();
    }
    if (name_or_file == "parking") {
        return parking();
    }
    if (!name_or_file.ends_with(".yaml") && !name_or_file.ends_with(".yml")) {
        throw InputError("--world " + name_or_file +
                         ": no such world; give office, corridor, meeting, hall, lobby, arena, field, campus, parking "
                         "or the .yaml file of a map");
    }
    return scene_of_map(name_or_file);
}

}  // namespace crspf::sim
