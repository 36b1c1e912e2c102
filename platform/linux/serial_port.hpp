// A serial line of Linux.
#pragma once

#include <cstdint>
#include <string>

#include "platform/linux/reopening_fd.hpp"
#include "platform/ports/byte_stream.hpp"

namespace crspf {

/// Need not be there at first, and may be unplugged and plugged in again: a path below /dev/serial/by-id then still
/// names the same sensor. read() opens it.
class SerialPort final : public ByteStream {
 public:
    SerialPort(std::string path, std::uint32_t baud) : path_(std::move(path)), baud_(baud) {}
    SerialPort(const SerialPort&) = delete;
    SerialPort& operator=(const SerialPort&) = delete;
    ~SerialPort() override;

    [[nodiscard]] Received read(std::span<std::uint8_t> into, Duration wait) override;
    [[nodiscard]] Sent write(std::span<const std::uint8_t> bytes) override;
    /// Waits until what was written is sent. kError for what the hardware cannot do.
    [[nodiscard]] IoStatus set_baud(std::uint32_t baud) override;
    void close() override { lose(0); }

    /// errno of why it is closed; EBUSY: another process has it.
    [[nodiscard]] int error() const override { return fd_.error(); }

 private:
    bool open(Duration wait);
    void lose(int error);

    std::string path_;
    std::uint32_t baud_;
    ReopeningFd fd_;
};

}  // namespace crspf
