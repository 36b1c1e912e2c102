// The whole service on the robot of live_robot.hpp: its lidar on a pseudo terminal, its wheels on a bus, the pose read
// back from another bus.
#pragma once

#include <sys/socket.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "drivers/can/pose_frames.hpp"
#include "platform/crspfd/service.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "platform/linux/socketcan.hpp"
#include "platform/service/live_source.hpp"
#include "platform/service/sample_sink.hpp"
#include "tests/support/live_robot.hpp"
#include "tools/sim/live_sensors.hpp"

namespace crspf::test {

/// Its real-time threads.
inline constexpr std::array<std::string_view, 6> kServiceThreads{"rx-lidar", "rx-base", "odometry",
                                                                 "filter",   "map",     "output"};

/// A source whose scans come several at once, as after a stall on the way.
class Bursting final : public LiveSource, private SampleSink {
 public:
    Bursting(std::unique_ptr<LiveSource> source, const std::atomic<int>& at_once)
        : source_(std::move(source)), at_once_(at_once) {}

    void step(Duration wait, SampleSink& samples, TrafficSink& traffic) override {
        to_ = &samples;
        source_->step(wait, *this, traffic);
    }
    [[nodiscard]] LiveReport report() const override { return source_->report(); }

 private:
    void on_scan(const Scan& scan) override {
        for (int i = 0; i < at_once_; ++i) {
            to_->on_scan(scan);
        }
    }
    void on_cloud(const Cloud& cloud) override { to_->on_cloud(cloud); }
    void on_wheel(const DifferentialSample& sample) override { to_->on_wheel(sample); }
    void on_wheel(const AckermannSample& sample) override { to_->on_wheel(sample); }
    void on_imu(const ImuSample& sample) override { to_->on_imu(sample); }
    void on_motion(const MotionSample& sample) override { to_->on_motion(sample); }

    std::unique_ptr<LiveSource> source_;
    const std::atomic<int>& at_once_;
    SampleSink* to_ = nullptr;
};

class ServiceBench {
 public:
    /// @param directory for the line, the map and the record
    explicit ServiceBench(const std::filesystem::path& directory) : ServiceBench(directory, config(directory)) {}
    ServiceBench(const std::filesystem::path& directory, const Config& config)
        : urg({.link = directory / "tty", .sensor = urg_04lx(), .scan = revolution}),
          base_(Duration{20'000'000}, wheels) {
        std::array<int, 2> pair{};
        if (::socketpair(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, pair.data()) != 0) {
            throw std::system_error(errno, std::generic_category(), "socket pair");
        }
        controller_ = std::make_unique<SocketCan>(UniqueFd(pair[0]));
        ServiceOptions options;
        options.allow_degraded = true;
        options.open_source = [this](const SourceConfig& source,
                                     const LidarParams& lidar) -> std::unique_ptr<LiveSource> {
            if (source.driver == SourceDriver::kCan) {
                return open_live(source, lidar, std::make_unique<SocketCan>(base_.take_bus()));
            }
            return std::make_unique<Bursting>(open_live(source, lidar), scans_at_once);
        };
        options.open_bus = [fd = pair[1]](const PoseOutputConfig&) {
            return std::make_unique<SocketCan>(UniqueFd(fd));
        };
        service = std::make_unique<Service>(config, options);
    }

    static Config config(const std::filesystem::path& directory) {
        return robot(directory / "tty", "[pose_output]\ncan = \"can1\"\n[service]\nstate_directory = \"" +
                                            (directory / "state").string() + "\"\nrecord_directory = \"" +
                                            (directory / "runs").string() + "\"\n");
    }

    /// Runs until `done`, or out of patience; true where it was done.
    bool run_until(const std::function<bool()>& done, double patience_s = 20.0) {
        const Stamp end = monotonic_now() + Duration::from_seconds(patience_s);
        while (monotonic_now() < end) {
            CanFrame frame;
            while (controller_->receive(frame, {}).status == IoStatus::kOk) {
                if (const auto pose = decoder.on_frame(frame)) {
                    last_pose = pose;
                    if (on_pose) {
                        on_pose(*pose);
                    }
                }
            }
            for (const ServiceEvent& event : service->tick()) {
                log += event.text + "\n";
            }
            if (done()) {
                return true;
            }
            sleep_until(monotonic_now() + Duration{5'000'000});
        }
        return false;
    }
    bool run_for(double seconds) {
        const Stamp end = monotonic_now() + Duration::from_seconds(seconds);
        return run_until([end] { return monotonic_now() >= end; }, seconds + 1.0);
    }
    /// A scan has been matched well, and the pose of it is on the bus.
    [[nodiscard]] bool pose_known() const { return last_pose && !last_pose->lost && last_pose->result; }

    const Stamp begun = monotonic_now();
    std::atomic<int> scans_at_once{1};
    sim::LiveUrg urg;
    std::unique_ptr<Service> service;
    PoseDecoder decoder;
    std::function<void(const PoseReport&)> on_pose;
    std::optional<PoseReport> last_pose;
    std::string log;

 private:
    sim::LiveCanNode base_;
    std::unique_ptr<SocketCan> controller_;
};

}  // namespace crspf::test
