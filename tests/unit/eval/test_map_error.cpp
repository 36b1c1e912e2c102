#include <catch2/catch.hpp>
#include <cmath>

#include "platform/files/input_error.hpp"
#include "tests/unit/eval/recordings.hpp"
#include "tools/eval/map_error.hpp"

using namespace crspf;
using namespace crspf::eval;

namespace {

constexpr AlignmentWindow kNoAlignment{.half_width_m = 0.0, .half_turn_rad = 0.0};

GridMap blank(int width, int height, double resolution_m) {
    return {.width = width,
            .height = height,
            .resolution_m = resolution_m,
            .P_map_origin = {},
            .cells = std::vector<GridCell>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                                           GridCell::kFree)};
}

GridCell& cell(GridMap& map, int x, int y) {
    return map.cells[static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width) + static_cast<std::size_t>(x)];
}

/// Occupies columns x0 to x1 of rows y0 to y1, both included.
void wall(GridMap& map, int x0, int y0, int x1, int y1) {
    for (int y = y0; y <= y1; ++y) {
        for (int x = x0; x <= x1; ++x) {
            cell(map, x, y) = GridCell::kOccupied;
        }
    }
}

/// 8 m x 6 m, outer walls, two inner walls and a pillar; nothing about it is symmetric.
GridMap room() {
    GridMap map = blank(160, 120, 0.05);
    wall(map, 5, 5, 154, 5);
    wall(map, 5, 114, 154, 114);
    wall(map, 5, 5, 5, 114);
    wall(map, 154, 5, 154, 114);
    wall(map, 60, 5, 60, 70);
    wall(map, 90, 80, 154, 80);
    wall(map, 110, 30, 116, 38);
    return map;
}

/// `map` seen from a frame that lies at `P_new_old`^-1 in its own: the same cells, moved as a whole.
GridMap moved(GridMap map, const Pose2& P_new_old) {
    map.P_map_origin = P_new_old * map.P_map_origin;
    return map;
}

/// `map` drawn anew on a grid that lies at `P_map_grid`: what a robot with another start pose would have drawn.
GridMap redrawn(const GridMap& map, const Pose2& P_map_grid, int width, int height, double resolution_m) {
    GridMap result = blank(width, height, resolution_m);
    const Pose2 P_origin_grid = inverse(map.P_map_origin) * P_map_grid;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const Pose2 p = P_origin_grid * Pose2{.x_m = (x + 0.5) * resolution_m, .y_m = (y + 0.5) * resolution_m};
            const int column = static_cast<int>(std::floor(p.x_m / map.resolution_m));
            const int row = static_cast<int>(std::floor(p.y_m / map.resolution_m));
            if (map.contains(column, row) && map.at(column, row) == GridCell::kOccupied) {
                wall(result, x, y, x, y);
            }
        }
    }
    return result;
}

void check_near(const Pose2& found, const Pose2& expected, double margin_m, double margin_deg) {
    CHECK(found.x_m == Approx(expected.x_m).margin(margin_m));
    CHECK(found.y_m == Approx(expected.y_m).margin(margin_m));
    CHECK(std::abs(degrees(wrap_angle(found.theta_rad - expected.theta_rad))) < margin_deg);
}

}  // namespace

TEST_CASE("Identical maps have no error and stay where they are", "[eval][map]") {
    const MapError error = map_error(room(), room(), {});
    check_near(error.P_truth_built, {}, 1e-6, 1e-6);
    CHECK_FALSE(error.at_window_edge);
    CHECK(error.cell_m == 0.05);
    CHECK(error.built_to_truth_m.count == error.truth_to_built_m.count);
    CHECK(error.built_to_truth_m.max < 1e-6);
    CHECK(error.truth_to_built_m.max < 1e-6);
    CHECK(error.sum_per_truth_cell_m() < 1e-6);
}

TEST_CASE("A planted transform is recovered exactly", "[eval][map]") {
    const Pose2 planted = GENERATE(Pose2{.x_m = 0.33, .y_m = -0.71, .theta_rad = radians(4.3)},
                                   Pose2{.x_m = -1.1, .y_m = 0.9, .theta_rad = radians(-13.0)});
    // A far origin: the alignment turns about the map's middle, not about the origin of a frame.
    const Pose2 far{.x_m = 120.0, .y_m = -40.0, .theta_rad = 1.0};
    const MapError error = map_error(moved(room(), far), room(), {.P_truth_built = planted * inverse(far)});
    check_near(error.P_truth_built * far, {}, 1e-3, 0.01);
    CHECK(error.built_to_truth_m.max < 1e-3);
    CHECK(error.truth_to_built_m.max < 1e-3);
    CHECK_FALSE(error.at_window_edge);
}

TEST_CASE("A map drawn on a turned grid is aligned to a fraction of a cell", "[eval][map]") {
    const Pose2 planted{.x_m = -0.52, .y_m = -0.93, .theta_rad = radians(7.0)};
    const GridMap built = redrawn(room(), planted, 200, 180, 0.05);
    const MapError error = map_error(built, room(), {});
    check_near(error.P_truth_built, planted, 0.02, 0.2);
    CHECK(error.built_to_truth_m.mean < 0.025);
    CHECK(error.truth_to_built_m.mean < 0.025);
    CHECK(error.built_to_truth_m.p95 < 0.05);
}

TEST_CASE("A start pose far from the truth's frame is given as the middle of the window", "[eval][map]") {
    const Pose2 planted{.x_m = 8.0, .y_m = 1.0, .theta_rad = radians(95.0)};
    const GridMap built = redrawn(room(), planted, 200, 200, 0.05);
    const MapError error = map_error(
        built, room(), {.P_truth_built = {.x_m = 7.6, .y_m = 1.3, .theta_rad = radians(90.0)}, .half_width_m = 1.0});
    check_near(error.P_truth_built, planted, 0.02, 0.2);
    CHECK_FALSE(error.at_window_edge);
    CHECK_FALSE(error.lies_elsewhere);
}

