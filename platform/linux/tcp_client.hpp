// A TCP connection to a sensor.
#pragma once

#include <cstdint>

#include "platform/linux/reopening_fd.hpp"
#include "platform/ports/byte_stream.hpp"

namespace crspf {

/// Connects and connects again, from within read(). A partner that is gone without a word is noticed within
/// kSilenceMax, by probes of the system.
class TcpClient final : public ByteStream {
 public:
    static constexpr Duration kConnectMax{2'000'000'000};
    static constexpr Duration kSilenceMax{4'000'000'000};

    /// IPv4, as a number: 192.168.0.10 is 0xC0A8000A.
    TcpClient(std::uint32_t address, std::uint16_t port) : address_(address), port_(port) {}

    [[nodiscard]] Received read(std::span<std::uint8_t> into, Duration wait) override;
    [[nodiscard]] Sent write(std::span<const std::uint8_t> bytes) override;
    [[nodiscard]] IoStatus set_baud(std::uint32_t /*baud*/) override {
        return fd_.is_open() ? IoStatus::kOk : IoStatus::kClosed;
    }
    void close() override;

    /// errno of why it is closed.
    [[nodiscard]] int error() const override { return fd_.error(); }

 private:
    bool connect(Duration wait);
    void begin_connect();

    std::uint32_t address_;
    std::uint16_t port_;
    ReopeningFd fd_;
    UniqueFd connecting_;  ///< its connection is under way
    Stamp connect_deadline_;
};

}  // namespace crspf
