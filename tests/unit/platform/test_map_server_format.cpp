#include "platform/files/map_server_format.hpp"

#include <catch2/catch.hpp>
#include <string>

#include "platform/files/input_error.hpp"

using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;
using crspf::GridCell;
using crspf::GridMap;
using crspf::MapDescription;
using crspf::parse_map_yaml;
using crspf::parse_pgm;

namespace {

const std::string kYaml =
    "image: map.pgm\n"
    "resolution: 0.05\n"
    "origin: [-1.5, 2, 0.25]\n"
    "negate: 0\n"
    "occupied_thresh: 0.65\n"
    "free_thresh: 0.196\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    REQUIRE(at != text.npos);
    return text.replace(at, from.size(), to);
}

MapDescription yaml(const std::string& text) {
    return parse_map_yaml(text, "m.yaml");
}

GridMap pgm(const std::string& bytes, bool negate = false) {
    MapDescription description = yaml(kYaml);
    description.negate = negate;
    return parse_pgm(bytes, description, "m.pgm");
}

constexpr GridCell kUnknown = GridCell::kUnknown;
constexpr GridCell kFree = GridCell::kFree;
constexpr GridCell kOccupied = GridCell::kOccupied;

}  // namespace

TEST_CASE("map yaml: all keys") {
    const MapDescription d = yaml(kYaml);
    CHECK(d.image == "map.pgm");
    CHECK(d.resolution_m == 0.05);
    CHECK(d.P_map_origin == crspf::Pose2{-1.5, 2.0, 0.25});
    CHECK_FALSE(d.negate);
    CHECK(d.occupied_thresh == 0.65);
    CHECK(d.free_thresh == 0.196);
}

TEST_CASE("map yaml: what hands and tools write") {
    CHECK(yaml(replaced(kYaml, "negate: 0", "negate: 0       #se negate=1 -> preto-free")).negate == false);
    CHECK(yaml(replaced(kYaml, "negate: 0", "negate: true")).negate);
    CHECK(yaml(replaced(kYaml, "negate: 0", "negate: 1")).negate);
    CHECK(yaml(replaced(kYaml, "0.05", "5e-2")).resolution_m == 0.05);
    CHECK(yaml(replaced(kYaml, "map.pgm", "\"a # b.pgm\"  # comment")).image == "a # b.pgm");
    CHECK(yaml(replaced(kYaml, "map.pgm", "'it''s.pgm'")).image == "it's.pgm");
    CHECK(yaml(replaced(kYaml, "map.pgm", "a#b.pgm")).image == "a#b.pgm");
    CHECK(yaml(replaced(kYaml, "[-1.5, 2, 0.25]", "\n  - -1.5\n  - 2\n  - 0.25")).P_map_origin.x_m == -1.5);
    CHECK(yaml("# saved by hand\n---\n\n" + kYaml + "mode: trinary").image == "map.pgm");
    CHECK(yaml(kYaml + "mode: scale\nlethal_thresh: 9\n").image == "map.pgm");
    std::string windows;
    for (const char c : kYaml) {
        windows += c == '\n' ? "\r\n" : std::string(1, c);
    }
    CHECK(yaml(windows).image == "map.pgm");
}

TEST_CASE("map yaml: each key but mode is required") {
    for (const char* key : {"image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh"}) {
        const std::string text = replaced(kYaml, std::string(key) + ":", "other_" + std::string(key) + ":");
        CHECK_THROWS_WITH(yaml(text),
                          StartsWith("m.yaml:1: ") && Contains(std::string("`").append(key).append("` is missing")));
    }
}

TEST_CASE("map yaml: values that cannot be are refused with their line") {
    struct Case {
        const char* from;
        const char* to;
        const char* message;
    };
    for (const Case& c :
         {Case{"0.05", "0", "m.yaml:2: `resolution`"}, Case{"0.05", "-1", "m.yaml:2: `resolution`"},
          Case{"0.05", "nan", "m.yaml:2: `resolution`"}, Case{"0.05", "5 cm", "m.yaml:2: `resolution`"},
          Case{"[-1.5, 2, 0.25]", "[1, 2]", "m.yaml:3: `origin`"},
          Case{"[-1.5, 2, 0.25]", "[1, 2, 3, 4]", "m.yaml:3: `origin`"},
          Case{"[-1.5, 2, 0.25]", "[1, inf, 3]", "m.yaml:3: `origin`"},
          Case{"[-1.5, 2, 0.25]", "[1,", "m.yaml:3: `origin`"}, Case{"negate: 0", "negate: 2", "m.yaml:4: `negate`"},
          Case{"0.65", "1.5", "m.yaml:5: `occupied_thresh`"}, Case{"0.196", "0.7", "m.yaml:6: `free_thresh` is above"},
          Case{"map.pgm", "", "m.yaml:1: `image` is empty"},
          Case{"negate: 0", "resolution: 1", "m.yaml:4: `resolution` stands twice"},
          Case{"negate: 0", "negate", "m.yaml:4: not a `key: value` line"},
          Case{"negate: 0", "negate:0", "m.yaml:4: not a `key: value` line"},
          Case{"negate: 0", "negate: 0\nmode: raw", "m.yaml:5: `mode`"}}) {
        INFO(c.to);
        CHECK_THROWS_WITH(yaml(replaced(kYaml, c.from, c.to)), StartsWith(c.message));
    }
    CHECK_THROWS_AS(yaml(""), crspf::InputError);
    CHECK_THROWS_AS(yaml("- 1\n"), crspf::InputError);
}

