#include "platform/crspfd/control_server.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>
#include <utility>
#include <vector>

#include "platform/crspfd/control_address.hpp"
#include "platform/files/input_error.hpp"

namespace crspf {

namespace {

constexpr int kBacklog = 16;
constexpr mode_t kOwnerAndGroup = 0660;
/// More than the longest answer a few times over: who lets it grow beyond does not read.
constexpr std::size_t kUnreadMax = std::size_t{1} << 20U;
/// To one watcher, before the others have their turn.
constexpr int kLinesAtOnce = 4;

}  // namespace

ControlServer::ControlServer(std::filesystem::path path, Handler handler, NextLine next)
    : path_(std::move(path)), handler_(std::move(handler)), next_(std::move(next)) {
    const auto fail = [this](const std::string& what) {
        throw InputError(path_.string() + ": " + what + "; set [service] control_socket");
    };
    const ControlAddress address(path_);
    if (const UniqueFd probe(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
        ::connect(probe.get(), address.get(), ControlAddress::size()) == 0) {
        fail("another service listens there");
    }
    ::unlink(path_.c_str());  // what a service left that was killed
    listener_ = UniqueFd(::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    if (!listener_.valid() || ::bind(listener_.get(), address.get(), ControlAddress::size()) != 0 ||
        ::chmod(path_.c_str(), kOwnerAndGroup) != 0 || ::listen(listener_.get(), kBacklog) != 0) {
        fail("cannot be listened at: " + std::generic_category().message(errno));
    }
}

ControlServer::~ControlServer() {
    ::unlink(path_.c_str());
}

void ControlServer::serve(Duration wait) {
    for (Peer& peer : peers_) {
        if (!send_news(peer)) {
            peer.fd = UniqueFd();
        }
    }
    std::erase_if(peers_, [](const Peer& peer) { return !peer.fd.valid(); });
    std::vector<pollfd> entries{{.fd = listener_.get(), .events = POLLIN, .revents = 0}};
    for (const Peer& peer : peers_) {
        const auto events = static_cast<short>(POLLIN | (peer.to_send.empty() ? 0 : POLLOUT));
        entries.push_back({.fd = peer.fd.get(), .events = events, .revents = 0});
    }
    constexpr std::int64_t kMillisecond = 1'000'000;
    if (::poll(entries.data(), entries.size(), static_cast<int>(wait.ns / kMillisecond)) <= 0) {
        return;
    }
    std::deque<Peer> staying;
    for (std::size_t i = 0; i < peers_.size(); ++i) {
        Peer& peer = peers_[i];
        const short happened = entries[i + 1].revents;
        const bool stays = (happened == 0 || read_from(peer)) && write_to(peer);
        if (stays) {
            staying.push_back(std::move(peer));
        }
    }
    peers_ = std::move(staying);
    accept_all();
}

std::size_t ControlServer::watchers() const {
    return static_cast<std::size_t>(
        std::count_if(peers_.begin(), peers_.end(), [](const Peer& peer) { return peer.watch.has_value(); }));
}

void ControlServer::accept_all() {
    for (;;) {
        UniqueFd fd(::accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
        if (!fd.valid()) {
            return;
        }
        if (peers_.size() == kPeersMax) {
            ++counters_.refused;
            continue;
        }
        peers_.push_back({.fd = std::move(fd), .received = {}, .to_send = {}, .watch = {}});
    }
}

bool ControlServer::read_from(Peer& peer) {
    std::array<char, kRequestBytesMax> buffer{};
    const ssize_t got = ::recv(peer.fd.get(), buffer.data(), buffer.size(), 0);
    if (got <= 0) {
        return got < 0 && (errno == EAGAIN || errno == EINTR);
    }
    peer.received.append(buffer.data(), static_cast<std::size_t>(got));
    for (std::size_t end = 0; (end = peer.received.find('\n')) != std::string::npos;) {
        answer(peer, std::string_view(peer.received).substr(0, end));
        peer.received.erase(0, end + 1);
    }
    if (peer.received.size() >= kRequestBytesMax || peer.to_send.size() > kUnreadMax) {
        ++counters_.cut_off;
        return false;
    }
    return true;
}

void ControlServer::answer(Peer& peer, std::string_view line) {
    ++counters_.requests;
    std::string error;
    if (const auto request = parse_request(line, error)) {
        peer.to_send += request->command == ControlRequest::Command::kWatch ? begin_watch(peer) : handler_(*request);
    } else {
        ++counters_.bad_requests;
        peer.to_send += error_line(error);
    }
}

std::string ControlServer::begin_watch(Peer& peer) {
    if (!next_) {
        return error_line("watch: there is nothing to be watched");
    }
    if (!peer.watch && watchers() == kWatchersMax) {
        ++counters_.refused;
        return error_line("watch: " + std::to_string(kWatchersMax) + " watch already; close one of them");
    }
    peer.watch = peer.watch.value_or(WatchCursor{});
    return result_line(nlohmann::ordered_json::object());
}

bool ControlServer::send_news(Peer& peer) {
    for (int i = 0; peer.watch && i < kLinesAtOnce && peer.to_send.empty(); ++i) {
        peer.to_send = next_(*peer.watch);
        if (peer.to_send.empty()) {
            return true;
        }
        if (!write_to(peer)) {
            return false;
        }
    }
    return true;
}

bool ControlServer::write_to(Peer& peer) {
    while (!peer.to_send.empty()) {
        const ssize_t sent = ::send(peer.fd.get(), peer.to_send.data(), peer.to_send.size(), MSG_NOSIGNAL);
        if (sent < 0) {
            return errno == EAGAIN || errno == EINTR;
        }
        peer.to_send.erase(0, static_cast<std::size_t>(sent));
    }
    return true;
}

}  // namespace crspf
