#include <atomic>
#include <catch2/catch.hpp>
#include <cstring>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "platform/capture/capture_reader.hpp"
#include "platform/files/input_error.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "platform/service/open_run.hpp"
#include "platform/service/record_run.hpp"
#include "tests/unit/platform/scratch.hpp"

using namespace crspf;
using crspf::test::Scratch;

namespace {

/// A bus on which a robot rolls 1 mm with each frame, a frame of each wheel every 2 ms.
class RollingBus final : public CanBus {
 public:
    Received receive(CanFrame& frame, Duration /*wait*/) override {
        sleep_until(next_);
        const Stamp now = monotonic_now();
        next_ = now + Duration{1'000'000};
        frame = {};
        frame.id = right_ ? 2 : 1;
        frame.length = 4;
        std::memcpy(frame.data.data(), &count_, sizeof count_);
        count_ += right_ ? 1U : 0U;
        right_ = !right_;
        return {.status = IoStatus::kOk, .bytes = 4, .stamp = now};
    }
    IoStatus send(const CanFrame& /*frame*/, Stamp /*deadline*/) override { return IoStatus::kOk; }
    [[nodiscard]] const CanHealth& health() const override { return health_; }
    [[nodiscard]] int error() const override { return 0; }

 private:
    CanHealth health_;
    Stamp next_;
    std::uint32_t count_ = 0;
    bool right_ = false;
};

Config robot() {
    return parse_config(
        "[source.base]\ndriver = \"can\"\nport = \"can0\"\ndbc_text = \"\"\"\nBO_ 1 L: 4 X\n"
        " SG_ C : 0|32@1+ (1,0) [0|0] \\\"\\\" X\nBO_ 2 R: 4 X\n SG_ C : 0|32@1+ (1,0) [0|0] \\\"\\\" X\n\"\"\"\n"
        "[source.base.left]\nsignal = \"L.C\"\nscale = 0.001\n[source.base.right]\nsignal = \"R.C\"\nscale = 0.001\n",
        "c");
}

}  // namespace

TEST_CASE("record: what the sensors said is played again, with the configuration") {
    const Scratch scratch;
    RecordJob job;
    job.config = robot();
    job.recorder.directory = scratch.directory();
    job.recorder.free_bytes_min = 1;
    job.duration_s = 0.5;
    job.open = [](const SourceConfig& source, const LidarParams& lidar) {
        return open_live(source, lidar, std::make_unique<RollingBus>());
    };
    const std::atomic<bool> never{false};
    const RecordStatus status = run_record(job, never);
    REQUIRE(status.sources.size() == 1);
    CHECK(status.sources[0].samples > 10);
    CHECK(status.recorder.written == status.sources[0].records);
    CHECK(status.recorder.lost == 0);

    Run run = open_run({status.file}, std::nullopt);
    const auto event = std::make_unique<LogEvent>();
    std::uint64_t samples = 0;
    double left_m = 0.0;
    while (run.parts[0]->next(*event)) {
        CHECK(event->kind == LogEvent::Kind::kDifferential);
        left_m += event->differential.left_m;
        ++samples;
    }
    CHECK(samples == status.sources[0].samples);
    // A frame that came too late for its pair is in the next sample.
    CHECK(left_m > 0.0009 * static_cast<double>(samples - 1));
    CHECK(left_m < 0.0011 * static_cast<double>(status.sources[0].records) / 2.0);
}

TEST_CASE("record: it stops when it is told to, and says what it cannot do") {
    const Scratch scratch;
    RecordJob job;
    job.config = parse_config("[source.a]\ndriver = \"scip\"\nport = \"/dev/none\"\n", "c");
    job.recorder.directory = scratch.directory();
    job.recorder.free_bytes_min = 1;
    int reports = 0;
    std::atomic<bool> stop{false};
    job.progress = [&](const RecordStatus& status) {
        ++reports;
        CHECK(status.recorder.written == 0);
        stop = true;
    };
    const RecordStatus status = run_record(job, stop);
    CHECK(reports == 1);
    CHECK(status.sources[0].records == 0);
    CHECK(status.file.empty());

    CHECK_THROWS_AS(
        run_record({.config = {}, .recorder = job.recorder, .duration_s = 1.0, .progress = {}, .open = {}}, stop),
        InputError);
    job.recorder.directory = scratch / "none";
    CHECK_THROWS_AS(run_record(job, stop), InputError);
}
