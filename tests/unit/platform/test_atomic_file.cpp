#include "platform/files/atomic_file.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <string>

#include "platform/files/input_error.hpp"
#include "tests/unit/platform/scratch.hpp"

using Catch::Matchers::Contains;
using crspf::AtomicFile;
using crspf::InputError;
using crspf::test::content_of;
using crspf::test::Scratch;
using Names = std::vector<std::string>;

namespace {

void write_whole(const std::filesystem::path& target, const std::string& content) {
    AtomicFile file(target);
    file.write(content);
    file.commit();
}

/// While it lives, a file cannot grow beyond `bytes`: a stand-in for a full disk that needs no privilege.
class FileSizeLimit {
 public:
    explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        getrlimit(RLIMIT_FSIZE, &before_);
        rlimit limit = before_;
        limit.rlim_cur = bytes;
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    FileSizeLimit(const FileSizeLimit&) = delete;
    FileSizeLimit& operator=(const FileSizeLimit&) = delete;
    ~FileSizeLimit() {
        setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }

 private:
    rlimit before_{};
    void (*handler_)(int);
};

}  // namespace

TEST_CASE("atomic file: the target appears at commit, whole, and nothing is left beside it") {
    const Scratch scratch;
    {
        AtomicFile file(scratch / "out");
        file.write("one ");
        file.write("");
        file.write("two");
        CHECK_FALSE(std::filesystem::exists(scratch / "out"));
        file.commit();
    }
    CHECK(content_of(scratch / "out") == "one two");
    CHECK(scratch.names() == Names{"out"});
}

TEST_CASE("atomic file: pieces smaller and larger than the buffer keep their order") {
    const Scratch scratch;
    std::string expected;
    AtomicFile file(scratch / "out");
    for (int i = 0; i < 50; ++i) {
        const std::string piece(static_cast<std::size_t>(i * i * 40), static_cast<char>('a' + i % 26));
        file.write(piece);
        expected += piece;
    }
    file.commit();
    CHECK(content_of(scratch / "out") == expected);
}

TEST_CASE("atomic file: without commit the old content stays and the temporary goes") {
    const Scratch scratch;
    scratch.file("out", "old");
    {
        AtomicFile file(scratch / "out");
        file.write("new");
    }
    CHECK(content_of(scratch / "out") == "old");
    CHECK(scratch.names() == Names{"out"});
}

TEST_CASE("atomic file: commit replaces what was there") {
    const Scratch scratch;
    scratch.file("out", "old and longer");
    write_whole(scratch / "out", "new");
    CHECK(content_of(scratch / "out") == "new");
}

TEST_CASE("atomic file: a symbolic link is followed, not replaced") {
    const Scratch scratch;
    scratch.file("real", "old");
    std::filesystem::create_symlink(scratch / "real", scratch / "link");
    write_whole(scratch / "link", "new");
    CHECK(std::filesystem::is_symlink(scratch / "link"));
    CHECK(content_of(scratch / "real") == "new");
}

TEST_CASE("atomic file: a new file has the permissions that the user's mask gives") {
    const Scratch scratch;
    const mode_t before = umask(027);
    write_whole(scratch / "out", "x");
    umask(before);
    struct stat status {};
    REQUIRE(stat((scratch / "out").c_str(), &status) == 0);
    CHECK((status.st_mode & 0777U) == 0640U);
}

TEST_CASE("atomic file: a stale temporary of the same name is passed over") {
    const Scratch scratch;
    scratch.file("out.tmp" + std::to_string(getpid()) + "-0", "stale");
    write_whole(scratch / "out", "new");
    CHECK(content_of(scratch / "out") == "new");
}

TEST_CASE("atomic file: two writers of one target do not meet, the last commit stands") {
    const Scratch scratch;
    AtomicFile first(scratch / "out");
    AtomicFile second(scratch / "out");
    first.write("first");
    second.write("second");
    second.commit();
    first.commit();
    CHECK(content_of(scratch / "out") == "first");
    CHECK(scratch.names() == Names{"out"});
}

TEST_CASE("atomic file: a disk that fills up is found, named, and leaves the old content") {
    const Scratch scratch;
    scratch.file("out", "old");
    for (const std::size_t size : {5000U, 500000U}) {  // found by commit(), found by write()
        const FileSizeLimit limit(4096);
        CHECK_THROWS_WITH(write_whole(scratch / "out", std::string(size, 'x')),
                          Contains((scratch / "out").string()) && Contains("cannot be written") && Contains("; "));
    }
    CHECK(content_of(scratch / "out") == "old");
    CHECK(scratch.names() == Names{"out"});
}

TEST_CASE("atomic file: a device is written to directly, and its errors are found") {
    CHECK_THROWS_WITH(write_whole("/dev/full", "x"), Contains("/dev/full") && Contains("No space left"));
    CHECK_THROWS_WITH(write_whole("/dev/full", std::string(100000, 'x')), Contains("No space left"));
    struct stat status {};
    REQUIRE(stat("/dev/full", &status) == 0);
    CHECK(S_ISCHR(status.st_mode));
    CHECK_NOTHROW(write_whole("/dev/null", "x"));
}

TEST_CASE("atomic file: a target that cannot be is refused at once, with a remedy") {
    const Scratch scratch;
    CHECK_THROWS_WITH(AtomicFile(scratch / "none/out"), Contains("create the directory first"));
    CHECK_THROWS_WITH(AtomicFile(scratch.directory()), Contains("name a file, not a directory"));
    scratch.file("plain", "");
    CHECK_THROWS_AS(AtomicFile(scratch / "plain/out"), InputError);
}
