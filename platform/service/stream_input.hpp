// The byte stream of a lidar -> scans, by listening only: for recordings, and beneath the conversation of a live one.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "config/sources.hpp"
#include "core/base/lidar_params.hpp"
#include "platform/capture/source_report.hpp"
#include "platform/service/sample_sink.hpp"

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

/// For a source whose driver is kScip, kSick, kLms2xx or kLd06.
[[nodiscard]] std::unique_ptr<StreamInput> listen_to(const SourceConfig& source, const LidarParams& lidar);

}  // namespace crspf
