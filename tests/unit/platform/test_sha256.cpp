#include "platform/files/sha256.hpp"

#include <catch2/catch.hpp>
#include <string>

namespace {

void feed(crspf::Sha256& hash, const std::string& text) {
    hash.update(std::as_bytes(std::span(text)));
}

}  // namespace

// Examples of FIPS 180-2, appendix B.
TEST_CASE("sha256: the standard's examples") {
    crspf::Sha256 hash;
    CHECK(hash.hex() == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    feed(hash, "abc");
    CHECK(hash.hex() == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    feed(hash, "abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq");
    CHECK(hash.hex() == "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

TEST_CASE("sha256: pieces hash as the whole") {
    crspf::Sha256 hash;
    feed(hash, "a");
    hash.update({});
    feed(hash, "bc");
    CHECK(hash.hex() == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}
