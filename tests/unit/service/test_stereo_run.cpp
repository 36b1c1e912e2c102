// A stereo camera live: its motion as a service would hear it, and its pictures recorded and played again.
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "drivers/motion/motion_decoder.hpp"
#include "platform/files/input_error.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "platform/linux/udp_receiver.hpp"
#include "platform/service/stereo_run.hpp"
#include "tests/unit/drivers/stereo/painted_room.hpp"
#include "tests/unit/platform/port_peers.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tools/crspf/odometry_replay.hpp"

using Catch::Matchers::Contains;
using namespace crspf;
using namespace crspf::test;

namespace {

constexpr std::uint32_t kLoopback = 0x7F000001;
constexpr double kStep_m = 0.05;

/// Drives straight on, a step a picture, and is taken away after the last one.
class PaintedCamera final : public StereoSource {
 public:
    PaintedCamera(unsigned pictures, std::atomic<bool>& over) : pictures_(pictures), over_(over) {}

    StereoPicture receive(Duration /*wait*/) override {
        if (at_ == pictures_) {
            over_ = true;
            return {.io = {.status = IoStatus::kClosed}, .pair = {}};
        }
        PaintedRoom room;
        room.light = at_ >= 6 && at_ < 9 ? 0.0 : 1.0;
        shown_ = room.seen_from({.x = 0.0, .z = kStep_m * at_}, at_);
        ++at_;
        // The pace of the drive is that of its pictures, however slow the machine.
        stamp_ = stamp_ == Stamp{} ? monotonic_now() : stamp_ + Duration{66'000'000};
        return {.io = {.status = IoStatus::kOk, .bytes = shown_.left.size(), .stamp = stamp_}, .pair = shown_.view()};
    }
    [[nodiscard]] std::string_view problem() const override { return at_ == pictures_ ? "camera: gone" : ""; }

 private:
    unsigned pictures_;
    std::atomic<bool>& over_;
    unsigned at_ = 0;
    Pictures shown_;
    Stamp stamp_;
};

std::string calibration_text() {
    const std::string f = std::to_string(kCamera.focal_px);
    const std::string c = f + " 0 " + std::to_string(kCamera.cx_px);
    const std::string rest = " 0 " + f + " " + std::to_string(kCamera.cy_px) + " 0 0 0 1 0\n";
    return "P0: " + c + " 0" + rest + "P1: " + c + " " + std::to_string(-kCamera.focal_px * kCamera.baseline_m) + rest;
}

Config config_for(std::uint16_t port) {
    return parse_config(
        "[stereo]\ndevice = \"/dev/video9\"\ncalibration_text = \"\"\"\n" + calibration_text() +
            "\"\"\"\n[source.visual]\ndriver = \"motion\"\nport = \"udp://127.0.0.1:" + std::to_string(port) + "\"\n",
        "test");
}

}  // namespace

TEST_CASE("stereo run: the motion arrives, and the recorded pictures tell the same", "[stereo][real-kernel]") {
    const Scratch scratch;
    const std::uint16_t port = free_port(SOCK_DGRAM);
    UdpReceiver receiver({.own_address = kLoopback, .port = port});
    std::array<std::uint8_t, 256> buffer{};
    REQUIRE(receiver.receive(buffer, {}).io.status == IoStatus::kRetry);

    constexpr unsigned kPictures = 14;
    std::atomic<bool> stop{false};
    StereoJob job{.config = config_for(port), .record = RecorderParams{}, .duration_s = {}, .progress = {}, .open = {}};
    job.record->directory = scratch.directory();
    job.record->prefix = "stereo";
    job.record->free_bytes_min = 0;
    job.open = [&](const StereoConfig&) { return std::make_unique<PaintedCamera>(kPictures, stop); };
    const StereoStatus status = run_stereo(job, stop);
    CHECK(status.sent.sent == kPictures);
    CHECK(status.recorder.written == kPictures);
    CHECK(status.problem == "camera: gone");
    CHECK(status.sight == "sees");
    CHECK(status.work_ms > 0.0);

    // Fetched only now; a service would have fetched each as it came, hence a reception of their own.
    MotionDecoder decoder;
    Stamp received{};
    Pose2 heard;
    unsigned blind = 0;
    for (unsigned i = 0; i < kPictures; ++i) {
        const Datagram got = receiver.receive(buffer, Duration{5'000'000'000});
        REQUIRE(got.io.status == IoStatus::kOk);
        received = received + kMotionAgeMax;
        const auto sample = decoder.on_datagram(std::span(buffer).first(got.io.bytes), received);
        REQUIRE(sample);
        heard = heard * sample->P_previous_base;
        blind += sample->blind ? 1U : 0U;
    }
    CHECK(heard.x_m == Approx(kStep_m * (kPictures - 1)).margin(0.05));
    CHECK(blind >= 3);
    CHECK(decoder.counters().lost == 0);

    std::filesystem::path recording;
    for (const auto& entry : std::filesystem::directory_iterator(scratch.directory())) {
        recording = entry.path();
    }
    ReplayJob replay;
    replay.logs = {recording};
    const OdometryOutcome again = run_odometry(replay);
    REQUIRE(again.trajectory.size() == kPictures);
    CHECK(again.blind == blind);
    CHECK(again.camera_path.size() == kPictures);
    CHECK(again.trajectory.back().P_map_base.x_m == Approx(heard.x_m).margin(1e-9));
    CHECK(again.trajectory.back().P_map_base.y_m == Approx(heard.y_m).margin(1e-9));
}

TEST_CASE("stereo run: what is missing is said", "[stereo]") {
    const std::atomic<bool> stop{true};
    StereoJob job;
    SECTION("a device") {
        job.config = config_for(7750);
        job.config.stereo.device.clear();
        CHECK_THROWS_WITH(run_stereo(job, stop), Contains("[stereo] device: is not set"));
    }
    SECTION("somebody who wants to know") {
        job.config = config_for(7750);
        job.config.sources.clear();
        CHECK_THROWS_WITH(run_stereo(job, stop), Contains("driver = \"motion\""));
    }
    SECTION("a calibration") {
        job.config = config_for(7750);
        job.config.stereo.calibration_text.clear();
        CHECK_THROWS_WITH(run_stereo(job, stop), Contains("[stereo]: has no calibration"));
    }
    SECTION("a calibration that makes sense") {
        job.config = config_for(7750);
        job.config.stereo.calibration_text = "P0: 1 2 3\n";
        CHECK_THROWS_WITH(run_stereo(job, stop), Contains("[stereo] calibration_text:1"));
    }
}
