#include "platform/service/stereo_run.hpp"

#include <algorithm>
#include <ctime>
#include <utility>
#include <vector>

#include "platform/capture/stereo_record.hpp"
#include "platform/files/gray_png.hpp"
#include "platform/files/input_error.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "platform/linux/stereo_camera.hpp"
#include "platform/service/stereo_calibration.hpp"
#include "platform/service/stereo_input.hpp"

namespace crspf {

namespace {

constexpr Duration kStep{200'000'000};
constexpr Duration kReport{1'000'000'000};
constexpr std::uint32_t kLoopback = 0x7F000001;

std::unique_ptr<StereoSource> open_cameras(const StereoConfig& config) {
    const V4l2Params params{
        .device = config.device, .width_px = config.width_px, .height_px = config.height_px, .rate_hz = config.rate_hz};
    if (config.right_device.empty()) {
        return std::make_unique<SideBySideCamera>(params);
    }
    return std::make_unique<PairedCameras>(params, config.right_device);
}

/// Where crspfd listens. Nothing: it does not.
const SourceConfig* motion_source(const Config& config) {
    const auto found = std::find_if(config.sources.begin(), config.sources.end(), [](const SourceConfig& source) {
        return source.driver == SourceDriver::kMotion && !source.record_only;
    });
    return found == config.sources.end() ? nullptr : &*found;
}

/// What a recording needs to be played without another file.
std::string self_contained(Config config) {
    if (!config.stereo.calibration.empty()) {
        config.stereo.calibration_text = write_stereo_calibration(read_stereo_calibration(config.stereo.calibration));
        config.stereo.calibration.clear();
    }
    return print_config(config);
}

class StereoRun final : private SampleSink {
 public:
    explicit StereoRun(const StereoJob& job) : input_(make_stereo_input(job.config.stereo)) {
        if (job.config.stereo.device.empty() && !job.open) {
            throw InputError("[stereo] device: is not set; name the camera, such as /dev/video0");
        }
        const SourceConfig* const motion = motion_source(job.config);
        if (motion == nullptr && !job.record) {
            throw InputError(
                "no [source.NAME] with driver = \"motion\", to whose port the motion would go; add one, as in "
                "config/examples/sick_stereo.toml, or record the pictures only");
        }
        if (motion != nullptr) {
            const std::uint32_t address = motion->port.address == 0 ? kLoopback : motion->port.address;
            sender_.emplace(address, motion->port.port, MotionSender::new_session());
        }
        if (job.record) {
            RecorderParams params = *job.record;
            params.utc_minus_stamp = clock_now(CLOCK_REALTIME) - monotonic_now();
            recorder_.emplace(
                params,
                std::vector<CaptureSource>{
                    {.name = "stereo", .description = job.config.stereo.device, .link = LinkKind::kStereo}},
                self_contained(job.config));
        }
        cameras_ = job.open ? job.open(job.config.stereo) : open_cameras(job.config.stereo);
    }

    void step() {
        const StereoPicture picture = cameras_->receive(kStep);
        if (picture.io.status != IoStatus::kOk) {
            return;
        }
        const Stamp begin = clock_now(CLOCK_THREAD_CPUTIME_ID);
        input_->on_pair(picture.pair, picture.io.stamp, *this);
        static_cast<void>(input_->take_path());  // a service runs for days
        worked_.ns += (clock_now(CLOCK_THREAD_CPUTIME_ID) - begin).ns;
        ++pairs_;
        if (recorder_) {
            record(picture);
        }
    }

    [[nodiscard]] StereoStatus status() const {
        StereoStatus status;
        status.sight = input_->sight();
        status.problem = cameras_->problem();
        status.work_ms = pairs_ == 0 ? 0.0 : 1e3 * worked_.seconds() / static_cast<double>(pairs_);
        status.counts = input_->counts();
        if (sender_) {
            status.sent = sender_->counters();
        }
        if (recorder_) {
            status.recorder = recorder_->counters();
            status.file = recorder_->file();
            if (status.problem.empty()) {
                status.problem = recorder_->problem();
            }
        }
        return status;
    }

 private:
    void record(const StereoPicture& picture) {
        const std::vector<std::uint8_t> left = encode_gray_png(picture.pair.left);
        const std::vector<std::uint8_t> right = encode_gray_png(picture.pair.right);
        bytes_.clear();
        append_stereo_record(bytes_, {.left_png = left, .right_png = right});
        static_cast<void>(
            recorder_->append(0, Direction::kReceived, picture.io.stamp, bytes_));  // counts what it loses
    }

    void on_motion(const MotionSample& sample) override {
        if (sender_) {
            sender_->send(sample);
        }
    }
    void on_scan(const Scan& /*scan*/) override {}
    void on_cloud(const Cloud& /*cloud*/) override {}
    void on_wheel(const DifferentialSample& /*sample*/) override {}
    void on_wheel(const AckermannSample& /*sample*/) override {}
    void on_imu(const ImuSample& /*sample*/) override {}

    std::unique_ptr<StereoInput> input_;
    std::unique_ptr<StereoSource> cameras_;
    std::optional<MotionSender> sender_;
    std::optional<Recorder> recorder_;
    std::vector<std::uint8_t> bytes_;
    Duration worked_;
    std::uint64_t pairs_ = 0;
};

}  // namespace

StereoStatus run_stereo(const StereoJob& job, const std::atomic<bool>& stop) {
    StereoRun run(job);
    const Stamp start = monotonic_now();
    Stamp reported = start;
    const auto status_at = [&](Stamp now) {
        StereoStatus status = run.status();
        status.elapsed_s = (now - start).seconds();
        return status;
    };
    while (!stop) {
        run.step();
        const Stamp now = monotonic_now();
        if (job.progress && now - reported > kReport) {
            reported = now;
            job.progress(status_at(now));
        }
        if (job.duration_s && (now - start).seconds() > *job.duration_s) {
            break;
        }
    }
    return status_at(monotonic_now());
}

}  // namespace crspf
