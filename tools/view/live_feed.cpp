#include "tools/view/live_feed.hpp"

#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <system_error>
#include <utility>
#include <variant>

#include "platform/crspfd/control_address.hpp"
#include "platform/crspfd/control_protocol.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "tools/view/watch_line.hpp"

namespace crspf::view {

namespace {

constexpr std::size_t kReadAtOnce = 65536;
constexpr int kReadsATurn = 16;  ///< then others have their turn

}  // namespace

LiveFeed::LiveFeed(std::filesystem::path socket) : socket_(std::move(socket)) {
    static_cast<void>(ControlAddress(socket_));
}

void LiveFeed::turn(std::vector<RunEvent>& out) {
    const Stamp now = monotonic_now();
    if (!fd_.valid() && (tried_ == Stamp{} || now - tried_ >= kRetry)) {
        connect(now, out);
    }
    if (fd_.valid()) {
        read(now, out);
    }
    if (fd_.valid() && now - heard_ > kSilenceMax) {
        close("the service says nothing; see its log", out);
    }
}

void LiveFeed::connect(Stamp now, std::vector<RunEvent>& out) {
    tried_ = heard_ = now;
    fd_ = UniqueFd(::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    const ControlAddress address(socket_);
    if (!fd_.valid() || ::connect(fd_.get(), address.get(), ControlAddress::size()) != 0) {
        const bool denied = errno == EACCES;
        close(std::generic_category().message(errno) +
                  (denied ? "; be a member of the socket's group" : "; does crspfd run? --socket names another"),
              out);
        return;
    }
    const std::string request =
        request_line({.command = ControlRequest::Command::kWatch, .P_map_base = {}, .text = {}});
    if (::send(fd_.get(), request.data(), request.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(request.size())) {
        close("the service does not take the request; see its log", out);
    }
}

void LiveFeed::read(Stamp now, std::vector<RunEvent>& out) {
    std::array<char, kReadAtOnce> buffer{};
    for (int i = 0; i < kReadsATurn; ++i) {
        const ssize_t got = ::recv(fd_.get(), buffer.data(), buffer.size(), 0);
        if (got < 0 && (errno == EAGAIN || errno == EINTR)) {
            return;
        }
        if (got <= 0) {
            close("the service closed the connection; see its log", out);
            return;
        }
        heard_ = now;
        std::string_view rest(buffer.data(), static_cast<std::size_t>(got));
        for (std::size_t end = 0; (end = rest.find('\n')) != std::string_view::npos;) {
            received_.append(rest.substr(0, end));
            rest.remove_prefix(end + 1);
            if (!take_line(std::exchange(received_, {}), out)) {
                return;
            }
        }
        received_.append(rest);
        if (received_.size() >= kWatchLineMax) {
            ++counters_.bad_lines;
            close("what it says is no line of crspfd's: it is too long", out);
            return;
        }
    }
}

bool LiveFeed::take_line(std::string_view line, std::vector<RunEvent>& out) {
    ++counters_.lines;
    WatchLine parsed = parse_watch_line(line);
    if (const auto* const tiles = std::get_if<TilesEvent>(&parsed.event);
        parsed.kind == WatchLine::Kind::kEvent && tiles != nullptr) {
        map_begun_ = map_begun_ || tiles->fresh;
        if (!map_begun_) {
            parsed = {.kind = WatchLine::Kind::kBad, .event = {}, .text = "tiles: of a map that has not begun"};
        }
    }
    switch (parsed.kind) {
        case WatchLine::Kind::kWelcome:
            ++counters_.connections;
            away_told_ = false;
            out.emplace_back(AwayEvent{.away = false, .why = {}});
            return true;
        case WatchLine::Kind::kEvent: out.push_back(std::move(parsed.event)); return true;
        case WatchLine::Kind::kRefusal: close(parsed.text, out); return false;
        case WatchLine::Kind::kBad: break;
    }
    ++counters_.bad_lines;
    close("what it says is no line of crspfd's: " + parsed.text, out);
    return false;
}

void LiveFeed::close(const std::string& why, std::vector<RunEvent>& out) {
    fd_ = UniqueFd();
    received_.clear();
    map_begun_ = false;
    if (!std::exchange(away_told_, true) || why_away_ != why) {
        why_away_ = why;
        out.emplace_back(AwayEvent{.away = true, .why = socket_.string() + ": " + why});
    }
}

}  // namespace crspf::view
