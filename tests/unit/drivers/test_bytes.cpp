#include <array>
#include <catch2/catch.hpp>
#include <cstdint>
#include <span>

#include "drivers/common/byte_reader.hpp"
#include "drivers/common/byte_writer.hpp"
#include "drivers/common/stream_buffer.hpp"

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
    out.little_double(0.1);
    REQUIRE(out.ok());
    CHECK(out.position() == 27);
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
    CHECK(in.little_double() == 0.1);
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

TEST_CASE("bytes: a stream's buffer takes what fits and keeps what is pending") {
    StreamBuffer<4> buffer;
    const std::array<std::uint8_t, 6> bytes{1, 2, 3, 4, 5, 6};
    CHECK(buffer.append(bytes) == 4);
    CHECK(buffer.append(bytes) == 0);
    buffer.consume(3);
    CHECK(buffer.append(std::span(bytes).subspan(4)) == 2);
    REQUIRE(buffer.pending().size() == 3);
    CHECK(buffer.pending()[0] == 4);
    CHECK(buffer.pending()[2] == 6);
    buffer.clear();
    CHECK(buffer.pending().empty());
}
