// A simulated LMS1xx, LMS5xx or TiM: CoLa commands in, replies and scans out.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/time.hpp"
#include "drivers/sick/cola_parser.hpp"
#include "drivers/sick/lmd_scandata.hpp"

namespace crspf {

struct SickDeviceParams {
    ColaDialect dialect = ColaDialect::kBinary;
    Duration silence{};             ///< after power-on: says nothing
    Duration until_ready{};         ///< after power-on: STlms says less than 7
    bool knows_status = true;       ///< a TiM does not know STlms
    bool knows_scan_config = true;  ///< nor mLMPsetscancfg
    bool takes_password = true;
    std::uint32_t clock_start_us = 0;  ///< its clock at power-on
};

/// Wait-free. Times are the caller's.
class SickDevice {
 public:
    SickDevice(const SickDeviceParams& params, Stamp power_on) : params_(params), power_on_(power_on) {}

    /// What it measures: geometry, frequency and values, to be set by the caller. Counters and times it sets itself.
    [[nodiscard]] LmdScandata& measurement() { return measurement_; }

    /// A new connection: it no longer streams, and speaks the dialect that it was last switched to.
    void on_connect();
    void on_bytes(std::span<const std::uint8_t> bytes, Stamp now);
    /// Sends the scan that is due by now, one a call.
    void on_time(Stamp now);
    /// A sweep that began then is over: sends it where scans are wanted. In place of on_time(), for a mirror that turns
    /// as the caller says.
    void on_sweep(Stamp began, Stamp now);

    /// What it sends; to be cleared by who took it.
    [[nodiscard]] std::span<const std::uint8_t> output() const { return std::span(out_).first(out_size_); }
    void clear_output() { out_size_ = 0; }

    [[nodiscard]] bool streams() const { return streams_; }
    [[nodiscard]] const SickScanConfig& scan_config() const { return scan_config_; }
    [[nodiscard]] std::uint64_t output_dropped() const { return output_dropped_; }

 private:
    void on_command(const ColaTelegram& telegram, Stamp now);
    void reply(const ColaFieldWriter& fields);
    void refuse(std::uint8_t number);

    SickDeviceParams params_;
    Stamp power_on_;
    ColaDialect next_dialect_ = params_.dialect;
    ColaParser parser_;
    LmdScandata measurement_;
    SickScanConfig scan_config_;
    bool logged_in_ = false;
    bool streams_ = false;
    Stamp next_scan_;
    std::array<std::uint8_t, kLargestColaPayload> payload_{};
    std::array<std::uint8_t, 2 * (kLargestColaPayload + kColaFrame)> out_{};
    std::size_t out_size_ = 0;
    std::uint64_t output_dropped_ = 0;
};

}  // namespace crspf
