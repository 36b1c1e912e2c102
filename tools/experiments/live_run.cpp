#include "tools/experiments/live_run.hpp"

#include <sys/mman.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <memory>
#include <set>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "config/config.hpp"
#include "platform/crspfd/service.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "platform/linux/socketcan.hpp"
#include "platform/service/live_source.hpp"
#include "tools/crspf/replay.hpp"
#include "tools/experiments/runs.hpp"
#include "tools/experiments/taped_robot.hpp"
#include "tools/sim/live_sensors.hpp"

namespace crspf::experiments {
namespace {

constexpr double kInterval_s = 0.5;
constexpr Duration kPoll{10'000'000};   // whether poses have come
constexpr Duration kTick{100'000'000};  // of the control thread
constexpr double kPatience_s = 20.0;    // until the first pose
constexpr double kSpare_s = 8.0;        // of the drive, beyond what is watched
constexpr std::uint64_t kSeed = 1;

/// Processor time of a thread of this process; it ends with it.
double time_of_thread_s(int id) {
    std::ifstream file("/proc/self/task/" + std::to_string(id) + "/schedstat");
    double ns = 0.0;
    file >> ns;
    return 1e-9 * ns;
}

std::set<int> threads_of_process() {
    std::set<int> ids;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task")) {
        ids.insert(std::stoi(entry.path().filename().string()));
    }
    return ids;
}

/// The service with its robot.
class Bench {
 public:
    Bench(const TapedRobot& robot, const std::filesystem::path& directory)
        : urg_({.link = directory / "tty",
                .sensor = TapedRobot::sensor(),
                .scan = [&robot](std::uint64_t number, std::span<std::uint32_t> mm) { robot.revolution(number, mm); }}),
          base_(Duration::from_seconds(TapedRobot::kWheelPeriod_s),
                [&robot](std::uint64_t tick) { return robot.wheels(tick); }) {
        std::array<int, 2> pair{};
        if (::socketpair(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, pair.data()) != 0) {
            throw std::system_error(errno, std::generic_category(), "socket pair");
        }
        controller_ = std::make_unique<SocketCan>(UniqueFd(pair[0]));
        ServiceOptions options;
        options.allow_degraded = true;
        options.open_source = [this](const SourceConfig& source,
                                     const LidarParams& lidar) -> std::unique_ptr<LiveSource> {
            return source.driver == SourceDriver::kCan
                       ? open_live(source, lidar, std::make_unique<SocketCan>(base_.take_bus()))
                       : open_live(source, lidar);
        };
        options.open_bus = [fd = pair[1]](const PoseOutputConfig&) {
            return std::make_unique<SocketCan>(UniqueFd(fd));
        };
        const std::string service = "[pose_output]\ncan = \"can1\"\n[service]\nstate_directory = \"" +
                                    (directory / "state").string() + "\"\nrecord_directory = \"" +
                                    (directory / "runs").string() + "\"\n";
        const std::set<int> before = threads_of_process();
        service_ = std::make_unique<Service>(
            parse_config(service + robot.config((directory / "tty").string()), "live.toml"), options);
        service_->start();
        const std::set<int> after = threads_of_process();
        std::set_difference(after.begin(), after.end(), before.begin(), before.end(), std::back_inserter(threads_));
    }

    /// The control thread's work, until a time.
    void run_until(Stamp end) {
        while (monotonic_now() < end) {
            CanFrame frame;
            while (controller_->receive(frame, {}).status == IoStatus::kOk) {
            }
            if (monotonic_now() - ticked_ >= kTick) {
                ticked_ = monotonic_now();
                const double start_s = thread_time_s();
                static_cast<void>(service_->tick());
                control_s_ += thread_time_s() - start_s;
            }
            sleep_until(std::min(end, monotonic_now() + kPoll));
        }
    }

    [[nodiscard]] Service& service() { return *service_; }
    [[nodiscard]] double control_s() const { return control_s_; }
    /// That the service began, its own for files included.
    [[nodiscard]] const std::vector<int>& threads() const { return threads_; }

 private:
    sim::LiveUrg urg_;
    sim::LiveCanNode base_;
    std::unique_ptr<SocketCan> controller_;
    std::unique_ptr<Service> service_;
    std::vector<int> threads_;
    Stamp ticked_;
    double control_s_ = 0.0;
};

/// What a module has done since the start, by the service's status.
std::uint64_t done_by(const std::string& module, const nlohmann::ordered_json& status) {
    if (module == "odometry") {
        return status["odometry"]["samples"].get<std::uint64_t>();
    }
    if (module == "filter") {
        return status["filter"]["scans"].get<std::uint64_t>();
    }
    if (module == "map") {
        return status["map"]["drawn"].get<std::uint64_t>();
    }
    if (module == "output") {
        return status["output"]["poses"].get<std::uint64_t>();
    }
    for (const nlohmann::ordered_json& source : status["sources"]) {
        if (module == "rx-" + source["name"].get<std::string>()) {
            return source["samples"].get<std::uint64_t>();
        }
    }
    return 0;
}

/// Watches what the threads use.
class Watch {
 public:
    Watch(Bench& bench, LiveRun& run)
        : bench_(bench),
          run_(run),
          first_(bench.service().status()),
          threads_(rows(bench, first_, run)),
          used_s_(used()),
          begin_s_(used_s_),
          begin_(monotonic_now()),
          last_(begin_) {}

