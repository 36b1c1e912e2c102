#include "tools/crspf/stop_signals.hpp"

#include <csignal>

namespace crspf::cli {
namespace {

std::atomic<bool> stop_asked{false};  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables): a signal's

void ask_to_stop(int /*signal*/) {
    stop_asked = true;
}

}  // namespace

const std::atomic<bool>& stop_on_signals() {
    struct sigaction action {};
    action.sa_handler = ask_to_stop;  // NOLINT(cppcoreguidelines-pro-type-union-access): glibc declares it so
    ::sigaction(SIGINT, &action, nullptr);
    ::sigaction(SIGTERM, &action, nullptr);
    return stop_asked;
}

}  // namespace crspf::cli
