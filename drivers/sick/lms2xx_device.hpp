// A simulated LMS2xx: commands in, acknowledgements, replies and scans out.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/time.hpp"
#include "drivers/sick/lms2xx_parser.hpp"

namespace crspf {

/// Wait-free. Times are the caller's. Bytes at another speed than baud() do not reach it, nor its own the host.
class Lms2xxDevice {
 public:
    explicit Lms2xxDevice(std::uint32_t baud) : baud_(baud), next_baud_(baud) {}

    /// What it measures: values, unit and indices; the count is its variant's.
    [[nodiscard]] Lms2xxScan& measurement() { return scan_; }

    void on_bytes(std::span<const std::uint8_t> bytes, Stamp now);
    /// Sends the scan that is due by now, one a call.
    void on_time(Stamp now);

    /// What it sends at baud(); to be cleared by who took it. A new speed holds from then on.
    [[nodiscard]] std::span<const std::uint8_t> output() const { return std::span(out_).first(out_size_); }
    void clear_output();

    [[nodiscard]] std::uint32_t baud() const { return baud_; }
    [[nodiscard]] bool streams() const { return streams_; }

 private:
    void on_command(std::span<const std::uint8_t> payload, Stamp now);
    void byte(std::uint8_t value);
    void reply(std::span<const std::uint8_t> payload);

    std::uint32_t baud_;
    std::uint32_t next_baud_;
    Lms2xxVariant variant_;
    Lms2xxParser parser_;
    Lms2xxScan scan_;
    bool streams_ = false;
    Stamp next_scan_;
    std::array<std::uint8_t, 4 * kLargestLms2xxTelegram> out_{};
    std::size_t out_size_ = 0;
};

}  // namespace crspf