    [[nodiscard]] Stamp begin() const { return begin_; }

    void look() {
        const Stamp now = monotonic_now();
        const std::vector<double> now_s = used();
        const double took_s = (now - last_).seconds();
        for (std::size_t i = 0; i < now_s.size(); ++i) {
            run_.modules[i].share.push_back((now_s[i] - used_s_[i]) / took_s);
        }
        run_.interval_s.push_back((now - begin_).seconds());
        used_s_ = now_s;
        last_ = now;
    }

    void end() {
        const nlohmann::ordered_json last = bench_.service().status();
        run_.seconds = (last_ - begin_).seconds();
        const double told_s = last["uptime_s"].get<double>() - first_["uptime_s"].get<double>();
        for (std::size_t i = 0; i < run_.modules.size(); ++i) {
            ModuleLoad& module = run_.modules[i];
            module.cpu_s = used_s_[i] - begin_s_[i];
            module.rate_hz = static_cast<double>(done_by(module.name, last) - done_by(module.name, first_)) / told_s;
        }
        for (std::size_t i = 0; i < last["threads"].size(); ++i) {
            const nlohmann::ordered_json& thread = last["threads"][i];
            run_.modules[i].median_below_us = thread["median_below_us"].get<double>();
            run_.modules[i].max_us = thread["max_us"].get<double>();
            run_.modules[i].misses = thread["misses"].get<std::uint64_t>();
        }
        run_.realtime = last["realtime"]["sched_fifo"].get<bool>();
        run_.skipped_scans = last["filter"]["skipped"].get<std::uint64_t>();
        run_.undrawn = last["filter"]["undrawn"].get<std::uint64_t>();
    }

 private:
    /// Makes the rows of the report. @return the threads of each
    static std::vector<std::vector<int>> rows(const Bench& bench, const nlohmann::ordered_json& status, LiveRun& run) {
        std::set<int> others(bench.threads().begin(), bench.threads().end());
        std::vector<std::vector<int>> threads;
        for (const nlohmann::ordered_json& thread : status["threads"]) {
            const int id = thread["id"].get<int>();
            others.erase(id);
            run.modules.push_back({.name = thread["name"].get<std::string>()});
            threads.push_back({id});
        }
        run.modules.push_back({.name = "recording, far tiles"});
        threads.emplace_back(others.begin(), others.end());
        run.modules.push_back({.name = "control"});  // the bench's own thread: it counts that itself
        threads.emplace_back();
        return threads;
    }

    [[nodiscard]] std::vector<double> used() const {
        std::vector<double> used_s;
        for (const std::vector<int>& ids : threads_) {
            double sum_s = 0.0;
            for (const int id : ids) {
                sum_s += time_of_thread_s(id);
            }
            used_s.push_back(sum_s);
        }
        used_s.back() = bench_.control_s();
        return used_s;
    }

    Bench& bench_;
    LiveRun& run_;
    nlohmann::ordered_json first_;
    std::vector<std::vector<int>> threads_;  ///< of each module
    std::vector<double> used_s_;
    std::vector<double> begin_s_;
    Stamp begin_;
    Stamp last_;
};

void play_again(const std::filesystem::path& recordings, const TapedRobot& robot, LiveRun& run) {
    ReplayJob job;
    for (const auto& entry : std::filesystem::directory_iterator(recordings)) {
        job.logs.push_back(entry.path());
    }
    std::sort(job.logs.begin(), job.logs.end());
    job.on_result = [&](const Scan* scan, const ScanResult& result) {
        LiveScan live{.result = result, .P_world_base = {}};
        if (const auto revolution = robot.recognise(*scan)) {
            live.P_world_base = robot.truth()[*revolution];
        }
        run.scans.push_back(live);
    };
    const ReplayOutcome replay = run_replay(job);
    run.live_same = replay.live_same;
    run.live_other = replay.live_other;
    for (const float ms : replay.time_per_scan_ms) {
        run.replay_scan_ms += static_cast<double>(ms) / static_cast<double>(replay.time_per_scan_ms.size());
    }
}

}  // namespace

double LiveRun::load() const {
    double sum_s = 0.0;
    for (const ModuleLoad& module : modules) {
        sum_s += module.cpu_s;
    }
    return seconds > 0.0 ? sum_s / seconds : 0.0;
}

LiveRun run_live(const std::filesystem::path& directory, double seconds, const std::function<void(double)>& progress) {
    LiveRun run;
    const TapedRobot robot(seconds + kSpare_s, kSeed);
    {
        Bench bench(robot, directory);
        const Stamp give_up = monotonic_now() + Duration::from_seconds(kPatience_s);
        while (bench.service().status()["filter"]["matched"] == 0) {
            if (monotonic_now() > give_up) {
                throw std::runtime_error("the service finds no pose on the simulated robot");
            }
            bench.run_until(monotonic_now() + kTick);
        }
        Watch watch(bench, run);
        const auto intervals = static_cast<int>(seconds / kInterval_s);
        for (int i = 1; i <= intervals; ++i) {
            bench.run_until(watch.begin() + Duration::from_seconds(i * kInterval_s));
            watch.look();
            progress(static_cast<double>(i) / intervals);
        }
        watch.end();
        bench.service().stop();
    }
    // The service locks all memory of the process, where it may; what comes after it needs none of that.
    static_cast<void>(::munlockall());
    play_again(directory / "runs", robot, run);
    return run;
}

}  // namespace crspf::experiments
