#include "platform/linux/stereo_camera.hpp"

#include <algorithm>
#include <utility>

namespace crspf {
namespace {

V4l2Params twice_as_wide(V4l2Params params) {
    params.width_px *= 2;
    return params;
}

V4l2Params of_device(V4l2Params params, const std::string& device) {
    params.device = device;
    return params;
}

Duration absolute(Duration d) {
    return {d.ns < 0 ? -d.ns : d.ns};
}

}  // namespace

SideBySideCamera::SideBySideCamera(V4l2Params params, VideoCalls& calls)
    : camera_(twice_as_wide(std::move(params)), calls) {}

StereoPicture SideBySideCamera::receive(Duration wait) {
    const CameraPicture both = camera_.receive(wait);
    StereoPicture out{.io = both.io, .pair = {.left = both.picture, .right = both.picture}};
    if (both.io.status == IoStatus::kOk) {
        const int width = both.picture.width / 2;
        out.pair.left.width = width;
        out.pair.right.width = width;
        out.pair.right.pixels += width;
    }
    return out;
}

PairedCameras::PairedCameras(const V4l2Params& params, const std::string& right_device, VideoCalls& calls)
    : calls_(calls),
      half_period_(Duration::from_seconds(0.5 / params.rate_hz)),
      left_(params, calls),
      right_(of_device(params, right_device), calls) {}

bool PairedCameras::fetch(Side& side, Duration wait, IoStatus& status) {
    if (side.last.io.status == IoStatus::kOk) {
        return true;
    }
    side.last = side.camera.receive(std::max(wait, Duration{}));
    status = side.last.io.status;
    if (status == IoStatus::kClosed) {
        problem_ = side.camera.problem();
    }
    return status == IoStatus::kOk;
}

StereoPicture PairedCameras::receive(Duration wait) {
    const Stamp deadline = calls_.now() + wait;
    // What the caller had is no longer his.
    if (left_.last.io.status == IoStatus::kOk && right_.last.io.status == IoStatus::kOk) {
        left_.last = {};
        right_.last = {};
    }
    do {
        IoStatus status = IoStatus::kRetry;
        if (!fetch(left_, deadline - calls_.now(), status) || !fetch(right_, deadline - calls_.now(), status)) {
            return {.io = {.status = status}, .pair = {}};
        }
        const Received& left = left_.last.io;
        const Received& right = right_.last.io;
        if (absolute(left.stamp - right.stamp) <= half_period_) {
            return {.io = {.status = IoStatus::kOk,
                           .bytes = left.bytes + right.bytes,
                           .stamp = left.stamp,
                           .dropped = std::max(left.dropped, right.dropped)},
                    .pair = {.left = left_.last.picture, .right = right_.last.picture}};
        }
        ++unpaired_;
        (left.stamp < right.stamp ? left_ : right_).last = {};
    } while (calls_.now() < deadline);
    return {};
}

}  // namespace crspf
