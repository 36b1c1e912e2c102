#include <catch2/catch.hpp>
#include <string>

#include "platform/linux/v4l2_camera.hpp"
#include "tests/unit/platform/fake_video.hpp"

using namespace crspf;
using test::brightness;
using test::FakeVideo;

namespace {

constexpr Duration kWait{100'000'000};
constexpr Duration kPeriod{33'000'000};
constexpr Stamp kFirst{1'010'000'000};

const V4l2Params kParams{.device = "/dev/video0", .width_px = 64, .height_px = 48, .rate_hz = 15.0};

/// The first picture: opening does not wait for one.
CameraPicture first_picture(V4l2Camera& camera) {
    CHECK(camera.receive(kWait).io.status == IoStatus::kRetry);
    return camera.receive(kWait);
}

bool is_shot(const GrayView& picture, std::uint32_t sequence) {
    if (picture.width != 64 || picture.height != 48) {
        return false;
    }
    for (std::size_t y = 0; y < 48; ++y) {
        for (std::size_t x = 0; x < 64; ++x) {
            if (picture.pixels[y * picture.stride + x] != brightness(x, y, sequence)) {
                return false;
            }
        }
    }
    return true;
}

/// What it says of a camera that cannot be opened.
std::string refusal(FakeVideo& video, int error) {
    V4l2Camera camera(kParams, video);
    CHECK(camera.receive(kWait).io.status == IoStatus::kClosed);
    CHECK(camera.error() == error);
    CHECK(camera.rate_hz() == 0.0);
    return camera.problem();
}

}  // namespace

TEST_CASE("v4l2: pictures as the camera took them, with its stamps") {
    FakeVideo video;
    test::FakeCamera& fake = video.cameras["/dev/video0"];
    fake.shoot(10, kFirst, kPeriod);
    {
        V4l2Camera camera(kParams, video);
        CameraPicture got = first_picture(camera);
        for (std::uint32_t i = 0; i < 10; ++i) {
            REQUIRE(got.io.status == IoStatus::kOk);
            CHECK(got.io.stamp == kFirst + Duration{i * kPeriod.ns});
            CHECK(got.io.dropped == 0);
            CHECK(is_shot(got.picture, i));
            got = camera.receive(kWait);
        }
        CHECK(got.io.status == IoStatus::kRetry);
        CHECK(camera.counters().received == 10);
        CHECK(camera.counters().host_stamped == 0);
        CHECK(camera.counters().dropped == 0);
        CHECK(camera.rate_hz() == 30.0);
        CHECK(fake.asked_rate_mhz == 15000);
        CHECK(fake.most_queued == 4);
        CHECK(fake.queued.size() == 4);  // each was given back
        CHECK(video.mapped == 4);
        CHECK(camera.problem().empty());
    }
    CHECK(video.mapped == 0);
}

TEST_CASE("v4l2: brightness of colour formats, and rows with padding") {
    for (const std::uint32_t code : {V4L2_PIX_FMT_GREY, V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_UYVY}) {
        FakeVideo video;
        test::FakeCamera& fake = video.cameras["/dev/video0"];
        // The compressed one is not taken, nor that which has another size.
        fake.formats = {{.code = V4L2_PIX_FMT_MJPEG},
                        {.code = V4L2_PIX_FMT_NV12},
                        {.code = code, .sizes = {{64, 48}, {128, 96}}, .padding_bytes = 16}};
        if (code == V4L2_PIX_FMT_YUYV) {
            fake.formats.push_back({.code = V4L2_PIX_FMT_GREY, .sizes = {{32, 24}}});
        }
        fake.shoot(2, kFirst, kPeriod);
        V4l2Camera camera(kParams, video);
        CHECK(is_shot(first_picture(camera).picture, 0));
        CHECK(is_shot(camera.receive(kWait).picture, 1));
    }
}

TEST_CASE("v4l2: pictures that were lost are counted, across the counter's end") {
    FakeVideo video;
    test::FakeCamera& fake = video.cameras["/dev/video0"];
    fake.shoot(1, kFirst, kPeriod, 0xFFFFFFFE);
    fake.shoot(1, kFirst + kPeriod, kPeriod, 1);            // two are missing
    fake.shoot(1, kFirst + kPeriod + kPeriod, kPeriod, 0);  // one that counts back is no loss
    V4l2Camera camera(kParams, video);
    CHECK(first_picture(camera).io.dropped == 0);
    CHECK(camera.receive(kWait).io.dropped == 2);
    CHECK(camera.receive(kWait).io.dropped == 0);
    CHECK(camera.counters().dropped == 2);
    CHECK(camera.counters().received == 3);
}

TEST_CASE("v4l2: damaged and short pictures are counted and skipped") {
    FakeVideo video;
    test::FakeCamera& fake = video.cameras["/dev/video0"];
    fake.shoot(4, kFirst, kPeriod);
    fake.shots[0].damaged = true;
    fake.shots[2].missing = 1;
    V4l2Camera camera(kParams, video);
    CHECK(is_shot(first_picture(camera).picture, 1));
    CHECK(is_shot(camera.receive(kWait).picture, 3));
    CHECK(camera.counters().damaged == 2);
    CHECK(camera.counters().dropped == 0);
    // Nothing but damaged ones does not keep the caller: 100 ms of them, then it has its turn.
    fake.shoot(100, kFirst + Duration{4 * kPeriod.ns}, kPeriod, 4);
    for (test::FakeShot& shot : fake.shots) {
        shot.damaged = true;
    }
    const Stamp before = video.time;
    CHECK(camera.receive(kWait).io.status == IoStatus::kRetry);
    CHECK(video.time - before < Duration{2 * kWait.ns});
    CHECK(camera.counters().damaged <= 6);
    CHECK(fake.queued.size() == 4);
}

TEST_CASE("v4l2: a stamp that cannot be is replaced by the host's, and counted") {
    FakeVideo video;
    test::FakeCamera& fake = video.cameras["/dev/video0"];
    fake.shoot(4, kFirst, kPeriod);
    fake.shots[0].monotonic = false;
    fake.shots[1].stamp = Stamp{5'000'000'000'000};                       // to come
    fake.shots[2].stamp = fake.shots[2].stamp - Duration{2'100'000'000};  // long gone
    V4l2Camera camera(kParams, video);
    CameraPicture got = first_picture(camera);
    for (int i = 0; i < 3; ++i) {
        CHECK(got.io.stamp == kFirst + Duration{i * kPeriod.ns} + Duration{2'000'000});
        got = camera.receive(kWait);
    }
    CHECK(got.io.stamp == kFirst + Duration{3 * kPeriod.ns});
    CHECK(camera.counters().host_stamped == 3);
}

TEST_CASE("v4l2: a wake-up without a picture is no loss") {
    FakeVideo video;
    test::FakeCamera& fake = video.cameras["/dev/video0"];
    fake.shoot(2, kFirst, kPeriod);
    fake.shots[0].error = EAGAIN;
    V4l2Camera camera(kParams, video);
    CHECK(first_picture(camera).io.status == IoStatus::kRetry);
    CHECK(is_shot(camera.receive(kWait).picture, 1));
    CHECK(fake.opened == 1);
}

TEST_CASE("v4l2: unplugged in mid stream is told, and plugged in it is back") {
    FakeVideo video;
    test::FakeCamera& fake = video.cameras["/dev/video0"];
    fake.shoot(3, kFirst, kPeriod);
    V4l2Camera camera(kParams, video);
    CHECK(is_shot(first_picture(camera).picture, 0));
    fake.unplugged = true;
    CHECK(camera.receive(kWait).io.status == IoStatus::kClosed);
    CHECK(camera.error() == ENODEV);
    CHECK(camera.problem().starts_with("/dev/video0: no such camera; plug it in"));
    CHECK(video.mapped == 0);
    fake.open_error = ENOENT;
    for (int i = 0; i < 3; ++i) {
        CHECK(camera.receive(kWait).io.status == IoStatus::kClosed);
    }
    fake = test::FakeCamera{};
    fake.shoot(3, video.time + kPeriod, kPeriod, 70);
    CameraPicture got;
    for (int i = 0; i < 20 && got.io.status != IoStatus::kOk; ++i) {
        got = camera.receive(kWait);
    }
    CHECK(is_shot(got.picture, 70));
    CHECK(got.io.dropped == 0);  // another stream, another count
    CHECK(video.mapped == 4);
}

TEST_CASE("v4l2: a driver that fails, and one that hangs, are opened anew") {
    FakeVideo video;
    test::FakeCamera& fake = video.cameras["/dev/video0"];
    SECTION("fetching fails") {
        fake.shoot(1, kFirst, kPeriod);
        fake.shots[0].error = EIO;
    }
    SECTION("a buffer that does not exist") {
        fake.shoot(1, kFirst, kPeriod);
        fake.shots[0].index_offset = 4;
    }
    SECTION("silence") {}
    V4l2Camera camera(kParams, video);
    int closed = 0;
    for (int i = 0; i < 32; ++i) {  // 3.2 s
        closed += camera.receive(kWait).io.status == IoStatus::kClosed ? 1 : 0;
    }
    CHECK(closed >= 1);
    CHECK(video.mapped >= 0);
    fake.shots.clear();
    fake.shoot(100, video.time, kPeriod);
    CameraPicture got;
    for (int i = 0; i < 20 && got.io.status != IoStatus::kOk; ++i) {
        got = camera.receive(kWait);
    }
    CHECK(got.io.status == IoStatus::kOk);
    CHECK(fake.opened == 2);
}

TEST_CASE("v4l2: a camera that cannot be used is named with the remedy") {
    FakeVideo video;
    CHECK(refusal(video, ENOENT).starts_with("/dev/video0: no such camera; plug it in"));
    test::FakeCamera& fake = video.cameras["/dev/video0"];
    fake.open_error = EACCES;
    CHECK(refusal(video, EACCES) ==
          "/dev/video0: no permission; add the user to the group and log in anew: usermod -aG video USER");
    fake.open_error = EBUSY;
    CHECK(refusal(video, EBUSY).find("another program has it; ") != std::string::npos);

    fake = test::FakeCamera{};
    fake.refuses[VIDIOC_QUERYCAP] = ENOTTY;
    CHECK(refusal(video, EINVAL).find("not a camera; ") != std::string::npos);
    fake = test::FakeCamera{};
    fake.capabilities = V4L2_CAP_META_CAPTURE | V4L2_CAP_STREAMING;
    CHECK(refusal(video, EINVAL).find("gives no pictures") != std::string::npos);
    fake = test::FakeCamera{};
    fake.capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_READWRITE;
    CHECK(refusal(video, EINVAL).find("gives no pictures") != std::string::npos);

    fake = test::FakeCamera{};
    fake.formats = {{.code = V4L2_PIX_FMT_MJPEG}};
    CHECK(refusal(video, EINVAL).find("gives MJPG only, and pictures must come as they are") != std::string::npos);
    fake.formats.clear();
    CHECK(refusal(video, EINVAL).find("gives nothing only") != std::string::npos);

    fake.formats = {{.code = V4L2_PIX_FMT_YUYV, .sizes = {{320, 240}, {640, 480}}},
                    {.code = V4L2_PIX_FMT_MJPEG, .sizes = {{1920, 1080}}},
                    {.code = V4L2_PIX_FMT_GREY, .sizes = {{128, 96}, {1280, 960}}, .stepwise = true}};
    CHECK(refusal(video, EINVAL) ==
          "/dev/video0: gives no whole pictures of 64x48, but GREY 128x96 to 1280x960, YUYV 320x240 640x480; choose "
          "one of these");
    fake.formats = {{.field = V4L2_FIELD_INTERLACED}};
    CHECK(refusal(video, EINVAL).find("gives no whole pictures of 64x48, but GREY 64x48") != std::string::npos);

    fake = test::FakeCamera{};
    fake.refuses[VIDIOC_S_FMT] = EBUSY;
    CHECK(refusal(video, EBUSY).find("another program has it") != std::string::npos);
    fake = test::FakeCamera{};
    fake.refuses[VIDIOC_STREAMON] = ENOSPC;
    CHECK(refusal(video, ENOSPC).find("the USB has no room") != std::string::npos);
    fake = test::FakeCamera{};
    fake.buffer_limit = 1;
    CHECK(refusal(video, ENOMEM).find("; ") != std::string::npos);
    fake = test::FakeCamera{};
    fake.buffer_bytes = 64 * 48 - 1;
    CHECK(refusal(video, EPROTO).find("; ") != std::string::npos);
    CHECK(video.mapped == 0);

    // A camera whose rate cannot be set gives what it gives.
    fake = test::FakeCamera{};
    fake.refuses[VIDIOC_S_PARM] = ENOTTY;
    fake.shoot(1, video.time + kPeriod, kPeriod);
    V4l2Camera camera(kParams, video);
    CHECK(first_picture(camera).io.status == IoStatus::kOk);
    CHECK(camera.rate_hz() == 0.0);
}

TEST_CASE("v4l2: the kernel itself says what is no camera") {
    V4l2Camera none({.device = "/dev/no-such-camera"});
    CHECK(none.receive(Duration{}).io.status == IoStatus::kClosed);
    CHECK(none.error() == ENOENT);
    V4l2Camera other({.device = "/dev/null"});
    CHECK(other.receive(Duration{}).io.status == IoStatus::kClosed);
    CHECK(other.problem().starts_with("/dev/null: not a camera; "));
}