TEST_CASE("A map that the window does not reach is said to lie elsewhere", "[eval][map]") {
    const GridMap built = moved(room(), {.x_m = 1.0, .y_m = 10.0, .theta_rad = 0.0});
    CHECK(map_error(built, room(), {}).lies_elsewhere);
    CHECK_FALSE(
        map_error(built, room(), {.P_truth_built = {.x_m = 0.0, .y_m = -9.0, .theta_rad = 0.0}}).lies_elsewhere);
}

TEST_CASE("An alignment that the window cuts off says so", "[eval][map]") {
    const GridMap built = moved(room(), {.x_m = 0.6});
    const MapError error = map_error(built, room(), {.half_width_m = 0.4, .half_turn_rad = 0.0});
    CHECK(error.at_window_edge);
    CHECK(error.P_truth_built.x_m == Approx(-0.4));
}

TEST_CASE("Without a window the maps are compared as they lie", "[eval][map]") {
    GridMap truth = blank(100, 100, 0.1);
    wall(truth, 10, 50, 89, 50);
    GridMap built = blank(100, 100, 0.1);
    wall(built, 10, 53, 89, 53);
    const MapError error = map_error(built, truth, kNoAlignment);
    CHECK(error.built_to_truth_m.mean == Approx(0.3));
    CHECK(error.truth_to_built_m.p95 == Approx(0.3));
    CHECK(error.sum_per_truth_cell_m() == Approx(0.3));
    CHECK_FALSE(error.at_window_edge);
}

TEST_CASE("A wall that was built twice raises the sum over the true cells", "[eval][map]") {
    GridMap truth = blank(100, 100, 0.1);
    wall(truth, 10, 10, 89, 10);
    wall(truth, 10, 60, 89, 60);
    GridMap built = truth;
    wall(built, 10, 64, 89, 64);
    // 80 of 240 built cells lie 0.4 m off; there are 160 true cells.
    const MapError error = map_error(built, truth, kNoAlignment);
    CHECK(error.sum_per_truth_cell_m() == Approx(80 * 0.4 / 160));
    CHECK(error.built_to_truth_m.mean == Approx(80 * 0.4 / 240));
    CHECK(error.built_to_truth_m.p95 == Approx(0.4));
    CHECK(error.truth_to_built_m.max < 1e-9);
    // Nor does it pull the alignment away from the walls that fit.
    check_near(map_error(built, truth, {}).P_truth_built, {}, 0.03, 0.1);
}

TEST_CASE("A wall that is missing shows in the reverse direction only", "[eval][map]") {
    GridMap built = room();
    for (int y = 6; y <= 70; ++y) {
        cell(built, 60, y) = GridCell::kFree;
    }
    const MapError error = map_error(built, room(), {});
    CHECK(error.built_to_truth_m.max < 1e-6);
    CHECK(error.sum_per_truth_cell_m() < 1e-6);
    CHECK(error.truth_to_built_m.mean > 0.05);
    CHECK(error.truth_to_built_m.max > 1.0);
}

TEST_CASE("Unknown cells are not walls", "[eval][map]") {
    GridMap built = room();
    cell(built, 30, 60) = GridCell::kUnknown;
    CHECK(map_error(built, room(), kNoAlignment).built_to_truth_m.max < 1e-9);
}

TEST_CASE("Maps of different resolutions are compared in cells of the truth", "[eval][map]") {
    const double resolution_m = GENERATE(0.025, 0.1);
    const GridMap built = redrawn(room(), {}, static_cast<int>(std::lround(8.0 / resolution_m)),
                                  static_cast<int>(std::lround(6.0 / resolution_m)), resolution_m);
    const MapError error = map_error(built, room(), kNoAlignment);
    CHECK(error.cell_m == 0.05);
    // A fine map falls into the cells it was drawn from; a coarse one is off by less than one of its own cells.
    CHECK(error.built_to_truth_m.max < (resolution_m < 0.05 ? 1e-9 : 0.1));
    if (resolution_m < 0.05) {
        CHECK(error.built_to_truth_m.count == error.truth_to_built_m.count);
        CHECK(error.truth_to_built_m.max < 1e-9);
    }
}

TEST_CASE("What cannot be compared is refused", "[eval][map]") {
    CHECK_THROWS_AS(map_error(blank(10, 10, 0.05), room(), {}), std::invalid_argument);
    CHECK_THROWS_AS(map_error(room(), blank(10, 10, 0.05), {}), std::invalid_argument);
    CHECK_THROWS_AS(map_error(room(), room(), {.half_width_m = 1000.0}), InputError);
    GridMap coarse = room();
    coarse.resolution_m = 1000.0;
    CHECK_THROWS_AS(map_error(coarse, room(), {}), InputError);
}

TEST_CASE("A planted transform is recovered on the 1r5 map", "[eval][map]") {
    const auto yaml = test::recording("maps/1r5.yaml");
    CRSPF_NEED_RECORDING(yaml)
    const GridMap truth = read_grid_map(yaml);
    const Pose2 planted{.x_m = 0.8, .y_m = -0.55, .theta_rad = radians(5.0)};
    const MapError error = map_error(redrawn(truth, planted, 280, 300, truth.resolution_m), truth, {});
    check_near(error.P_truth_built, planted, 0.02, 0.1);
    CHECK(error.built_to_truth_m.mean < 0.025);
    CHECK(error.truth_to_built_m.mean < 0.1);
}
