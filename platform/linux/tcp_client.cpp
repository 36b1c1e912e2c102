#include "platform/linux/tcp_client.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>

#include "platform/linux/socket_options.hpp"

namespace crspf {

void TcpClient::begin_connect() {
    UniqueFd fd(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    if (!fd.valid()) {
        fd_.failed(errno);
        return;
    }
    // One probe a second of a silent partner, two without an answer; unanswered data count as silence, too.
    constexpr int kSilence_ms = static_cast<int>(kSilenceMax.ns / 1'000'000);
    const bool set =
        set_option(fd.get(), IPPROTO_TCP, TCP_NODELAY, 1) && set_option(fd.get(), SOL_SOCKET, SO_KEEPALIVE, 1) &&
        set_option(fd.get(), IPPROTO_TCP, TCP_KEEPIDLE, 1) && set_option(fd.get(), IPPROTO_TCP, TCP_KEEPINTVL, 1) &&
        set_option(fd.get(), IPPROTO_TCP, TCP_KEEPCNT, 2) &&
        set_option(fd.get(), IPPROTO_TCP, TCP_USER_TIMEOUT, kSilence_ms);
    const sockaddr_in to = socket_address(address_, port_);
    if (!set || (::connect(fd.get(), any_address(to), sizeof(to)) != 0 && errno != EINPROGRESS)) {
        fd_.failed(errno);
        return;
    }
    connect_deadline_ = monotonic_now() + kConnectMax;
    connecting_ = std::move(fd);
}

bool TcpClient::connect(Duration wait) {
    if (fd_.is_open()) {
        return true;
    }
    if (!connecting_.valid()) {
        if (!fd_.may_open(wait)) {
            return false;
        }
        begin_connect();
        return false;
    }
    if (wait_for(connecting_.get(), POLLOUT, wait) != 0) {
        const int error = pending_error(connecting_.get());
        if (error == 0) {
            fd_.opened(std::move(connecting_));
            return true;
        }
        connecting_ = UniqueFd();
        fd_.failed(error);
    } else if (monotonic_now() >= connect_deadline_) {
        connecting_ = UniqueFd();
        fd_.failed(ETIMEDOUT);
    }
    return false;
}

Received TcpClient::read(std::span<std::uint8_t> into, Duration wait) {
    const bool was_open = fd_.is_open();
    if (!connect(wait)) {
        return {.status = IoStatus::kClosed};
    }
    const short events = wait_for(fd_.get(), POLLIN, was_open ? wait : Duration{});  // opening has waited already
    if (events == 0) {
        return {};
    }
    if (into.empty()) {  // only to open it: reading nothing is not the end of the stream
        return {};
    }
    // Whatever happened, the read tells: bytes that came before the end, the end, or the error.
    const ssize_t got = ::recv(fd_.get(), into.data(), into.size(), 0);
    if (got > 0) {
        return {.status = IoStatus::kOk, .bytes = static_cast<std::size_t>(got), .stamp = monotonic_now()};
    }
    if (got < 0 && is_temporary(errno) && (events & (POLLHUP | POLLERR | POLLNVAL)) == 0) {
        return {};
    }
    fd_.lost(got < 0 ? errno : ECONNRESET);
    return {.status = IoStatus::kClosed};
}

Sent TcpClient::write(std::span<const std::uint8_t> bytes) {
    if (!fd_.is_open()) {
        return {.status = IoStatus::kClosed};
    }
    const ssize_t put = ::send(fd_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (put >= 0) {
        return {.status = put > 0 ? IoStatus::kOk : IoStatus::kRetry, .bytes = static_cast<std::size_t>(put)};
    }
    if (is_temporary(errno)) {
        return {};
    }
    fd_.lost(errno);
    return {.status = IoStatus::kClosed};
}

void TcpClient::close() {
    connecting_ = UniqueFd();
    fd_.lost(0);
}

}  // namespace crspf
