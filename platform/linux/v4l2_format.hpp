// What a camera of Linux (V4L2) is asked to give, and what it grants.
// Source: linux/videodev2.h. Ordinary code, for opening; not for real-time threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "platform/linux/video_calls.hpp"

namespace crspf {

struct V4l2Params {
    std::string device;  ///< "/dev/video0", better a name below /dev/v4l/by-id
    std::uint32_t width_px = 640;
    std::uint32_t height_px = 480;
    double rate_hz = 15.0;
};

struct V4l2Format {
    std::uint32_t width_px = 0;
    std::uint32_t height_px = 0;
    std::size_t stride = 0;         ///< [bytes] from a row to the next
    std::size_t step = 1;           ///< [bytes] from a pixel's brightness to the next one's
    std::size_t first = 0;          ///< [bytes] before the first pixel's
    double rate_hz = 0.0;           ///< as granted; 0: the camera does not tell
    std::size_t picture_bytes = 0;  ///< up to the end of the last row
};

/// Of an open descriptor. Uncompressed brightness only: GREY, YUYV or UYVY, whichever of them has the size. The rate is
/// the nearest that the camera has.
/// Empty, or "reason; remedy" with `error` as errno: no camera, taken by another program, a size or format it has not
/// got (those it has are listed).
[[nodiscard]] std::string set_v4l2_format(VideoCalls& calls, int fd, const V4l2Params& params, V4l2Format& format,
                                          int& error);

/// "reason; remedy" of a device that cannot be opened.
[[nodiscard]] std::string why_not_opened(int error);

}  // namespace crspf
