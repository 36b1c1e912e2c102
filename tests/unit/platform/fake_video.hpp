// A kernel with cameras that do as a test says. Time passes only while somebody waits for a picture.
#pragma once

#include <fcntl.h>
#include <linux/videodev2.h>
#include <poll.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "platform/linux/video_calls.hpp"

namespace crspf::test {

struct FakeShot {
    std::uint32_t sequence = 0;
    Stamp arrival;                   ///< when it can be fetched
    Stamp stamp;                     ///< as the driver has it
    bool damaged = false;            ///< V4L2_BUF_FLAG_ERROR
    std::uint32_t missing = 0;       ///< [bytes] at its end
    bool monotonic = true;           ///< the stamp is
    int error = 0;                   ///< instead of it: fetching fails
    std::uint32_t index_offset = 0;  ///< a driver that names a buffer there is not
};

struct FakeFormat {
    std::uint32_t code = V4L2_PIX_FMT_GREY;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sizes{{64, 48}};
    bool stepwise = false;            ///< two sizes: from, to
    std::uint32_t padding_bytes = 0;  ///< at the end of each row
    std::uint32_t field = V4L2_FIELD_NONE;
};

struct FakeCamera {
    int open_error = 0;
    std::map<unsigned long, int> refuses;  ///< errno by request
    std::uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
    std::vector<FakeFormat> formats{{}};
    std::uint32_t buffer_limit = 32;
    std::uint32_t buffer_bytes = 0;  ///< 0: as the pictures need
    std::deque<FakeShot> shots;
    bool unplugged = false;  ///< while it is open

    std::uint32_t asked_rate_mhz = 0;
    int opened = 0;
    std::uint32_t most_queued = 0;

    // While it is open.
    const FakeFormat* format = nullptr;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::vector<std::vector<std::uint8_t>> buffers;
    std::deque<std::uint32_t> queued;
    bool streaming = false;

    [[nodiscard]] std::uint32_t step() const { return format->code == V4L2_PIX_FMT_GREY ? 1 : 2; }
    [[nodiscard]] std::uint32_t stride() const { return width * step() + format->padding_bytes; }

