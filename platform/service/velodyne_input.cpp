#include "platform/service/velodyne_input.hpp"

#include "drivers/common/mounted_scan.hpp"
#include "platform/service/velodyne_calibration.hpp"

namespace crspf {

namespace {

std::optional<VelodyneCalibration> calibration_of(const SourceConfig& source) {
    return source.velodyne_calibration.empty()
               ? std::nullopt
               : std::optional(read_velodyne_calibration(source.velodyne_calibration, source.velodyne.model));
}

}  // namespace

VelodyneInput::VelodyneInput(const SourceConfig& source, const LidarParams& lidar)
    : params_(source.velodyne),
      scan_params_(source.velodyne_scan),
      planar_(source.velodyne_planar),
      lidar_(lidar),
      assembler_(source.velodyne, calibration_of(source)) {}

void VelodyneInput::on_data(std::span<const std::uint8_t> payload, std::uint32_t address, Stamp received,
                            SampleSink& sink) {
    assembler_.on_data(payload, address, received, [&](const VelodyneCloud& cloud) { on_cloud(cloud, sink); });
}

void VelodyneInput::on_cloud(const VelodyneCloud& cloud, SampleSink& sink) {
    if (planar_ == PlanarScan::kObstacles) {
        if (cloud.complete) {
            ++scans_;
            sink.on_cloud(cloud);
        } else {
            ++incomplete_;
        }
        return;
    }
    if (!scanner_ && assembler_.calibration()) {
        scanner_.emplace(scan_params_, params_.model, *assembler_.calibration());
    }
    if (!scanner_ || !scanner_->scan(cloud, params_.cut_rad, scan_)) {
        ++incomplete_;
        return;
    }
    ++scans_;
    mount(scan_, lidar_);
    sink.on_scan(scan_);
}

SourceCounts VelodyneInput::counts() const {
    const VelodyneCounters& c = assembler_.counters();
    return {{"scans", scans_},
            {"packets", c.packets},
            {"lost_packets", c.lost},
            {"late", c.late},
            {"incomplete_revolutions", incomplete_},
            {"breaks", c.breaks},
            {"full", c.full},
            {"foreign", c.foreign},
            {"bad_length", c.bad_length},
            {"bad_flag", c.bad_flag},
            {"bad_azimuth", c.bad_azimuth},
            {"bad_stamp", c.bad_stamp},
            {"bad_mode", c.bad_mode},
            {"other_model", c.bad_model},
            {"without_calibration", c.without_calibration}};
}

}  // namespace crspf
