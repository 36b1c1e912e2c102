#include <algorithm>
#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "platform/files/planning_map.hpp"

using namespace crspf;

namespace {

/// Rows from the top; '#' occupied, '.' free, '?' unknown.
GridMap map_of(const std::vector<std::string>& rows) {
    GridMap map;
    map.width = static_cast<int>(rows[0].size());
    map.height = static_cast<int>(rows.size());
    map.resolution_m = 0.02;
    for (const std::string& row : rows) {
        for (const char c : row) {
            map.cells.push_back(c == '#' ? GridCell::kOccupied : c == '?' ? GridCell::kUnknown : GridCell::kFree);
        }
    }
    return map;
}

std::vector<std::string> text_of(const GridMap& map) {
    std::vector<std::string> rows;
    for (int row = 0; row < map.height; ++row) {
        rows.emplace_back();
        for (int column = 0; column < map.width; ++column) {
            const GridCell cell = map.at(column, row);
            rows.back() += cell == GridCell::kOccupied ? '#' : cell == GridCell::kUnknown ? '?' : '.';
        }
    }
    return rows;
}

}  // namespace

TEST_CASE("planning map: lone marks go, a wall of one cell becomes three wide") {
    const GridMap map = map_of({
        "...........",
        "...........",
        "..#........",
        "...........",
        "...........",
        "...........",
        "###########",
        "...........",
        "...........",
        "...........",
        "........???",
        "........?#?",
        "........???",
        "...........",
    });
    CHECK(text_of(planning_map(map)) == std::vector<std::string>{
                                            "...........",
                                            "...........",
                                            "...........",
                                            "...........",
                                            "...........",
                                            "###########",
                                            "###########",
                                            "###########",
                                            "...........",
                                            "...........",
                                            "........???",
                                            "........???",
                                            "........???",
                                            "...........",
                                        });
}

TEST_CASE("planning map: what is of three cells or more stays, a doorway stays open") {
    const GridMap map = map_of({
        "................",
        "................",
        "................",
        "...###..........",
        "................",
        "................",
        "................",
        "................",
        "######......####",
        "................",
        "................",
        "................",
    });
    const std::vector<std::string> out = text_of(planning_map(map));
    CHECK(out[3].substr(3, 3) == "###");
    CHECK(out[8].substr(0, 6) == "######");
    CHECK(out[8].find("....") != std::string::npos);
}

TEST_CASE("planning map: place and resolution are the map's") {
    GridMap map = map_of({"##", "##"});
    map.P_map_origin = {.x_m = 1.0, .y_m = 2.0, .theta_rad = 0.3};
    const GridMap out = planning_map(map);
    CHECK(out.P_map_origin == map.P_map_origin);
    CHECK(out.resolution_m == map.resolution_m);
    CHECK(planning_map(GridMap{}).cells.empty());
}
