// Cameras, as their owner sees them.
#pragma once

#include <string_view>

#include "core/base/gray_image.hpp"
#include "platform/ports/io_result.hpp"

namespace crspf {

struct CameraPicture {
    Received io;       ///< stamp: of the exposure where the system tells it
    GrayView picture;  ///< valid until the next call
};

struct StereoPicture {
    Received io;      ///< stamp: that of the left picture
    StereoView pair;  ///< valid until the next call
};

/// One thread's. No call throws or waits longer than it is told to, nor allocates but to open a camera; a loop over
/// receive() with a wait never spins.
class StereoSource {
 public:
    virtual ~StereoSource() = default;
    /// One pair, after waiting up to `wait` for it. Each loss of a camera is told at least once; it opens itself again.
    [[nodiscard]] virtual StereoPicture receive(Duration wait) = 0;
    /// "DEVICE: reason; remedy" of why it is closed; empty: nothing went wrong yet.
    [[nodiscard]] virtual std::string_view problem() const = 0;
};

}  // namespace crspf
