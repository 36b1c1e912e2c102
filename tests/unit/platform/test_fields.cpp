#include "platform/files/fields.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <limits>

using crspf::Fields;

TEST_CASE("fields: words are what stands between blanks of any kind and number") {
    Fields fields(" \tone  two\t\tthree\r");
    CHECK(fields.word() == "one");
    CHECK(fields.word() == "two");
    CHECK_FALSE(fields.at_end());
    CHECK(fields.word() == "three");
    CHECK(fields.at_end());
    CHECK(fields.word().empty());
}

TEST_CASE("fields: an empty line, and one of blanks, are at the end at once") {
    CHECK(Fields("").at_end());
    CHECK(Fields({}).at_end());
    CHECK(Fields(" \t\r").at_end());
}

TEST_CASE("fields: numbers are read one after the other") {
    Fields fields("1.5 -2 3e2");
    double a = 0.0;
    float b = 0.0F;
    std::uint32_t c = 7;
    REQUIRE(fields.numbers(a, b));
    CHECK(a == 1.5);
    CHECK(b == -2.0F);
    CHECK_FALSE(fields.number(c));  // 3e2 is no whole number
    CHECK(c == 3);
    CHECK(fields.word() == "3e2");  // and was not consumed
}

TEST_CASE("fields: a field that only begins as a number is none") {
    double value = 0.0;
    for (const char* text : {"1.5x", "x", "", "1,5", "--1", "0x10", "+1"}) {
        INFO(text);
        CHECK_FALSE(Fields(text).number(value));
    }
}

TEST_CASE("fields: numbers beyond a type's range are NaN, or none for whole numbers") {
    float narrow = 0.0F;
    REQUIRE(Fields("1e39").number(narrow));
    CHECK(std::isnan(narrow));
    double wide = 0.0;
    REQUIRE(Fields("-1e999").number(wide));
    CHECK(std::isnan(wide));
    std::uint32_t whole = 0;
    CHECK_FALSE(Fields("4294967296").number(whole));
    CHECK_FALSE(Fields("-1").number(whole));
}

TEST_CASE("fields: nan and inf are numbers") {
    double value = 0.0;
    REQUIRE(Fields("nan").number(value));
    CHECK(std::isnan(value));
    REQUIRE(Fields("-inf").number(value));
    CHECK(value == -std::numeric_limits<double>::infinity());
}
