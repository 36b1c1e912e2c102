#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "platform/crspfd/control_client.hpp"
#include "platform/files/input_error.hpp"
#include "tools/crspf/commands.hpp"
#include "tools/crspf/top_screen.hpp"

namespace crspf::cli {
namespace {

constexpr Duration kTopWait{5'000'000'000};

struct TopOptions {
    std::string socket = "/run/crspf/control";
    double period_s = 0.5;
    bool once = false;
};

/// Keys come one by one and unseen, on a screen of its own, until the end of its life.
class Screen {
 public:
    Screen() {
        if (::tcgetattr(STDIN_FILENO, &before_) != 0) {
            return;
        }
        termios raw = before_;
        raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO | ISIG);
        changed_ = ::tcsetattr(STDIN_FILENO, TCSANOW, &raw) == 0;
        std::fputs("\x1b[?1049h\x1b[?25l", stdout);
    }
    Screen(const Screen&) = delete;
    Screen& operator=(const Screen&) = delete;
    ~Screen() {
        std::fputs("\x1b[?25h\x1b[?1049l", stdout);
        std::fflush(stdout);
        if (changed_) {
            ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
        }
    }

    static void show(const std::vector<std::string>& lines) {
        std::string out = "\x1b[H";
        for (const std::string& line : lines) {
            out += line + "\x1b[K\n";
        }
        out += "\x1b[J";
        std::fputs(out.c_str(), stdout);
        std::fflush(stdout);
    }
    /// Waits so long for a key; true: it means the end.
    static bool quits(double seconds) {
        constexpr char kControlC = 3;
        pollfd keys{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
        if (::poll(&keys, 1, static_cast<int>(1e3 * seconds)) <= 0) {
            return false;
        }
        char key = 'q';  // also at the end of the input
        static_cast<void>(::read(STDIN_FILENO, &key, 1));
        return key == 'q' || key == kControlC;
    }

 private:
    termios before_{};
    bool changed_ = false;
};

std::size_t columns() {
    winsize size{};
    return ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 200U;
}

void watch(const TopOptions& options) {
    ControlRequest request;
    request.command = ControlRequest::Command::kStatus;
    nlohmann::ordered_json before;
    if (options.once || ::isatty(STDOUT_FILENO) == 0) {
        before = ask(options.socket, request, kTopWait);
        ::usleep(static_cast<useconds_t>(1e6 * options.period_s));
        for (const std::string& line : top_screen(ask(options.socket, request, kTopWait), before, std::string::npos)) {
            std::puts(line.c_str());
        }
        return;
    }
    nlohmann::ordered_json status =
        ask(options.socket, request, kTopWait);  // what is wrong at once is said on the old screen
    const Screen screen;
    for (;;) {
        std::vector<std::string> lines;
        if (status.is_null()) {
            lines = {"no answer; crspfd may be restarting"};
        } else {
            lines = top_screen(status, before, columns());
        }
        lines.insert(lines.end(), {"", "q: quit"});
        Screen::show(lines);
        if (Screen::quits(options.period_s)) {
            return;
        }
        before = std::move(status);
        try {
            status = ask(options.socket, request, kTopWait);
        } catch (const InputError&) {
            status = nullptr;
        }
    }
}

}  // namespace

void add_top(CLI::App& app) {
    auto options = std::make_shared<TopOptions>();
    CLI::App* const top =
        app.add_subcommand("top", "Watch the running service: pose, match, rates, latencies, sensors, troubles");
    top->add_option("--socket", options->socket, "Where the service listens")->capture_default_str();
    top->add_option("--period", options->period_s, "Between two looks [s]")
        ->check(CLI::Range(0.05, 60.0))
        ->capture_default_str();
    top->add_flag("--once", options->once, "One look as plain text; so it is, too, where there is no terminal");
    top->footer(
        "Examples:\n"
        "  crspf top\n"
        "  crspf top --once | grep lidar");
    top->callback([options] { watch(*options); });
}

}  // namespace crspf::cli
