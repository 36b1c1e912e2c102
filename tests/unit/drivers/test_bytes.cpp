#include <array>
#include <catch2/catch.hpp>
#include <cstdint>

#include "drivers/common/byte_reader.hpp"
#include "drivers/common/byte_writer.hpp"

using namespace crspf;

TEST_CASE("bytes: what is written is read, in either order") {
    std::array<std::uint8_t, 32> buffer{};
    ByteWriter out(buffer);
    out.byte(0xFE);
    out.little(std::uint16_t{0xEEFF});
    out.big(std::uint32_t{0x01020304});
    out.little(std::int32_t{-2});
    out.big_float(1.5F);
    out.little_float(-0.25F);
    REQUIRE(out.ok());
    CHECK(out.position() == 19);
    CHECK(buffer[1] == 0xFF);
    CHECK(buffer[2] == 0xEE);
    CHECK(buffer[3] == 0x01);
    ByteReader in(out.written());
    CHECK(in.byte() == 0xFE);
    CHECK(in.little<std::uint16_t>() == 0xEEFF);
    CHECK(in.big<std::uint32_t>() == 0x01020304);
    CHECK(in.little<std::int32_t>() == -2);
    CHECK(in.big_float() == 1.5F);
    CHECK(in.little_float() == -0.25F);
    CHECK(in.ok());
    CHECK(in.left() == 0);
}

TEST_CASE("bytes: past the end") {
    std::array<std::uint8_t, 3> buffer{1, 2, 3};
    ByteReader in(buffer);
    CHECK(in.little<std::uint32_t>() == 0);
    CHECK_FALSE(in.ok());
    CHECK(in.byte() == 0);
    CHECK_FALSE(in.ok());

    ByteWriter out(buffer);
    out.little(std::uint32_t{0xFFFFFFFF});
    CHECK_FALSE(out.ok());
    CHECK(out.position() == 0);
    CHECK(buffer[0] == 1);
}