TEST_CASE("pgm: the first row of the image is the highest y") {
    const GridMap map = pgm("P2\n3 2\n255\n0 205 254\n254 0 205\n");
    REQUIRE(map.width == 3);
    REQUIRE(map.height == 2);
    CHECK(map.cells == std::vector{kFree, kOccupied, kUnknown, kOccupied, kUnknown, kFree});
    CHECK(map.at(0, 1) == kOccupied);
    CHECK(map.resolution_m == 0.05);
    CHECK(map.P_map_origin.x_m == -1.5);
}

TEST_CASE("pgm: P5 reads as P2 does, blanks in the raster included") {
    CHECK(pgm("P5\n3 2\n255\n" + std::string("\x00\xcd\xfe\xfe\x00\xcd", 6)).cells ==
          pgm("P2\n3 2\n255\n0 205 254\n254 0 205\n").cells);
    CHECK(pgm("P5 2 1 255 \n ").cells == pgm("P2 2 1 255 10 32").cells);
}

TEST_CASE("pgm: comments stand anywhere in the head, and in all of a P2") {
    CHECK(pgm("P2 # magic\n# CREATOR: x 1 2 3\n1#w\n 1 #h\n255\n# raster\n254 #end").cells == std::vector{kFree});
    CHECK(pgm("P5\n# CREATOR: x\n1 1\n# y\n255\n\xfe").cells == std::vector{kFree});
}

TEST_CASE("pgm: thresholds and negate as map_server has them") {
    // (255 - 89) / 255 = 0.65098 > 0.65; (255 - 90) / 255 = 0.647; (255 - 206) / 255 = 0.192 < 0.196.
    CHECK(pgm("P2 4 1 255 89 90 205 206").cells == std::vector{kOccupied, kUnknown, kUnknown, kFree});
    CHECK(pgm("P2 4 1 255 166 165 50 49", true).cells == std::vector{kOccupied, kUnknown, kUnknown, kFree});
}

TEST_CASE("pgm: a smaller maxval is scaled") {
    CHECK(pgm("P2 3 1 4 0 2 4").cells == std::vector{kOccupied, kUnknown, kFree});
    CHECK(pgm("P2 2 1 1 0 1").cells == std::vector{kOccupied, kFree});
}

TEST_CASE("pgm: bytes behind the image are passed over, as other readers do") {
    CHECK(pgm("P5 1 1 255\n\xfe\n\n").cells.size() == 1);
}

TEST_CASE("pgm: what is no whole image is refused with its line") {
    struct Case {
        std::string bytes;
        const char* message;
    };
    for (const Case& c :
         {Case{"", "m.pgm:1: not a PGM image"}, Case{"P6 1 1 255\nabc", "m.pgm:1: not a PGM image"},
          Case{"\x89PNG", "m.pgm:1: not a PGM image"}, Case{"P5", "m.pgm:1: the width is missing"},
          Case{"P5\n\n2", "m.pgm:3: the height is missing"}, Case{"P5 2 x", "m.pgm:1: the height is missing"},
          Case{"P5 -2 2 255\n", "m.pgm:1: the width is missing"}, Case{"P5 0 2 255\n", "m.pgm:1: 0 x 2 cells"},
          Case{"P5 2 2 0\nabcd", "m.pgm:1: 2 x 2 cells, maxval 0"},
          Case{"P5 2 2 65535\nabcdabcd", "m.pgm:1: maxval is larger than 255"},
          Case{"P5 65537 1 255\n", "m.pgm:1: the width is larger"},
          Case{"P5 99999999999999999999 1 255\n", "m.pgm:1: the width is larger"},
          Case{"P5 65536 65536 255\n", "m.pgm:1: 65536 x 65536 cells"},
          Case{"P5 16384 16384 255\n", "m.pgm:1: the image ends before"},
          Case{"P2 16384 16384 255\n0 0", "m.pgm:1: the image ends before"},
          Case{"P5\n2 2\n255\nabc", "m.pgm:3: the image ends before its 4 cells"},
          Case{"P2\n2 2\n255\n1 2\n3 \n \n", "m.pgm:7: a cell is missing"},
          Case{"P2\n1 1\n100\n101\n", "m.pgm:4: a cell is larger than 100"},
          Case{"P5\n1 1\n100\n\x65", "m.pgm:3: cell 0 is brighter than maxval"}}) {
        INFO(c.bytes);
        CHECK_THROWS_WITH(pgm(c.bytes), StartsWith(c.message));
    }
}
