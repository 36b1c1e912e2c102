// What the drivers of lidars on byte streams deliver -> scans as mounted and believed; and their counts. Shared by
// listening (stream_input.hpp) and talking (stream_talk.hpp).
#pragma once

#include <cstdint>

#include "core/base/lidar_params.hpp"
#include "drivers/ldrobot/ld06_listener.hpp"
#include "drivers/scip/scip_listener.hpp"
#include "drivers/sick/lms2xx_listener.hpp"
#include "drivers/sick/sick_listener.hpp"
#include "platform/capture/source_report.hpp"
#include "platform/service/sample_sink.hpp"

namespace crspf {

/// Of drivers that make scans of their own: Hokuyo, LDROBOT.
class MountedScans {
 public:
    explicit MountedScans(const LidarParams& lidar) : lidar_(lidar) {}
    void deliver(const Scan& scan, SampleSink& sink);

 private:
    LidarParams lidar_;
    Scan scan_;
};

class SickScans {
 public:
    explicit SickScans(const LidarParams& lidar) : lidar_(lidar) {}
    void deliver(const LmdScandata& data, const SickTiming& timing, SampleSink& sink);
    /// Telegrams of no or too many distances.
    [[nodiscard]] std::uint64_t unusable() const { return unusable_; }

 private:
    LidarParams lidar_;
    SickClock clock_;
    Scan scan_;
    std::uint64_t unusable_ = 0;
};

class Lms2xxScans {
 public:
    Lms2xxScans(const Lms2xxParams& params, const LidarParams& lidar) : params_(params), lidar_(lidar) {}
    void deliver(const Lms2xxScan& raw, Stamp beam0, SampleSink& sink);

 private:
    Lms2xxParams params_;
    LidarParams lidar_;
    Scan scan_;
};

[[nodiscard]] SourceCounts counts_of(const ScipListener& listener);
[[nodiscard]] SourceCounts counts_of(const SickListener& listener);
[[nodiscard]] SourceCounts counts_of(const Lms2xxListener& listener);
[[nodiscard]] SourceCounts counts_of(const Ld06Listener& listener);

}  // namespace crspf
