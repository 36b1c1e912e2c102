// Another process's datagrams -> the motion that its odometry measured.
#pragma once

#include <cstdint>
#include <span>

#include "drivers/motion/motion_decoder.hpp"
#include "platform/capture/source_report.hpp"
#include "platform/service/sample_sink.hpp"

namespace crspf {

class MotionInput {
 public:
    void on_data(std::span<const std::uint8_t> payload, Stamp received, SampleSink& sink);

    /// For how long the odometer has measured nothing; 0: it does.
    [[nodiscard]] Duration blind(Stamp now) const;
    [[nodiscard]] SourceCounts counts() const;

 private:
    MotionDecoder decoder_;
};

}  // namespace crspf
