// The byte stream of a lidar -> scans, by listening only: for recordings, and beneath the conversation of a live one.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "config/sources.hpp"
#include "core/base/lidar_params.hpp"
#include "drivers/scip/scip_listener.hpp"
#include "drivers/sick/lms2xx_listener.hpp"
#include "drivers/sick/sick_listener.hpp"
#include "platform/service/sample_sink.hpp"
#include "platform/service/source_counts.hpp"

namespace crspf {

class StreamInput {
 public:
    virtual ~StreamInput() = default;
    /// The port was opened anew.
    virtual void on_open(Stamp now) = 0;
    /// The host sends something now.
    virtual void on_sent(Stamp now) = 0;
    virtual void on_received(std::span<const std::uint8_t> bytes, Stamp received, SampleSink& sink) = 0;
    [[nodiscard]] virtual SourceCounts counts() const = 0;
};

/// For a source whose driver is kScip, kSick or kLms2xx.
[[nodiscard]] std::unique_ptr<StreamInput> listen_to(const SourceConfig& source, const LidarParams& lidar);

// What a live conversation shares with the listening one: from the driver's scan to ours.

class ScipScans {
 public:
    explicit ScipScans(const LidarParams& lidar) : lidar_(lidar) {}
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

}  // namespace crspf
