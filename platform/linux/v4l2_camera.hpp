// A camera of Linux (V4L2), as USB cameras are.
// Source: linux/videodev2.h and the kernel's "Video for Linux API", streaming by memory mapping.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "platform/files/gray_png.hpp"
#include "platform/linux/reopening_fd.hpp"
#include "platform/linux/v4l2_format.hpp"
#include "platform/ports/camera.hpp"

namespace crspf {

/// Counters never fall.
struct V4l2Counters {
    std::uint64_t received = 0;
    std::uint64_t dropped = 0;  ///< missing from the driver's count: nobody fetched them in time, or the bus lost them
    std::uint64_t damaged = 0;  ///< that the driver marked so, or that were not whole
    std::uint64_t host_stamped = 0;  ///< received, but without a credible stamp of the driver's: they bear the host's
};

/// Need not be there at first, and may be unplugged and plugged in again, or hang: receive() opens it. One thread's.
class V4l2Camera {
 public:
    explicit V4l2Camera(V4l2Params params, VideoCalls& calls = video_calls())
        : params_(std::move(params)), calls_(calls) {}
    V4l2Camera(const V4l2Camera&) = delete;
    V4l2Camera& operator=(const V4l2Camera&) = delete;
    ~V4l2Camera();

    /// One picture, after waiting up to `wait` for it. Does not allocate but to open the camera, nor spin in a loop
    /// with a wait.
    [[nodiscard]] CameraPicture receive(Duration wait);

    [[nodiscard]] const V4l2Counters& counters() const { return counters_; }
    /// [Hz] as the camera granted it; 0 while it is closed, and where it does not tell.
    [[nodiscard]] double rate_hz() const { return fd_.is_open() ? format_.rate_hz : 0.0; }
    /// errno of why it is closed; EBUSY: another program has it.
    [[nodiscard]] int error() const { return fd_.error(); }
    /// "DEVICE: reason; remedy" of why it is closed; empty: nothing went wrong yet.
    [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
    static constexpr std::uint32_t kBuffers = 4;  ///< asked for; drivers grant more or less
    static constexpr std::uint32_t kNone = 0xFFFFFFFF;
    /// A driver's stamp that is older is of a clock gone astray.
    static constexpr Duration kOldest{2'000'000'000};
    /// An open camera that gives nothing for so long is opened anew: USB cameras hang.
    static constexpr Duration kSilence{3'000'000'000};

    struct Buffer {
        std::uint8_t* begin = nullptr;
        std::size_t bytes = 0;
    };
    /// What a buffer came with.
    struct Filled {
        std::uint32_t index = kNone;
        std::uint32_t sequence = 0;
        bool whole = false;
        bool stamped = false;
        Stamp stamp;
    };

    bool open(Duration wait);
    [[nodiscard]] bool start(int fd, int& error);
    [[nodiscard]] int map_buffer(int fd, std::uint32_t index);
    [[nodiscard]] int give_back(int fd, std::uint32_t index);
    [[nodiscard]] int take(Filled& filled);
    [[nodiscard]] CameraPicture picture_of(const Filled& filled);
    void count_gap(std::uint32_t sequence);
    void unmap();
    CameraPicture lose(int error);

    V4l2Params params_;
    VideoCalls& calls_;
    ReopeningFd fd_;
    V4l2Format format_;
    std::vector<Buffer> buffers_;
    GrayImage gray_;  ///< of cameras that give colours, too
    V4l2Counters counters_;
    std::string problem_;
    std::uint32_t held_ = kNone;  ///< the buffer whose picture the caller has
    std::uint32_t next_sequence_ = 0;
    Stamp heard_;                ///< when it was opened, or gave something
    bool counting_ = false;      ///< next_sequence_ is known
    std::uint32_t dropped_ = 0;  ///< since the last result
};

}  // namespace crspf
