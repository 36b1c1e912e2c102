#include "platform/capture/stereo_folder.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "platform/capture/stereo_record.hpp"
#include "platform/files/gray_png.hpp"
#include "platform/files/input_error.hpp"
#include "tests/unit/platform/scratch.hpp"

using Catch::Matchers::Contains;
using namespace crspf;
using crspf::test::Scratch;

namespace {

GrayImage picture(std::uint8_t grey) {
    GrayImage image(6, 4);
    image.pixels.assign(image.pixels.size(), grey);
    image.pixels[7] = 200;
    return image;
}

void write(const std::filesystem::path& file, std::uint8_t grey) {
    std::filesystem::create_directories(file.parent_path());
    const std::vector<std::uint8_t> png = encode_gray_png(picture(grey).view());
    std::ofstream(file, std::ios::binary) << std::string(png.begin(), png.end());
}

void write_text(const std::filesystem::path& file, const std::string& text) {
    std::ofstream(file) << text;
}

/// Two pairs, left grey 10 and 11, right 20 and 21.
void two_pairs(const std::filesystem::path& folder, const std::string& left, const std::string& right) {
    write(folder / left / "000000.png", 10);
    write(folder / left / "000001.png", 11);
    write(folder / right / "000000.png", 20);
    write(folder / right / "000001.png", 21);
}

}  // namespace

TEST_CASE("gray png: what was written is read back, a part of a picture, too") {
    const GrayImage image = picture(33);
    const GrayImage back = decode_gray_png(encode_gray_png(image.view()), "p");
    CHECK(back.width == 6);
    CHECK(back.height == 4);
    CHECK(back.pixels == image.pixels);
    const GrayImage part = decode_gray_png(encode_gray_png(image.columns(1, 3)), "p");
    CHECK(part.width == 3);
    CHECK(part.pixels[3] == 200);
    CHECK_THROWS_WITH(decode_gray_png({}, "left"), Contains("left: "));
}

TEST_CASE("stereo record: split as it was put together") {
    const std::vector<std::uint8_t> left{1, 2, 3};
    const std::vector<std::uint8_t> right{4, 5};
    std::vector<std::uint8_t> bytes;
    append_stereo_record(bytes, {.left_png = left, .right_png = right});
    CHECK(bytes == std::vector<std::uint8_t>{3, 0, 0, 0, 1, 2, 3, 4, 5});
    const auto back = split_stereo_record(bytes);
    REQUIRE(back);
    CHECK(std::vector(back->left_png.begin(), back->left_png.end()) == left);
    CHECK(std::vector(back->right_png.begin(), back->right_png.end()) == right);
    CHECK_FALSE(split_stereo_record(std::vector<std::uint8_t>{3, 0, 0, 0, 1, 2, 3}));
    CHECK_FALSE(split_stereo_record(std::vector<std::uint8_t>{0, 0, 0, 0, 1, 2, 3}));
    CHECK_FALSE(split_stereo_record(std::vector<std::uint8_t>{3, 0}));
}

TEST_CASE("stereo folder: pairs in the order of their names, with the stamps of times.txt") {
    const auto [left, right] = GENERATE(table<std::string, std::string>(
        {{"image_0", "image_1"}, {"image_2", "image_3"}, {"image_l", "image_r"}, {"left", "right"}}));
    const Scratch scratch;
    const std::filesystem::path folder = scratch / "k";
    two_pairs(folder, left, right);
    write_text(folder / "times.txt", "0.000000e+00\n1.036224e-01\n");
    CHECK(is_stereo_folder(folder));
    CHECK(is_capture(folder));
    const auto reader = open_capture(folder);
    CaptureRecord record;
    for (const int i : {0, 1}) {
        REQUIRE(reader->next(record));
        CHECK(record.link == LinkKind::kStereo);
        CHECK(record.stamp.ns == (i == 0 ? 0 : 103'622'400));
        const auto pair = split_stereo_record(record.bytes);
        REQUIRE(pair);
        CHECK(decode_gray_png(pair->left_png, "l").pixels == picture(static_cast<std::uint8_t>(10 + i)).pixels);
        CHECK(decode_gray_png(pair->right_png, "r").pixels == picture(static_cast<std::uint8_t>(20 + i)).pixels);
    }
    CHECK_FALSE(reader->next(record));
    CHECK(reader->progress() == 1.0);
    CHECK(calibration_of(folder).empty());
    write_text(folder / "calib.txt", "");
    CHECK(calibration_of(folder) == folder / "calib.txt");
}

TEST_CASE("stereo folder: without times.txt pairs are a tenth of a second apart") {
    const Scratch scratch;
    two_pairs(scratch / "k", "left", "right");
    const auto reader = open_stereo_folder(scratch / "k");
    CaptureRecord record;
    REQUIRE(reader->next(record));
    REQUIRE(reader->next(record));
    CHECK(record.stamp.ns == 100'000'000);
}

TEST_CASE("stereo folder: what is wrong is said, with the file's name") {
    const Scratch scratch;
    const std::filesystem::path folder = scratch / "k";
    CHECK_FALSE(is_stereo_folder(folder));
    two_pairs(folder, "left", "right");
    SECTION("a picture without its other") {
        write(folder / "right" / "000007.png", 1);
        CHECK_THROWS_WITH(open_stereo_folder(folder), Contains("right/000007.png: has no picture of the other camera"));
    }
    SECTION("and the other way") {
        std::filesystem::remove(folder / "right" / "000000.png");
        CHECK_THROWS_WITH(open_stereo_folder(folder), Contains("left/000000.png: has no picture of the other camera"));
    }
    SECTION("no pictures") {
        for (const char* const side : {"left", "right"}) {
            std::filesystem::remove(folder / side / "000000.png");
            std::filesystem::remove(folder / side / "000001.png");
        }
        CHECK_THROWS_WITH(open_stereo_folder(folder), Contains("left: no .png pictures"));
    }
    SECTION("too few times") {
        write_text(folder / "times.txt", "0.0\n");
        CHECK_THROWS_WITH(open_stereo_folder(folder), Contains("times.txt: holds 1 times for 2 pairs"));
    }
    SECTION("times that are none") {
        write_text(folder / "times.txt", "0.0\nsoon\n");
        CHECK_THROWS_WITH(open_stereo_folder(folder), Contains("times.txt:2: not a time"));
    }
}
