// crspfd: the service on the robot PC.
#include <spdlog/details/null_mutex.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/sinks/systemd_sink.h>
#include <spdlog/spdlog.h>
#include <systemd/sd-daemon.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "config/config.hpp"
#include "platform/crspfd/control_server.hpp"
#include "platform/crspfd/service_host.hpp"
#include "platform/files/input_error.hpp"
#include "platform/linux/machine.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "platform/linux/preflight.hpp"
#include "platform/service/preflight_needs.hpp"

namespace {

using namespace crspf;

constexpr Duration kTick{50'000'000};
constexpr Duration kWatchedTick{20'000'000};   ///< each scan of a lidar of 50 Hz is seen
constexpr Duration kFeed{500'000'000};         ///< a tenth of what the unit allows
constexpr Duration kDiskWait{60'000'000'000};  ///< that a slow disk may hold the main loop up

std::atomic<bool> stop_asked{false};  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables): a signal's

std::atomic<bool> reload_asked{false};  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables): a signal's

void ask_to_stop(int /*signal*/) {
    stop_asked = true;
}
void ask_to_reload(int /*signal*/) {
    reload_asked = true;
}

/// The log, also for those who watch. The board has one owner: nobody logs but the main thread.
class BoardSink final : public spdlog::sinks::base_sink<spdlog::details::null_mutex> {
 public:
    explicit BoardSink(std::shared_ptr<WatchBoard> board) : board_(std::move(board)) {}

 private:
    using Level = WatchBoard::Level;

    void sink_it_(const spdlog::details::log_msg& message) override {
        const auto since_1970 = std::chrono::duration_cast<std::chrono::nanoseconds>(message.time.time_since_epoch());
        board_->take_log(since_1970.count(), level_of(message.level),
                         std::string_view(message.payload.data(), message.payload.size()));
    }
    void flush_() override {}

    static Level level_of(spdlog::level::level_enum level) {
        return level >= spdlog::level::err    ? Level::kError
               : level == spdlog::level::warn ? Level::kWarning
               : level == spdlog::level::info ? Level::kInfo
                                              : Level::kDebug;
    }

    std::shared_ptr<WatchBoard> board_;
};

void start_log(std::shared_ptr<WatchBoard> board) {
    // systemd gives a stream to the journal; then levels and fields are worth more than text.
    // NOLINTNEXTLINE(concurrency-mt-unsafe): no other thread yet
    const bool journal = std::getenv("JOURNAL_STREAM") != nullptr;
    spdlog::set_default_logger(journal ? spdlog::systemd_logger_mt("crspfd") : spdlog::stderr_logger_mt("crspfd"));
    spdlog::default_logger()->sinks().push_back(std::make_shared<BoardSink>(std::move(board)));
    spdlog::set_pattern(journal ? "%v" : "%Y-%m-%dT%H:%M:%S.%e %l: %v");
}

std::string answer(ServiceHost& host, const ControlRequest& request) {
    using Command = ControlRequest::Command;
    using Json = nlohmann::ordered_json;
    const auto done = [](const char* what, const std::string& path) {
        spdlog::info("on command: {} {}", what, path);
        return result_line(path.empty() ? Json::object() : Json{{"path", path}});
    };
    Service& service = host.service();
    try {
        switch (request.command) {
            case Command::kStatus: return result_line(service.status());
            case Command::kPose: return result_line(service.pose());
            case Command::kSaveMap: return done("map saved", service.save_map().string());
            case Command::kLoadMap: host.load_map(request.text); return done("map loaded", request.text);
            case Command::kReset: host.reset(); return done("map emptied", "");
            case Command::kSetPose:
                if (!service.set_pose(request.P_map_base)) {
                    return error_line("earlier poses have not been taken yet; is the filter's thread alive?");
                }
                return done("pose set", "");
            case Command::kRelocalize: return result_line({{"search", service.relocalize()}});
            case Command::kRecordStart: return done("recording into", host.start_recording().string());
            case Command::kRecordStop: host.stop_recording(); return done("recording ended", "");
            case Command::kReload: host.reload(); return done("configuration read again", "");
            case Command::kLogLevel:
                spdlog::set_level(spdlog::level::from_str(request.text));
                return done("log level", "");
            case Command::kWatch: break;  // the control server's
        }
    } catch (const InputError& e) {
        spdlog::error("{}", e.what());
        return error_line(e.what());
    }
    return error_line("unknown command");
}

