#include <catch2/catch.hpp>

#include "platform/linux/stereo_camera.hpp"
#include "tests/unit/platform/fake_video.hpp"

using namespace crspf;
using test::brightness;
using test::FakeVideo;

namespace {

constexpr Duration kWait{200'000'000};
constexpr Duration kPeriod{66'666'000};
constexpr Stamp kFirst{1'010'000'000};

const V4l2Params kParams{.device = "/dev/left", .width_px = 64, .height_px = 48, .rate_hz = 15.0};

/// Behind those that only open the cameras.
StereoPicture next_pair(StereoSource& source) {
    StereoPicture got;
    for (int i = 0; i < 5 && got.io.status == IoStatus::kRetry; ++i) {
        got = source.receive(kWait);
    }
    return got;
}

/// Which of its pictures it is.
int sequence_of(const GrayView& picture) {
    for (std::uint32_t s = 0; s < 30; ++s) {
        if (picture.pixels[picture.stride + 1] == brightness(1, 1, s)) {
            return static_cast<int>(s);
        }
    }
    return -1;
}

}  // namespace

TEST_CASE("stereo camera: one device, both pictures side by side") {
    FakeVideo video;
    test::FakeCamera& fake = video.cameras["/dev/left"];
    fake.formats = {{.code = V4L2_PIX_FMT_YUYV, .sizes = {{128, 48}}}};
    fake.shoot(3, kFirst, kPeriod);
    SideBySideCamera source(kParams, video);
    for (std::uint32_t s = 0; s < 3; ++s) {
        const StereoPicture got = next_pair(source);
        REQUIRE(got.io.status == IoStatus::kOk);
        CHECK(got.io.stamp == kFirst + Duration{s * kPeriod.ns});
        CHECK(got.pair.left.width == 64);
        CHECK(got.pair.right.width == 64);
        CHECK(got.pair.right.height == 48);
        CHECK(got.pair.left.pixels[3 * got.pair.left.stride + 2] == brightness(2, 3, s));
        CHECK(got.pair.right.pixels[3 * got.pair.right.stride + 2] == brightness(66, 3, s));
        CHECK(got.pair.right.pixels[47 * got.pair.right.stride + 63] == brightness(127, 47, s));
    }
    CHECK(source.counters().received == 3);
    fake.unplugged = true;
    CHECK(source.receive(kWait).io.status == IoStatus::kClosed);
    CHECK(source.problem().starts_with("/dev/left: "));
}

TEST_CASE("stereo camera: two devices, paired by their stamps") {
    FakeVideo video;
    test::FakeCamera& left = video.cameras["/dev/left"];
    test::FakeCamera& right = video.cameras["/dev/right"];
    left.shoot(10, kFirst, kPeriod);
    // 30 ms later each, near half a period: still a pair, and each with its own.
    right.shoot(10, kFirst + Duration{30'000'000}, kPeriod);
    PairedCameras source(kParams, "/dev/right", video);
    for (int s = 0; s < 10; ++s) {
        const StereoPicture got = next_pair(source);
        REQUIRE(got.io.status == IoStatus::kOk);
        CHECK(sequence_of(got.pair.left) == s);
        CHECK(sequence_of(got.pair.right) == s);
        CHECK(got.io.stamp == kFirst + Duration{s * kPeriod.ns});
    }
    CHECK(source.unpaired() == 0);
    CHECK(source.receive(kWait).io.status == IoStatus::kRetry);
}

TEST_CASE("stereo camera: a picture without a partner is dropped and counted, and the next pair is right") {
    FakeVideo video;
    test::FakeCamera& left = video.cameras["/dev/left"];
    test::FakeCamera& right = video.cameras["/dev/right"];
    left.shoot(8, kFirst, kPeriod);
    right.shoot(8, kFirst + Duration{1'000'000}, kPeriod);
    left.shots.erase(left.shots.begin() + 2);
    right.shots.erase(right.shots.begin());                               // before any pair
    right.shots.erase(right.shots.begin() + 4, right.shots.begin() + 6);  // 5 and 6
    PairedCameras source(kParams, "/dev/right", video);
    for (const int s : {1, 3, 4, 7}) {
        const StereoPicture got = next_pair(source);
        REQUIRE(got.io.status == IoStatus::kOk);
        CHECK(sequence_of(got.pair.left) == s);
        CHECK(sequence_of(got.pair.right) == s);
    }
    CHECK(source.unpaired() == 4);
    CHECK(source.left_counters().received == 7);
    CHECK(source.right_counters().received == 5);
}

TEST_CASE("stereo camera: pictures far apart are never a pair, and do not keep the caller") {
    FakeVideo video;
    video.cameras["/dev/left"].shoot(200, kFirst, Duration{2 * kPeriod.ns});
    video.cameras["/dev/right"].shoot(200, kFirst + kPeriod, Duration{2 * kPeriod.ns});
    PairedCameras source(kParams, "/dev/right", video);
    for (int i = 0; i < 10; ++i) {
        const Stamp before = video.time;
        CHECK(source.receive(kWait).io.status == IoStatus::kRetry);
        CHECK(video.time - before < Duration{2 * kWait.ns});
    }
    CHECK(source.unpaired() > 10);
}

TEST_CASE("stereo camera: the camera that is missing is named, and pairs come once it is back") {
    FakeVideo video;
    video.cameras["/dev/left"].shoot(3, kFirst, kPeriod);
    PairedCameras source(kParams, "/dev/right", video);
    StereoPicture got = next_pair(source);
    CHECK(got.io.status == IoStatus::kClosed);
    CHECK(source.problem().starts_with("/dev/right: no such camera"));
    video.cameras["/dev/left"].shoot(20, video.time + Duration{1'000'000'000}, kPeriod, 10);
    video.cameras["/dev/right"].shoot(20, video.time + Duration{1'000'000'000}, kPeriod, 10);
    for (int i = 0; i < 20 && got.io.status != IoStatus::kOk; ++i) {
        got = source.receive(kWait);
    }
    REQUIRE(got.io.status == IoStatus::kOk);
    CHECK(sequence_of(got.pair.left) == sequence_of(got.pair.right));
}
