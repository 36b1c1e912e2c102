#include "platform/linux/serial_port.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>

#include "platform/linux/is_temporary.hpp"
#include "platform/linux/serial_line.hpp"

namespace crspf {
namespace {

constexpr int kGone = POLLHUP | POLLERR | POLLNVAL;

}  // namespace

SerialPort::~SerialPort() {
    if (fd_.is_open()) {
        release_serial_line(fd_.get());
    }
}

void SerialPort::lose(int error) {
    if (fd_.is_open()) {
        release_serial_line(fd_.get());
    }
    fd_.lost(error);
}

bool SerialPort::open(Duration wait) {
    if (fd_.is_open()) {
        return true;
    }
    if (!fd_.may_open(wait)) {
        return false;
    }
    UniqueFd fd(::open(path_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    int error = fd.valid() ? claim_serial_line(fd.get()) : errno;
    if (error == 0) {
        error = set_serial_line(fd.get(), baud_);
        if (error != 0) {
            release_serial_line(fd.get());
        }
    }
    if (error != 0) {
        fd_.failed(error);
        return false;
    }
    fd_.opened(std::move(fd));
    return true;
}

Received SerialPort::read(std::span<std::uint8_t> into, Duration wait) {
    const bool was_open = fd_.is_open();
    if (!open(wait)) {
        return {.status = IoStatus::kClosed};
    }
    const short events = wait_for(fd_.get(), POLLIN, was_open ? wait : Duration{});  // opening has waited already
    // Before the read: a line that hung up is readable for ever, and gives nothing.
    if ((events & kGone) != 0) {
        lose(EIO);
        return {.status = IoStatus::kClosed};
    }
    if (events == 0) {
        return {};
    }
    if (into.empty()) {  // only to open it: reading nothing is not the end of the stream
        return {};
    }
    const ssize_t got = ::read(fd_.get(), into.data(), into.size());
    if (got > 0) {
        return {.status = IoStatus::kOk, .bytes = static_cast<std::size_t>(got), .stamp = monotonic_now()};
    }
    if (got < 0 && is_temporary(errno)) {
        return {};
    }
    lose(got < 0 ? errno : EIO);
    return {.status = IoStatus::kClosed};
}

Sent SerialPort::write(std::span<const std::uint8_t> bytes) {
    if (!fd_.is_open()) {
        return {.status = IoStatus::kClosed};
    }
    const ssize_t put = ::write(fd_.get(), bytes.data(), bytes.size());
    if (put >= 0) {
        return {.status = put > 0 ? IoStatus::kOk : IoStatus::kRetry, .bytes = static_cast<std::size_t>(put)};
    }
    if (is_temporary(errno)) {
        return {};
    }
    lose(errno);
    return {.status = IoStatus::kClosed};
}

IoStatus SerialPort::set_baud(std::uint32_t baud) {
    if (!fd_.is_open()) {
        return IoStatus::kClosed;
    }
    const int error = set_serial_line(fd_.get(), baud);
    if (error == EIO || error == ENXIO) {
        lose(error);
        return IoStatus::kClosed;
    }
    return error == 0 ? IoStatus::kOk : IoStatus::kError;
}

}  // namespace crspf
