// A simulated SCIP sensor: what the bytes of a host make a URG answer. For tests and simulators.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/time.hpp"
#include "drivers/common/byte_writer.hpp"
#include "drivers/scip/scip_parser.hpp"
#include "drivers/scip/scip_sensor.hpp"

namespace crspf {

struct ScipDeviceParams {
    ScipSensor sensor;
    bool starts_in_scip1 = false;
    std::uint32_t baud = 19'200;  ///< SS changes it
};

/// Answers VV PP II BM QT RS TM SS MD MS ME GD GS GE as SCIP 2.0 has it. Its clock is the caller's, from power_on(). A
/// reply that does not fit into `out` whole is lost. No heap, wait-free.
class ScipDevice {
 public:
    explicit ScipDevice(const ScipDeviceParams& params) : params_(params) { power_on({}); }

    /// All forgotten, timer at 0.
    void power_on(Stamp now);
    /// What the host sent; replies are appended to `out`.
    void on_bytes(Bytes bytes, Stamp now, ByteWriter& out);
    /// A revolution is over whose step 0 passed at `step0`: ranges [mm] of step 0, 1, ...; `intensity` may be empty.
    void on_revolution(Stamp step0, std::span<const std::uint32_t> range_mm, std::span<const std::uint32_t> intensity,
                       ByteWriter& out);

    [[nodiscard]] std::uint32_t baud() const { return baud_; }
    [[nodiscard]] bool laser() const { return laser_; }
    [[nodiscard]] bool streaming() const { return streaming_; }
    /// Faults to plant: the laser goes off by itself; the next scan's place is taken by a status.
    void switch_laser_off() { laser_ = false; }
    void plant_status(std::array<std::uint8_t, 2> status) { planted_ = status; }

 private:
    void answer(Bytes line, Stamp now, ByteWriter& out);
    void answer_scip2(Bytes line, Stamp now, ByteWriter& out);
    void answer_timer(Bytes line, Stamp now, ByteWriter& out);
    void answer_scans(Bytes line, const ScipScanRequest& request, ByteWriter& out);
    void put_scan(const ScipScanRequest& request, ByteWriter& out);
    [[nodiscard]] std::uint32_t timer_ms(Stamp now) const;

    ScipDeviceParams params_;
    std::array<std::uint8_t, 64> line_{};
    std::size_t line_size_ = 0;
    bool scip1_ = false;
    bool laser_ = false;
    bool adjust_ = false;
    bool streaming_ = false;
    std::uint32_t baud_ = 0;
    Stamp origin_;
    ScipScanRequest request_;
    std::uint32_t revolution_ = 0;
    ScipRanges latest_;
    std::array<std::uint8_t, 2> planted_{};
};

}  // namespace crspf
