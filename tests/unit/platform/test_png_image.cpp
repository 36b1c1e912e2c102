#include "platform/files/png_image.hpp"

#include <png.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>

#include "platform/files/input_error.hpp"
#include "platform/files/read_file.hpp"
#include "tests/unit/platform/scratch.hpp"

using crspf::draw_map;
using crspf::encode_png;
using crspf::GridCell;
using crspf::GridMap;
using crspf::Rgb;
using crspf::RgbImage;
using crspf::TimedPose;
using crspf::write_png;
using crspf::test::Scratch;

namespace {

GridMap blank_map(int width, int height) {
    GridMap map{.width = width, .height = height, .resolution_m = 0.1, .P_map_origin = {}, .cells = {}};
    map.cells.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), GridCell::kFree);
    return map;
}

RgbImage read_png(const std::filesystem::path& file) {
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    REQUIRE(png_image_begin_read_from_file(&png, file.c_str()) != 0);
    png.format = PNG_FORMAT_RGB;
    RgbImage image{static_cast<int>(png.width), static_cast<int>(png.height), {}};
    image.pixels.resize(static_cast<std::size_t>(png.width) * png.height);
    REQUIRE(png_image_finish_read(&png, nullptr, image.pixels.data(), 0, nullptr) != 0);
    return image;
}

std::ptrdiff_t pixels_of(const RgbImage& image, Rgb colour) {
    return std::count(image.pixels.begin(), image.pixels.end(), colour);
}

}  // namespace

TEST_CASE("png: what was written is read back by libpng") {
    const Scratch scratch;
    RgbImage image{3, 2, {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {255, 0, 0}, {0, 255, 0}, {0, 0, 255}}};
    write_png(image, scratch / "i.png");
    const RgbImage back = read_png(scratch / "i.png");
    CHECK(back.width == 3);
    CHECK(back.height == 2);
    CHECK(back.pixels == image.pixels);
    CHECK(scratch.names() == std::vector<std::string>{"i.png"});
}

TEST_CASE("png: in memory it is what the file holds") {
    const Scratch scratch;
    const RgbImage image{2, 1, {{1, 2, 3}, {250, 128, 0}}};
    write_png(image, scratch / "i.png");
    const std::string file = crspf::read_file(scratch / "i.png", 4096);
    const std::vector<std::uint8_t> bytes = encode_png(image);
    CHECK(std::equal(bytes.begin(), bytes.end(), file.begin(), file.end(),
                     [](std::uint8_t byte, char of_file) { return byte == static_cast<std::uint8_t>(of_file); }));
    CHECK_THROWS_AS(encode_png({}), crspf::InputError);
    CHECK_THROWS_AS(encode_png({crspf::kImageSideMax + 1, 1, {}}), crspf::InputError);
}

TEST_CASE("png: a full disk and an empty image are errors") {
    CHECK_THROWS_AS(write_png({1, 1, {{}}}, "/dev/full"), crspf::InputError);
    const Scratch scratch;
    CHECK_THROWS_AS(write_png({}, scratch / "i.png"), crspf::InputError);
    CHECK(scratch.names().empty());
}

TEST_CASE("draw map: cells have their colours, the highest y on top") {
    GridMap map = blank_map(2, 2);
    map.cells = {GridCell::kFree, GridCell::kOccupied, GridCell::kUnknown, GridCell::kFree};
    const RgbImage image = draw_map(map, {});
    CHECK(image.pixels ==
          std::vector{crspf::kUnknownColour, crspf::kFreeColour, crspf::kFreeColour, crspf::kOccupiedColour});
}

TEST_CASE("draw map: a large map is reduced to the bound and keeps its thin walls") {
    GridMap map = blank_map(1000, 10);
    map.cells[5 * 1000 + 999] = GridCell::kOccupied;
    const RgbImage image = draw_map(map, {}, 300);
    CHECK(image.width == 250);
    CHECK(image.height == 3);
    CHECK(pixels_of(image, crspf::kOccupiedColour) == 1);
}

TEST_CASE("draw map: the path is a line without gaps between two discs, placed by the map's origin") {
    GridMap map = blank_map(100, 100);
    map.P_map_origin = {-5.0, -5.0, 0.0};
    const std::vector<TimedPose> path{{0.0, {-4.0, 0.05, 0.0}}, {1.0, {4.0, 0.05, 0.0}}};
    RgbImage image = draw_map(map, path);
    CHECK(image.at(10, 49) == crspf::kStartColour);
    CHECK(image.at(90, 49) == crspf::kEndColour);
    for (int x = 13; x < 88; ++x) {
        INFO(x);
        CHECK(image.at(x, 49) == crspf::kPathColour);
    }
    CHECK(pixels_of(image, crspf::kPathColour) < 80);
}

TEST_CASE("draw map: a turned map turns the path") {
    GridMap map = blank_map(100, 100);
    map.P_map_origin = {0.0, 0.0, crspf::kPi / 2.0};
    const std::vector<TimedPose> path{{0.0, {-1.05, 2.05, 0.0}}};
    RgbImage image = draw_map(map, path);
    CHECK(image.at(20, 99 - 10) == crspf::kEndColour);
}

TEST_CASE("draw map: poses far outside and non-finite ones do no harm") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<TimedPose> path{{0.0, {-1e300, 0.0, 0.0}}, {1.0, {nan, nan, nan}}, {2.0, {-1e6, 5.05, 0.0}},
                                      {3.0, {1e6, 5.05, 0.0}},   {4.0, {1e6, 1e6, 0.0}}, {5.0, {5.05, 1e6, 0.0}}};
    RgbImage image = draw_map(blank_map(100, 100), path);
    for (int x = 0; x < 100; ++x) {
        CHECK(image.at(x, 49) == crspf::kPathColour);
    }
    CHECK(pixels_of(image, crspf::kPathColour) == 100);
    CHECK(pixels_of(image, crspf::kStartColour) == 0);
}
