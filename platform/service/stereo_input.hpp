// Pairs of pictures -> the motion of the vehicle, by visual odometry.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "config/stereo_config.hpp"
#include "core/base/gray_image.hpp"
#include "platform/capture/source_report.hpp"
#include "platform/files/kitti_poses.hpp"
#include "platform/service/sample_sink.hpp"

namespace crspf {

/// An ordinary thread's. One owner.
class StereoInput {
 public:
    virtual ~StereoInput() = default;

    /// A pair as the cameras gave it, not rectified. The sink gets its motion, and none from a pair of another size
    /// than the calibration's.
    virtual void on_pair(const StereoView& pair, Stamp exposed, SampleSink& sink) = 0;
    /// A record of LinkKind::kStereo: the same, as PNG.
    virtual void on_record(std::span<const std::uint8_t> bytes, Stamp exposed, SampleSink& sink) = 0;

    /// What of the newest pair there is to say: "sees", "no texture" ...
    [[nodiscard]] virtual const char* sight() const = 0;
    [[nodiscard]] virtual SourceCounts counts() const = 0;
    /// The left camera's way, a pose for each pair since the start or since take_path().
    [[nodiscard]] virtual std::vector<KittiPose> take_path() = 0;
};

/// Throws InputError for a calibration that cannot be used, and where the build has no OpenCV.
[[nodiscard]] std::unique_ptr<StereoInput> make_stereo_input(const StereoConfig& config);

}  // namespace crspf
