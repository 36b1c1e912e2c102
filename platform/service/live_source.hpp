// A sensor of the robot, heard and answered as long as the process lives.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "config/sources.hpp"
#include "core/base/lidar_params.hpp"
#include "platform/capture/capture_reader.hpp"
#include "platform/ports/byte_stream.hpp"
#include "platform/ports/can_bus.hpp"
#include "platform/ports/datagram_source.hpp"
#include "platform/service/live_report.hpp"
#include "platform/service/sample_sink.hpp"

namespace crspf {

/// Who wants all that passes through a port, as a recording holds it.
class TrafficSink {
 public:
    virtual ~TrafficSink() = default;
    /// @param bytes of a stream, an Ethernet frame, or a CAN frame, as link_of() says. An empty one that was received
    /// marks that a stream was opened.
    virtual void on_traffic(Direction direction, Stamp stamp, std::span<const std::uint8_t> bytes) = 0;
};

/// One thread's.
class LiveSource {
 public:
    virtual ~LiveSource() = default;
    /// Waits for the sensor, at most `wait` and at most 100 ms; tells what it said, first to `traffic`, then to
    /// `samples`; answers it. A loop over it never spins, whatever the sensor does.
    virtual void step(Duration wait, SampleSink& samples, TrafficSink& traffic) = 0;
    /// How it is. No heap.
    [[nodiscard]] virtual LiveReport report() const = 0;
};

/// Of the records that on_traffic() gets.
[[nodiscard]] LinkKind link_of(SourceDriver driver);

/// On the ports of this machine.
[[nodiscard]] std::unique_ptr<LiveSource> open_live(const SourceConfig& source, const LidarParams& lidar);

// On given ports; `source` must be of a driver for these.
[[nodiscard]] std::unique_ptr<LiveSource> open_live(const SourceConfig& source, const LidarParams& lidar,
                                                    std::unique_ptr<ByteStream> port);
[[nodiscard]] std::unique_ptr<LiveSource> open_live(const SourceConfig& source, const LidarParams& lidar,
                                                    std::unique_ptr<DatagramSource> port);
[[nodiscard]] std::unique_ptr<LiveSource> open_live(const SourceConfig& source, const LidarParams& lidar,
                                                    std::unique_ptr<CanBus> port);

}  // namespace crspf
