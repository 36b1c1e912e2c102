#include "platform/linux/socketcan.hpp"

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "platform/linux/can_error.hpp"
#include "platform/linux/socket_options.hpp"

namespace crspf {
namespace {

constexpr Duration kQueuePause{500'000};  // about two full frames at 500 kbit/s

/// The kernel's own layouts differ in their length only.
bool from_kernel(const canfd_frame& kernel, std::size_t bytes, CanFrame& frame) {
    if (bytes != CAN_MTU && bytes != CANFD_MTU) {
        return false;
    }
    const bool extended = (kernel.can_id & CAN_EFF_FLAG) != 0;
    const bool error = (kernel.can_id & CAN_ERR_FLAG) != 0;
    frame = {.id = kernel.can_id & (extended || error ? CAN_EFF_MASK : CAN_SFF_MASK),
             .extended = extended,
             .remote = (kernel.can_id & CAN_RTR_FLAG) != 0,
             .error = error,
             .fd = bytes == CANFD_MTU,
             .length = kernel.len};
    if (!is_valid(frame)) {
        return false;
    }
    std::copy_n(std::begin(kernel.data), frame.payload().size(), frame.data.begin());
    return true;
}

canfd_frame to_kernel(const CanFrame& frame) {
    canfd_frame kernel{};
    kernel.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0U) | (frame.remote ? CAN_RTR_FLAG : 0U);
    kernel.len = frame.length;
    std::copy_n(frame.data.begin(), frame.payload().size(), std::begin(kernel.data));
    return kernel;
}

/// 0, or errno.
int bind_to(int fd, const std::string& interface) {
    ifreq request{};
    if (interface.size() >= sizeof(request.ifr_name)) {
        return ENODEV;
    }
    std::copy(interface.begin(), interface.end(), std::begin(request.ifr_name));
    if (::ioctl(fd, SIOCGIFFLAGS, &request) != 0) {
        return errno;
    }
    // A socket can be bound to an interface that is down, and then hears nothing, not even that.
    if ((static_cast<unsigned>(request.ifr_flags) & static_cast<unsigned>(IFF_UP)) == 0) {
        return ENETDOWN;
    }
    if (::ioctl(fd, SIOCGIFINDEX, &request) != 0) {
        return errno;
    }
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = request.ifr_ifindex;
    return ::bind(fd, any_address(address), sizeof(address)) == 0 ? 0 : errno;
}

}  // namespace

int SocketCan::prepare(int fd) const {
    std::vector<can_filter> filters;
    for (const CanFilter& filter : filters_) {
        // Without these two flags in the mask, a standard filter would let pass extended and remote frames.
        filters.push_back({.can_id = filter.id | (filter.extended ? CAN_EFF_FLAG : 0U),
                           .can_mask = filter.mask | CAN_EFF_FLAG | CAN_RTR_FLAG});
    }
    const can_err_mask_t errors = CAN_ERR_MASK;
    const bool set =
        MessageReceiver::prepare(fd) &&
        (filters.empty() || ::setsockopt(fd, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(),
                                         static_cast<socklen_t>(filters.size() * sizeof(can_filter))) == 0) &&
        ::setsockopt(fd, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof(errors)) == 0 &&
        set_option(fd, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, 1);
    return set ? bind_to(fd, interface_) : errno;
}

bool SocketCan::open(Duration wait) {
    if (fd_.is_open()) {
        return true;
    }
    if (!fd_.may_open(wait)) {
        return false;
    }
    UniqueFd fd(interface_.empty() ? -1 : ::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW));
    const int error = interface_.empty() ? EBADF : fd.valid() ? prepare(fd.get()) : errno;
    if (error != 0) {
        fd_.failed(error);
        return false;
    }
    messages_.restart();
    health_.state = CanState::kActive;  // the next error frame knows better
    fd_.opened(std::move(fd));
    return true;
}

void SocketCan::lose(int error) {
    ++health_.interface_downs;
    fd_.lost(error);
}

Received SocketCan::receive(CanFrame& frame, Duration wait) {
    const Stamp deadline = monotonic_now() + wait;
    if (!open(wait)) {
        return {.status = IoStatus::kClosed};
    }
    // Error frames must not keep the caller beyond its wait: the clock is looked at after each of them.
    for (Stamp now = monotonic_now();; now = monotonic_now()) {
        const short events = wait_for(fd_.get(), POLLIN, deadline - now);
        if (events == 0) {
            return {};
        }
        canfd_frame kernel{};
        std::array<std::uint8_t, sizeof(kernel)> bytes{};
        const SocketMessage message = messages_.receive(fd_.get(), bytes);
        // ENETDOWN comes once, and then silence for as long as the interface is down: reopening watches for it.
        if (message.error != 0 && (!is_temporary(message.error) || (events & POLLIN) == 0)) {
            lose(message.error);
            return {.status = IoStatus::kClosed};
        }
        dropped_ += message.dropped;
        health_.dropped += message.dropped;
        std::memcpy(&kernel, bytes.data(), sizeof(kernel));
        CanFrame received;
        if (message.error == 0 && from_kernel(kernel, message.bytes, received)) {
            if (!received.error) {
                frame = received;
                return {.status = IoStatus::kOk,
                        .bytes = received.payload().size(),
                        .stamp = message.stamp,
                        .dropped = std::exchange(dropped_, 0)};
            }
            note_can_error(received, health_);
        }
        if (monotonic_now() >= deadline) {
            return {};
        }
    }
}

IoStatus SocketCan::send(const CanFrame& frame, Stamp deadline) {
    if (!is_valid(frame) || frame.error) {
        return IoStatus::kError;
    }
    if (!fd_.is_open()) {
        return IoStatus::kClosed;
    }
    const canfd_frame kernel = to_kernel(frame);
    const std::size_t bytes = frame.fd ? CANFD_MTU : CAN_MTU;
    while (::send(fd_.get(), &kernel, bytes, MSG_DONTWAIT | MSG_NOSIGNAL) < 0) {
        const int error = errno;
        if (error == EINVAL || error == EMSGSIZE) {  // an FD frame on a classic bus
            return IoStatus::kError;
        }
        if (error != ENOBUFS && !is_temporary(error)) {
            lose(error);
            return IoStatus::kClosed;
        }
        ++health_.queue_full;
        const Stamp now = monotonic_now();
        if (now >= deadline) {
            ++health_.send_timeouts;
            return IoStatus::kRetry;
        }
        // Not poll(): it says that there is room while the interface's queue is full.
        sleep_until(std::min(deadline, now + kQueuePause));
    }
    return IoStatus::kOk;
}

}  // namespace crspf