    /// A picture every `period` from `first` on, fetched 2 ms after it was taken.
    void shoot(int count, Stamp first, Duration period, std::uint32_t sequence = 0) {
        for (int i = 0; i < count; ++i) {
            const Stamp stamp = first + Duration{i * period.ns};
            shots.push_back({.sequence = sequence++, .arrival = stamp + Duration{2'000'000}, .stamp = stamp});
        }
    }
};

/// What the pixel of a picture is.
inline std::uint8_t brightness(std::size_t x, std::size_t y, std::uint32_t sequence) {
    return static_cast<std::uint8_t>((5 * x + 3 * y + std::size_t{7} * sequence) & 0xFFU);
}

// NOLINTBEGIN(cppcoreguidelines-pro-type-union-access): the kernel's structs, each with the member that its type names

class FakeVideo final : public VideoCalls {
 public:
    std::map<std::string, FakeCamera> cameras;
    Stamp time{1'000'000'000};
    int mapped = 0;

    UniqueFd open(const std::string& path) override {
        const auto found = cameras.find(path);
        if (found == cameras.end()) {
            errno = ENOENT;
            return UniqueFd();
        }
        if (found->second.open_error != 0) {
            errno = found->second.open_error;
            return UniqueFd();
        }
        UniqueFd fd(::open("/dev/null", O_RDONLY | O_CLOEXEC));  // so that the number is taken
        FakeCamera& camera = found->second;
        ++camera.opened;
        camera.buffers.clear();
        camera.queued.clear();
        camera.streaming = false;
        open_[fd.get()] = &camera;
        return fd;
    }

    int ioctl(int fd, unsigned long request, void* argument) override {
        FakeCamera& camera = *open_.at(fd);
        int error = camera.unplugged ? ENODEV : 0;
        if (error == 0 && camera.refuses.contains(request)) {
            error = camera.refuses.at(request);
        }
        if (error == 0) {
            error = answer(camera, request, argument);
        }
        errno = error;
        return error == 0 ? 0 : -1;
    }

    std::uint8_t* map(int fd, std::size_t bytes, std::uint32_t offset) override {
        std::vector<std::uint8_t>& buffer = open_.at(fd)->buffers.at(offset);
        REQUIRE(buffer.size() == bytes);
        ++mapped;
        return buffer.data();
    }
    void unmap(std::uint8_t* /*begin*/, std::size_t /*bytes*/) override { --mapped; }

    short poll(int fd, Duration wait) override {
        const FakeCamera& camera = *open_.at(fd);
        REQUIRE(camera.streaming);
        if (camera.unplugged) {
            return POLLIN | POLLERR;
        }
        const Stamp until = time + std::max(wait, Duration{});
        if (camera.shots.empty() || camera.shots.front().arrival > until) {
            time = until;
            return 0;
        }
        time = std::max(time, camera.shots.front().arrival);
        return POLLIN;
    }
    Stamp now() override { return time; }

 private:
    template <typename T>
    static T& as(void* argument) {
        return *static_cast<T*>(argument);
    }

    int answer(FakeCamera& camera, unsigned long request, void* argument) {
        switch (request) {
            case VIDIOC_QUERYCAP:
                as<v4l2_capability>(argument).capabilities = 0xFFFFFFFFU;  // of all the device's nodes together
                as<v4l2_capability>(argument).device_caps = camera.capabilities;
                return 0;
            case VIDIOC_ENUM_FMT: return enumerate(camera, as<v4l2_fmtdesc>(argument));
            case VIDIOC_ENUM_FRAMESIZES: return enumerate(camera, as<v4l2_frmsizeenum>(argument));
            case VIDIOC_S_FMT: return set(camera, as<v4l2_format>(argument).fmt.pix);
            case VIDIOC_S_PARM: {
                v4l2_fract& period = as<v4l2_streamparm>(argument).parm.capture.timeperframe;
                camera.asked_rate_mhz = 1000 * period.denominator / period.numerator;
                period = {1, 30};
                return 0;
            }
            case VIDIOC_REQBUFS: return make(camera, as<v4l2_requestbuffers>(argument));
            case VIDIOC_QUERYBUF: {
                auto& buffer = as<v4l2_buffer>(argument);
                buffer.length = static_cast<std::uint32_t>(camera.buffers.at(buffer.index).size());
                buffer.m.offset = buffer.index;
                return 0;
            }
            case VIDIOC_QBUF: {
                const std::uint32_t index = as<v4l2_buffer>(argument).index;
                REQUIRE(index < camera.buffers.size());
                REQUIRE(std::count(camera.queued.begin(), camera.queued.end(), index) == 0);
                camera.queued.push_back(index);
                camera.most_queued = std::max(camera.most_queued, static_cast<std::uint32_t>(camera.queued.size()));
                return 0;
            }
            case VIDIOC_STREAMON: camera.streaming = true; return 0;
            case VIDIOC_DQBUF: return fetch(camera, as<v4l2_buffer>(argument));
            default: return ENOTTY;
        }
    }

    static int enumerate(const FakeCamera& camera, v4l2_fmtdesc& description) {
        if (description.index >= camera.formats.size()) {
            return EINVAL;
        }
        description.pixelformat = camera.formats[description.index].code;
        return 0;
    }

    static const FakeFormat& format_of(const FakeCamera& camera, std::uint32_t code) {
        const auto found = std::find_if(camera.formats.begin(), camera.formats.end(),
                                        [&](const FakeFormat& format) { return format.code == code; });
        REQUIRE(found != camera.formats.end());
        return *found;
    }

    static int enumerate(const FakeCamera& camera, v4l2_frmsizeenum& size) {
        const FakeFormat& format = format_of(camera, size.pixel_format);
        if (size.index >= (format.stepwise ? 1 : format.sizes.size())) {
            return EINVAL;
        }
        if (format.stepwise) {
            size.type = V4L2_FRMSIZE_TYPE_STEPWISE;
            size.stepwise = {.min_width = format.sizes[0].first,
                             .max_width = format.sizes[1].first,
                             .step_width = 1,
                             .min_height = format.sizes[0].second,
                             .max_height = format.sizes[1].second,
                             .step_height = 1};
        } else {
            size.type = V4L2_FRMSIZE_TYPE_DISCRETE;
            size.discrete = {.width = format.sizes[size.index].first, .height = format.sizes[size.index].second};
        }
        return 0;
    }

    /// Grants the last size where it has not the one that is wanted, as drivers do.
    static int set(FakeCamera& camera, v4l2_pix_format& pix) {
        camera.format = &format_of(camera, pix.pixelformat);
        const auto& sizes = camera.format->sizes;
        const auto found = std::find(sizes.begin(), sizes.end(), std::pair{pix.width, pix.height});
        const auto [width, height] = found != sizes.end() ? *found : sizes.back();
        camera.width = pix.width = width;
        camera.height = pix.height = height;
        pix.bytesperline = camera.stride();
        pix.sizeimage = camera.stride() * height;
        pix.field = camera.format->field;
        return 0;
    }

    static int make(FakeCamera& camera, v4l2_requestbuffers& request) {
        request.count = std::min(request.count, camera.buffer_limit);
        const std::size_t bytes = camera.buffer_bytes != 0 ? camera.buffer_bytes : camera.stride() * camera.height;
        camera.buffers.assign(request.count, std::vector<std::uint8_t>(bytes));
        return 0;
    }

    int fetch(FakeCamera& camera, v4l2_buffer& buffer) const {
        if (camera.shots.empty() || camera.shots.front().arrival > time || camera.queued.empty()) {
            return EAGAIN;
        }
        const FakeShot shot = camera.shots.front();
        camera.shots.pop_front();
        if (shot.error != 0) {
            return shot.error;
        }
        const std::uint32_t index = camera.queued.front();
        camera.queued.pop_front();
        std::vector<std::uint8_t>& bytes = camera.buffers[index];
        std::fill(bytes.begin(), bytes.end(), std::uint8_t{0xAA});
        const std::size_t first = camera.format->code == V4L2_PIX_FMT_UYVY ? 1 : 0;
        for (std::size_t y = 0; y < camera.height; ++y) {
            for (std::size_t x = 0; x < camera.width; ++x) {
                bytes.at(y * camera.stride() + first + x * camera.step()) = brightness(x, y, shot.sequence);
            }
        }
        buffer.index = index + shot.index_offset;
        buffer.sequence = shot.sequence;
        buffer.bytesused = static_cast<std::uint32_t>(bytes.size()) - shot.missing;
        buffer.flags = (shot.damaged ? V4L2_BUF_FLAG_ERROR : 0U) |
                       (shot.monotonic ? V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC : V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN);
        buffer.timestamp = {.tv_sec = static_cast<std::int32_t>(shot.stamp.ns / 1'000'000'000),
                            .tv_usec = static_cast<std::int32_t>(shot.stamp.ns % 1'000'000'000 / 1000)};
        return 0;
    }

    std::map<int, FakeCamera*> open_;
};

// NOLINTEND(cppcoreguidelines-pro-type-union-access)

}  // namespace crspf::test
