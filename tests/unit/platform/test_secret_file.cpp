#include "platform/files/secret_file.hpp"

#include <catch2/catch.hpp>
#include <filesystem>

#include "platform/files/input_error.hpp"
#include "tests/unit/platform/scratch.hpp"

using crspf::read_secret;
using crspf::test::Scratch;
using std::filesystem::perms;

TEST_CASE("read_secret: the secret without the end of its line") {
    const Scratch scratch;
    for (const char* content : {" a b ", " a b \n", " a b \r\n\n"}) {
        const auto file = scratch.file("secret", content);
        std::filesystem::permissions(file, perms::owner_read | perms::group_read);
        CHECK(read_secret(file) == " a b ");
        std::filesystem::permissions(file, perms::owner_all);
    }
}

TEST_CASE("read_secret: one that everybody can read is none, and is told how to become one") {
    const Scratch scratch;
    const auto file = scratch.file("secret", "word\n");
    std::filesystem::permissions(file, perms::owner_all | perms::others_read);
    CHECK_THROWS_WITH(read_secret(file),
                      file.string() + ": everybody can read this secret; chmod o-r " + file.string());
    CHECK_THROWS_AS(read_secret(scratch / "absent"), crspf::InputError);
}
