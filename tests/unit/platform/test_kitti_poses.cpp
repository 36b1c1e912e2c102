#include "platform/files/kitti_poses.hpp"

#include <catch2/catch.hpp>
#include <fstream>

#include "platform/files/input_error.hpp"
#include "tests/unit/platform/scratch.hpp"

using Catch::Matchers::Contains;
using namespace crspf;
using crspf::test::content_of;
using crspf::test::Scratch;

namespace {

constexpr KittiPose kTurned{0.0, 0.0, 1.0, 1.5, 0.0, 1.0, 0.0, -2.0, -1.0, 0.0, 0.0, 3.25};

}  // namespace

TEST_CASE("kitti poses: what was written is read back") {
    const Scratch scratch;
    const std::vector<KittiPose> poses{{1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0}, kTurned};
    write_kitti_poses(poses, scratch / "p");
    CHECK(looks_like_kitti_poses(scratch / "p"));
    CHECK(read_kitti_poses(scratch / "p") == poses);
    CHECK(content_of(scratch / "p").starts_with("1.000000000 0.000000000 "));
}

TEST_CASE("kitti poses: exponents and empty lines are understood, other files are told apart") {
    const Scratch scratch;
    std::ofstream(scratch / "p") << "\n0e0 0 1 1.5 0 1.0e+00 0 -2 -1 0 0 3.25\r\n\n";
    CHECK(read_kitti_poses(scratch / "p") == std::vector<KittiPose>{kTurned});
    std::ofstream(scratch / "t") << "# TUM\n0.1 1 2 0 0 0 0 1\n";
    CHECK_FALSE(looks_like_kitti_poses(scratch / "t"));
}

TEST_CASE("kitti poses: a line that is none is named") {
    const Scratch scratch;
    const char* const line = GENERATE("1 0 0 0 0 1 0 0 0 0 1", "1 0 0 0 0 1 0 0 0 0 1 0 7", "1 0 0 nan 0 1 0 0 0 0 1 0",
                                      "2 0 0 0 0 1 0 0 0 0 1 0", "1 0 0 0 1 0 0 0 0 0 1 0");
    std::ofstream(scratch / "p") << "1 0 0 0 0 1 0 0 0 0 1 0\n" << line << "\n";
    CHECK_THROWS_WITH(read_kitti_poses(scratch / "p"), Contains("p:2: not a pose in KITTI's format"));
}