/// What this machine lacks goes to the log with its remedy. A sensor that is not there yet is no reason not to start.
void check_machine(const Config& config, bool allow_degraded) {
    const PreflightNeeds needs = needs_of(config);
    const std::vector<PreflightCheck> checks = run_preflight(needs, this_machine());
    const std::size_t of_machine = checks.size() - needs.devices.size();  // the devices' come last
    std::string failures;
    for (std::size_t i = 0; i < checks.size(); ++i) {
        const PreflightCheck& check = checks[i];
        if (check.verdict != Verdict::kOk) {
            spdlog::warn("{}: {}; {}", check.name, check.found, check.remedy);
        }
        if (check.verdict == Verdict::kFailure && i < of_machine) {
            failures += (failures.empty() ? "" : ", ") + check.name;
        }
    }
    if (!failures.empty() && !allow_degraded) {
        throw InputError("this machine cannot run the service in real time: " + failures +
                         "; mend that (`crspf doctor` says how), or give --allow-degraded");
    }
}

void run(ServiceHost& host, WatchBoard& board) {
    ControlServer control(
        host.config().service.control_socket, [&host](const ControlRequest& request) { return answer(host, request); },
        [&board](WatchCursor& cursor) { return board.next(cursor); });
    host.start();
    sd_notify(0, "READY=1");
    spdlog::info("ready");
    std::atomic<std::int64_t> turned_ns{monotonic_now().ns};
    // Beside the main loop, which may wait for the disk. Fed only while every loop turns: a thread that hangs ends in a
    // restart, on the last saved map. (The end has a time limit of systemd's own.)
    const std::jthread watchdog([&host, &turned_ns](const std::stop_token& stop) {
        for (Stamp next = monotonic_now(); !stop.stop_requested(); next = next + kFeed) {
            sleep_until(next);
            const bool alive = stop_asked || (host.alive() && monotonic_now() - Stamp{turned_ns} < kDiskWait);
            sd_notify(0, alive ? "WATCHDOG=1" : "STATUS=a thread is stuck");
        }
    });
    while (!stop_asked) {
        turned_ns = monotonic_now().ns;
        control.serve(board.watched() ? kWatchedTick : kTick);
        for (const ServiceEvent& event : host.service().tick()) {
            event.bad ? spdlog::warn("{}", event.text) : spdlog::info("{}", event.text);
        }
        board.watched(control.watchers() > 0);
        host.service().show(board);
        if (reload_asked.exchange(false)) {
            try {
                host.reload();
                spdlog::info("configuration read again");
            } catch (const InputError& e) {
                spdlog::error("{}", e.what());
            }
        }
    }
    sd_notify(0, "STOPPING=1");
    spdlog::info("stopping");
    host.stop();
    spdlog::info("stopped, map saved");
}

int run(int argc, char** argv) {
    CLI::App app{
        "The SLAM service on the robot PC: sensors in, map and pose out. Speak to it with `crspf ctl`.\n\n"
        "Examples:\n"
        "  crspfd --config /etc/crspf/crspfd.toml\n"
        "  crspfd --config robot.toml --allow-degraded --check"};
    app.name("crspfd");
    app.set_version_flag("--version", CRSPF_VERSION);
    std::string file = "/etc/crspf/crspfd.toml";
    ServiceOptions options;
    bool check = false;
    app.add_option("--config", file, "The robot: sources, pose_output, threads, service")->capture_default_str();
    app.add_flag("--allow-degraded", options.allow_degraded,
                 "Run without real-time priorities and locked memory where they are not to be had");
    app.add_flag("--check", check, "Read the configuration and the saved map, then exit");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        return app.exit(e) == 0 ? 0 : 2;
    }
    ServiceHost host(file, options);
    if (check) {
        std::puts("configuration and saved map are good");
        return 0;
    }
    const auto board = std::make_shared<WatchBoard>();
    start_log(board);
    check_machine(host.config(), options.allow_degraded);
    std::signal(SIGTERM, ask_to_stop);
    std::signal(SIGINT, ask_to_stop);
    std::signal(SIGHUP, ask_to_reload);
    std::signal(SIGPIPE, SIG_IGN);
    run(host, *board);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const crspf::InputError& e) {
        std::fprintf(stderr, "crspfd: error: %s\n", e.what());
        return 1;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "crspfd: internal error: %s\nPlease report this with the command line.\n", e.what());
        return 3;
    }
}
