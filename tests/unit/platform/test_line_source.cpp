#include "platform/capture/line_source.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "platform/files/input_error.hpp"
#include "tests/unit/platform/scratch.hpp"

using Catch::Matchers::Contains;
using crspf::InputError;
using crspf::LineSource;
using crspf::test::compressed;
using crspf::test::Scratch;

namespace {

std::vector<std::string> lines_of(const std::filesystem::path& file) {
    LineSource source(file);
    std::vector<std::string> lines;
    for (LineSource::Line line; source.next(line);) {
        lines.emplace_back(line.too_long ? "<too long>" : line.text);
        REQUIRE(source.line_number() == lines.size());
    }
    return lines;
}

/// Lines of growing length that cannot be compressed to nothing, across many blocks.
std::string long_text() {
    std::string text;
    std::uint32_t state = 1;
    for (std::size_t i = 0; i < 700; ++i) {
        for (std::size_t k = 0; k < i; ++k) {
            state = state * 1664525U + 1013904223U;
            text += static_cast<char>('!' + (state >> 24U) % 90);
        }
        text += '\n';
    }
    return text;
}

std::vector<std::string> split(const std::string& text) {
    std::vector<std::string> lines;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = text.find('\n', at);
        lines.push_back(text.substr(at, end - at));
        at = end + 1;
    }
    return lines;
}

}  // namespace

TEST_CASE("line source: lines are lines, the last one with or without its end") {
    const Scratch scratch;
    using Lines = std::vector<std::string>;
    CHECK(lines_of(scratch.file("a", "one\n\ntwo\r\nthree")) == Lines{"one", "", "two\r", "three"});
    CHECK(lines_of(scratch.file("b", "one\n")) == Lines{"one"});
    CHECK(lines_of(scratch.file("c", "\n")) == Lines{""});
    CHECK(lines_of(scratch.file("d", std::string("a\0b\nc", 5))) == Lines{std::string("a\0b", 3), "c"});
}

TEST_CASE("line source: every compression gives the same lines") {
    const Scratch scratch;
    const std::string text = long_text();
    REQUIRE(lines_of(scratch.file("plain", text)) == split(text));
    for (const char* filter : {"gzip", "bzip2", "xz", "lzma", "zstd", "lz4"}) {
        INFO(filter);
        CHECK(lines_of(scratch.file(filter, compressed(text, filter))) == split(text));
    }
}

TEST_CASE("line source: a line up to the bound is delivered, a longer one passed over and marked") {
    const Scratch scratch;
    const std::string longest(LineSource::kLineMax, 'x');
    const auto lines = lines_of(scratch.file("a", "a\n" + longest + "\nb\n" + longest + "y\nc\n" + longest + longest));
    REQUIRE(lines.size() == 6);
    CHECK(lines[1] == longest);
    CHECK(lines[2] == "b");
    CHECK(lines[3] == "<too long>");
    CHECK(lines[4] == "c");
    CHECK(lines[5] == "<too long>");
}

TEST_CASE("line source: progress runs from 0 to 1 with the compressed bytes") {
    const Scratch scratch;
    for (const char* filter : {"xz", "gzip"}) {
        LineSource source(scratch.file(filter, compressed(long_text(), filter)));
        double before = source.progress();
        CHECK(before < 0.7);
        int steps = 0;
        for (LineSource::Line line; source.next(line);) {
            REQUIRE(source.progress() >= before);
            steps += source.progress() > before ? 1 : 0;
            before = source.progress();
        }
        CHECK(steps > 1);
        CHECK(before == 1.0);
    }
}

TEST_CASE("line source: a file cut short gives what was readable, then says so") {
    const Scratch scratch;
    const std::string text = long_text();
    for (const char* filter : {"gzip", "bzip2", "xz", "zstd"}) {
        INFO(filter);
        const std::string whole = compressed(text, filter);
        const auto file = scratch.file(filter, whole.substr(0, whole.size() * 3 / 4));
        std::vector<std::string> lines;
        const auto read = [&] {
            LineSource source(file);
            LineSource::Line line;
            try {
                while (source.next(line)) {
                    lines.emplace_back(line.text);
                }
            } catch (const InputError&) {
                static_cast<void>(source.next(line));  // does not become an end of file later
            }
        };
        CHECK_THROWS_WITH(read(), Contains(filter) && Contains("cannot be read on") && Contains("cut short"));
        const auto all = split(text);
        if (std::string(filter) != "bzip2") {  // its blocks are larger than this text
            CHECK(lines.size() > 100);
        }
        REQUIRE(lines.size() < all.size());
        CHECK(std::equal(lines.begin(), lines.end(), all.begin()));
    }
}

TEST_CASE("line source: damage inside a compressed file is found") {
    const Scratch scratch;
    std::string bytes = compressed(long_text(), "xz");
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x55);
    CHECK_THROWS_AS(lines_of(scratch.file("damaged.xz", bytes)), InputError);
}

TEST_CASE("line source: an empty file says so, compressed or not") {
    const Scratch scratch;
    CHECK_THROWS_WITH(LineSource(scratch.file("empty", "")), Contains(": empty; "));
    for (const char* filter : {"gzip", "bzip2", "xz", "zstd"}) {
        INFO(filter);
        CHECK_THROWS_WITH(LineSource(scratch.file("e", compressed("", filter))), Contains("e: empty; "));
    }
}

TEST_CASE("line source: what cannot be opened is named with its cause") {
    const Scratch scratch;
    CHECK_THROWS_WITH(LineSource(scratch / "none"), Contains("none: cannot be read: No such file"));
    CHECK_THROWS_WITH(LineSource(scratch.directory()), Contains("Is a directory"));
}
