#include "platform/files/read_file.hpp"

#include <catch2/catch.hpp>
#include <string>

#include "platform/files/input_error.hpp"
#include "tests/unit/platform/scratch.hpp"

using Catch::Matchers::Contains;
using crspf::InputError;
using crspf::read_file;
using crspf::test::Scratch;

TEST_CASE("read_file: gives the bytes as they are") {
    const Scratch scratch;
    const std::string bytes("a\0b\r\n\xff", 6);
    CHECK(read_file(scratch.file("f", bytes), 100) == bytes);
    CHECK(read_file(scratch.file("empty", ""), 100).empty());
}

TEST_CASE("read_file: a file as large as the bound is read, one byte more is not") {
    const Scratch scratch;
    const auto file = scratch.file("f", std::string(200000, 'x'));
    CHECK(read_file(file, 200000).size() == 200000);
    CHECK_THROWS_WITH(read_file(file, 199999), Contains(file.string()) && Contains("larger than 199999 bytes"));
}

TEST_CASE("read_file: an endless device meets the bound") {
    CHECK_THROWS_AS(read_file("/dev/zero", 100000), InputError);
}

TEST_CASE("read_file: what is missing or no file is named with its cause") {
    const Scratch scratch;
    CHECK_THROWS_WITH(read_file(scratch / "none", 10), Contains("none") && Contains("No such file"));
    CHECK_THROWS_WITH(read_file(scratch.directory(), 10), Contains("Is a directory"));
}
