// A CAN interface of Linux.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "platform/linux/reopening_fd.hpp"
#include "platform/linux/socket_message.hpp"
#include "platform/ports/can_bus.hpp"

namespace crspf {

/// Frames whose identifier has the bits of `id` under `mask`, and which are extended or not.
struct CanFilter {
    std::uint32_t id = 0;
    std::uint32_t mask = 0x1FFFFFFF;
    bool extended = false;
};

/// May be down or unplugged, at first and later: receive() opens it once it is up. Sets neither the bit rate nor
/// restart-ms: these are the administrator's (`ip link set can0 up type can bitrate 500000 restart-ms 100`).
class SocketCan final : public CanBus {
 public:
    /// No filter: every data frame.
    SocketCan(std::string interface, std::vector<CanFilter> filters)
        : interface_(std::move(interface)), filters_(std::move(filters)) {}
    /// On a socket of frames that is open already; closed for good once it is lost.
    explicit SocketCan(UniqueFd socket) { fd_.opened(std::move(socket)); }

    [[nodiscard]] Received receive(CanFrame& frame, Duration wait) override;
    [[nodiscard]] IoStatus send(const CanFrame& frame, Stamp deadline) override;
    [[nodiscard]] const CanHealth& health() const override { return health_; }

    /// errno of why it is closed; ENETDOWN: the interface is down, ENODEV: it is not there.
    [[nodiscard]] int error() const override { return fd_.error(); }

 private:
    bool open(Duration wait);
    [[nodiscard]] int prepare(int fd) const;
    void lose(int error);

    std::string interface_;  ///< empty: the socket was given
    std::vector<CanFilter> filters_;
    ReopeningFd fd_;
    MessageReceiver messages_;
    CanHealth health_;
    std::uint32_t dropped_ = 0;  ///< since the last result
};

}  // namespace crspf
