#include "platform/files/grid_map.hpp"

#include <catch2/catch.hpp>
#include <string>

#include "platform/files/input_error.hpp"
#include "tests/unit/platform/scratch.hpp"

using Catch::Matchers::Contains;
using crspf::GridCell;
using crspf::GridMap;
using crspf::read_grid_map;
using crspf::write_grid_map;
using crspf::test::content_of;
using crspf::test::Scratch;

namespace {

GridMap small_map() {
    return {.width = 3,
            .height = 2,
            .resolution_m = 0.025,
            .P_map_origin = {-12.345, 0.1, -0.5},
            .cells = {GridCell::kOccupied, GridCell::kFree, GridCell::kUnknown, GridCell::kUnknown, GridCell::kUnknown,
                      GridCell::kFree}};
}

}  // namespace

TEST_CASE("grid map: the files are what map_server expects, byte for byte") {
    const Scratch scratch;
    write_grid_map(small_map(), scratch / "map");
    CHECK(content_of(scratch / "map.yaml") ==
          "image: map.pgm\nmode: trinary\nresolution: 0.025\norigin: [-12.345, 0.1, -0.5]\nnegate: 0\n"
          "occupied_thresh: 0.65\nfree_thresh: 0.196\n");
    CHECK(content_of(scratch / "map.pgm") ==
          "P5\n# CREATOR: crspf 0.025 m/pix\n3 2\n255\n" + std::string("\xcd\xcd\xfe\x00\xfe\xcd", 6));
    CHECK(scratch.names() == std::vector<std::string>{"map.pgm", "map.yaml"});
}

TEST_CASE("grid map: what was written is read back, whatever the name") {
    const Scratch scratch;
    const GridMap map = small_map();
    for (const char* stem : {"map", "run.1", "with blank", "it's # odd: yes", "-dash", "karte_\xc3\xa4"}) {
        INFO(stem);
        write_grid_map(map, scratch / stem);
        const GridMap back = read_grid_map(scratch / (std::string(stem) + ".yaml"));
        CHECK(back.width == map.width);
        CHECK(back.height == map.height);
        CHECK(back.resolution_m == map.resolution_m);
        CHECK(back.P_map_origin == map.P_map_origin);
        CHECK(back.cells == map.cells);
    }
}

TEST_CASE("grid map: an image elsewhere is found by its path") {
    const Scratch scratch;
    std::filesystem::create_directory(scratch / "images");
    scratch.file("images/m.pgm", "P2 1 1 255 254");
    const std::string rest =
        "\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
    CHECK(read_grid_map(scratch.file("a.yaml", "image: images/m.pgm" + rest)).width == 1);
    CHECK(read_grid_map(scratch.file("b.yaml", "image: " + (scratch / "images/m.pgm").string() + rest)).width == 1);
    CHECK_THROWS_WITH(read_grid_map(scratch.file("c.yaml", "image: none.pgm" + rest)),
                      Contains((scratch / "none.pgm").string()) && Contains("No such file"));
}

TEST_CASE("grid map: a file that is no description, or endless, is refused") {
    const Scratch scratch;
    CHECK_THROWS_AS(read_grid_map(scratch / "none.yaml"), crspf::InputError);
    CHECK_THROWS_AS(read_grid_map("/dev/zero"), crspf::InputError);
    CHECK_THROWS_AS(read_grid_map(scratch.file("m.yaml", std::string("P5\n\0\xff", 5))), crspf::InputError);
}

TEST_CASE("grid map: nothing is written where it cannot be whole") {
    const Scratch scratch;
    CHECK_THROWS_WITH(write_grid_map({}, scratch / "map"), Contains("the map is empty"));
    CHECK_THROWS_WITH(write_grid_map(small_map(), scratch / "none/map"), Contains("create the directory first"));
    std::filesystem::create_directory(scratch / "map.yaml");
    CHECK_THROWS_AS(write_grid_map(small_map(), scratch / "map"), crspf::InputError);
    CHECK(scratch.names() == std::vector<std::string>{"map.yaml"});
}
