// The datagrams of a Velodyne sensor -> planar scans of one of its rings, or whole revolutions.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "config/sources.hpp"
#include "core/base/lidar_params.hpp"
#include "drivers/velodyne/velodyne_assembler.hpp"
#include "drivers/velodyne/velodyne_scan.hpp"
#include "platform/capture/source_report.hpp"
#include "platform/service/sample_sink.hpp"

namespace crspf {

/// 4 MiB.
class VelodyneInput {
 public:
    /// Throws InputError for a calibration file that cannot be used.
    VelodyneInput(const SourceConfig& source, const LidarParams& lidar);

    /// A datagram of the data port. @param address IPv4 of its sender, as a number
    void on_data(std::span<const std::uint8_t> payload, std::uint32_t address, Stamp received, SampleSink& sink);
    [[nodiscard]] SourceCounts counts() const;

 private:
    void on_cloud(const VelodyneCloud& cloud, SampleSink& sink);

    VelodyneParams params_;
    VelodyneScanParams scan_params_;
    PlanarScan planar_;
    LidarParams lidar_;
    VelodyneAssembler assembler_;
    std::optional<VelodyneScanner> scanner_;  ///< once the calibration is known
    Scan scan_;
    std::uint64_t scans_ = 0;       ///< or whole revolutions
    std::uint64_t incomplete_ = 0;  ///< revolutions that gave none
};

}  // namespace crspf
