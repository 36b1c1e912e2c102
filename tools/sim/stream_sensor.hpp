// Simulated lidars at the other end of a byte stream, all seen alike by the line between them and their host.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "config/sources.hpp"
#include "core/base/time.hpp"
#include "tools/sim/lidar_model.hpp"

namespace crspf::sim {

/// Times are those of the sensor's own clock, 0 at power-on. What it says goes to the host as soon as it is returned.
class StreamSensor {
 public:
    virtual ~StreamSensor() = default;
    [[nodiscard]] virtual std::string name() const = 0;
    /// The host opened its port.
    virtual void on_connect() = 0;
    [[nodiscard]] virtual std::vector<std::uint8_t> on_bytes(std::span<const std::uint8_t> bytes, Stamp now) = 0;
    /// A sweep of the model's beams is over.
    [[nodiscard]] virtual std::vector<std::uint8_t> on_sweep(Stamp begin, Stamp end, std::span<const int> range_mm) = 0;
};

/// What its source listens to: a Hokuyo that speaks SCIP, a SICK that speaks CoLa in the source's dialect. Its beams
/// look where the model's do. Throws InputError for a model of neither kind, and for one that reaches farther than the
/// protocol counts.
[[nodiscard]] std::unique_ptr<StreamSensor> stream_sensor(const SourceConfig& source, const LidarModel& model);

}  // namespace crspf::sim
