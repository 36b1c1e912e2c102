#include "platform/service/record_run.hpp"

#include <ctime>
#include <deque>
#include <mutex>
#include <span>
#include <thread>
#include <utility>

#include "platform/capture/recorder.hpp"
#include "platform/files/input_error.hpp"
#include "platform/linux/monotonic_clock.hpp"

namespace crspf {

namespace {

constexpr Duration kStep{100'000'000};
constexpr Duration kReport{1'000'000'000};

/// The one recorder and the counts, for all threads.
class SharedRecorder {
 public:
    SharedRecorder(const RecorderParams& params, const std::vector<CaptureSource>& sources, const std::string& comment)
        : recorder_(params, sources, comment), records_(sources.size()), samples_(sources.size()) {}

    void append(std::uint32_t source, Direction direction, Stamp stamp, std::span<const std::uint8_t> bytes) {
        const std::lock_guard lock(mutex_);
        static_cast<void>(recorder_.append(source, direction, stamp, bytes));  // it counts what it loses
        ++records_[source];
    }
    void count_sample(std::uint32_t source) {
        const std::lock_guard lock(mutex_);
        ++samples_[source];
    }
    void flush() {
        const std::lock_guard lock(mutex_);
        static_cast<void>(recorder_.flush());
    }
    void fill(RecordStatus& status) {
        const std::lock_guard lock(mutex_);
        for (std::size_t i = 0; i < status.sources.size(); ++i) {
            status.sources[i].records = records_[i];
            status.sources[i].samples = samples_[i];
        }
        status.recorder = recorder_.counters();
        status.file = recorder_.file();
        status.problem = recorder_.problem();
    }

 private:
    std::mutex mutex_;
    Recorder recorder_;
    std::vector<std::uint64_t> records_;
    std::vector<std::uint64_t> samples_;
};

/// A source, its thread, and what others may read of it.
class RecordedSource final : private TrafficSink, private SampleSink {
 public:
    RecordedSource(std::uint32_t index, std::unique_ptr<LiveSource> source, SharedRecorder& recorder)
        : index_(index), source_(std::move(source)), recorder_(recorder) {}

    void start() {
        thread_ = std::jthread([this](const std::stop_token& stop) {
            while (!stop.stop_requested()) {
                source_->step(kStep, *this, *this);
                publish();
            }
        });
    }
    void stop() {
        if (thread_.joinable()) {
            thread_.request_stop();
            thread_.join();
        }
    }
    void fill(RecordStatus::Source& status) {
        const std::lock_guard lock(mutex_);
        status.state = report_.state.view();
        status.counts = report_.counts;
    }

 private:
    void publish() {
        const Stamp now = monotonic_now();
        if (now - published_ < kReport) {
            return;
        }
        published_ = now;
        const std::lock_guard lock(mutex_);
        report_ = source_->report();
    }

    void on_traffic(Direction direction, Stamp stamp, std::span<const std::uint8_t> bytes) override {
        recorder_.append(index_, direction, stamp, bytes);
    }
    void on_scan(const Scan& /*scan*/) override { recorder_.count_sample(index_); }
    void on_cloud(const Cloud& /*cloud*/) override { recorder_.count_sample(index_); }
    void on_wheel(const DifferentialSample& /*sample*/) override { recorder_.count_sample(index_); }
    void on_wheel(const AckermannSample& /*sample*/) override { recorder_.count_sample(index_); }
    void on_imu(const ImuSample& /*sample*/) override { recorder_.count_sample(index_); }
    void on_motion(const MotionSample& /*sample*/) override { recorder_.count_sample(index_); }

    std::uint32_t index_;
    std::unique_ptr<LiveSource> source_;
    SharedRecorder& recorder_;
    std::mutex mutex_;
    LiveReport report_{.streaming = false, .state = StateText("starting"), .counts = {}};
    Stamp published_;
    std::jthread thread_;  ///< last: it ends before the rest goes
};

}  // namespace

RecordStatus run_record(const RecordJob& job, const std::atomic<bool>& stop) {
    if (job.config.sources.empty()) {
        throw InputError("no source is configured; give --config with [source.NAME] tables, as in config/examples");
    }
    std::vector<CaptureSource> ports;
    RecordStatus status;
    for (const SourceConfig& source : job.config.sources) {
        ports.push_back({.name = source.name, .description = source.port_text, .link = link_of(source.driver)});
        status.sources.push_back({.name = source.name, .state = {}, .records = 0, .samples = 0, .counts = {}});
    }
    RecorderParams params = job.recorder;
    params.utc_minus_stamp = clock_now(CLOCK_REALTIME) - monotonic_now();
    SharedRecorder recorder(params, ports, print_config(job.config));
    std::deque<RecordedSource> sources;
    for (std::size_t i = 0; i < job.config.sources.size(); ++i) {
        const SourceConfig& source = job.config.sources[i];
        const LidarParams& lidar = job.config.slam.lidar;
        sources.emplace_back(static_cast<std::uint32_t>(i),
                             job.open ? job.open(source, lidar) : open_live(source, lidar), recorder);
    }
    const auto refresh = [&](Stamp start) {
        for (std::size_t i = 0; i < sources.size(); ++i) {
            sources[i].fill(status.sources[i]);
        }
        recorder.fill(status);
        status.elapsed_s = (monotonic_now() - start).seconds();
    };

    const Stamp start = monotonic_now();
    for (RecordedSource& source : sources) {
        source.start();
    }
    Stamp next_report = start + kReport;
    while (!stop && !(job.duration_s && (monotonic_now() - start).seconds() >= *job.duration_s)) {
        sleep_until(monotonic_now() + kStep);
        if (monotonic_now() >= next_report) {
            next_report = next_report + kReport;
            refresh(start);
            if (job.progress) {
                job.progress(status);
            }
        }
    }
    for (RecordedSource& source : sources) {
        source.stop();
    }
    recorder.flush();
    refresh(start);
    return status;
}

}  // namespace crspf
