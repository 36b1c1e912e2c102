// Two cameras that look the same way, as one source of pairs.
#pragma once

#include <memory>

#include "platform/linux/v4l2_camera.hpp"
#include "platform/ports/camera.hpp"

namespace crspf {

/// One device that gives both pictures side by side, the left camera's left.
class SideBySideCamera final : public StereoSource {
 public:
    /// @param params of each picture: the device's are twice as wide
    explicit SideBySideCamera(V4l2Params params, VideoCalls& calls = video_calls());

    [[nodiscard]] StereoPicture receive(Duration wait) override;
    [[nodiscard]] std::string_view problem() const override { return camera_.problem(); }

    [[nodiscard]] const V4l2Counters& counters() const { return camera_.counters(); }

 private:
    V4l2Camera camera_;
};

/// Two devices. Pictures that were taken within half a period of each other are a pair; a robot that moves needs
/// cameras with a common trigger, for which the stamps differ by far less.
class PairedCameras final : public StereoSource {
 public:
    /// @param params of the left one
    PairedCameras(const V4l2Params& params, const std::string& right_device, VideoCalls& calls = video_calls());

    [[nodiscard]] StereoPicture receive(Duration wait) override;
    [[nodiscard]] std::string_view problem() const override { return problem_; }

    [[nodiscard]] const V4l2Counters& left_counters() const { return left_.camera.counters(); }
    [[nodiscard]] const V4l2Counters& right_counters() const { return right_.camera.counters(); }
    /// Pictures without a partner: the other camera's was lost, or came at another time. Never falls.
    [[nodiscard]] std::uint64_t unpaired() const { return unpaired_; }

 private:
    struct Side {
        Side(const V4l2Params& params, VideoCalls& calls) : camera(params, calls) {}

        V4l2Camera camera;
        CameraPicture last;  ///< kOk: waits for its partner
    };

    /// False where there is none yet; `status` says why.
    [[nodiscard]] bool fetch(Side& side, Duration wait, IoStatus& status);

    VideoCalls& calls_;
    Duration half_period_;
    Side left_;
    Side right_;
    std::string problem_;
    std::uint64_t unpaired_ = 0;
};

}  // namespace crspf
