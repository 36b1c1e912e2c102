#include <array>
#include <catch2/catch.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "platform/files/base64.hpp"

using namespace crspf;

TEST_CASE("base64: the examples of RFC 4648, both ways") {
    constexpr std::array<std::pair<std::string_view, std::string_view>, 7> kExamples{{{"", ""},
                                                                                      {"f", "Zg=="},
                                                                                      {"fo", "Zm8="},
                                                                                      {"foo", "Zm9v"},
                                                                                      {"foob", "Zm9vYg=="},
                                                                                      {"fooba", "Zm9vYmE="},
                                                                                      {"foobar", "Zm9vYmFy"}}};
    for (const auto& [bytes, text] : kExamples) {
        const std::vector<std::uint8_t> given(bytes.begin(), bytes.end());
        CHECK(to_base64(given) == text);
        const auto back = from_base64(text);
        REQUIRE(back);
        CHECK(*back == given);
    }
    CHECK(to_base64(std::array<std::uint8_t, 3>{0xFB, 0xFF, 0xFE}) == "+//+");
}

TEST_CASE("base64: what is none gives none") {
    for (const std::string_view text : {"Zg", "Zg=", "Z", "Zm9v!", "Zm9=v", "\xFF\xFF\xFF\xFF"}) {
        CAPTURE(text);
        CHECK_FALSE(from_base64(text));
    }
}
