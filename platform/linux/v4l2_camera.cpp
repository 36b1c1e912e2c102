#include "platform/linux/v4l2_camera.hpp"

#include <linux/videodev2.h>
#include <poll.h>

#include <cerrno>
#include <utility>

#include "platform/linux/is_temporary.hpp"

namespace crspf {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::int64_t kMicrosecond_ns = 1000;
constexpr std::uint32_t kBackwards = 0x80000000;

v4l2_buffer buffer_of(std::uint32_t index) {
    v4l2_buffer buffer{};
    buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.index = index;
    return buffer;
}

}  // namespace

V4l2Camera::~V4l2Camera() {
    unmap();
}

void V4l2Camera::unmap() {
    for (const Buffer& buffer : buffers_) {
        calls_.unmap(buffer.begin, buffer.bytes);
    }
    buffers_.clear();
    held_ = kNone;
}

CameraPicture V4l2Camera::lose(int error) {
    unmap();
    fd_.lost(error);
    problem_ = params_.device + ": " + why_not_opened(error);
    return {.io = {.status = IoStatus::kClosed}, .picture = {}};
}

bool V4l2Camera::open(Duration wait) {
    if (fd_.is_open()) {
        return true;
    }
    if (!fd_.may_open(wait)) {
        return false;
    }
    UniqueFd fd = calls_.open(params_.device);
    int error = fd.valid() ? 0 : errno;
    std::string why;
    if (error == 0) {
        why = set_v4l2_format(calls_, fd.get(), params_, format_, error);
        if (why.empty() && start(fd.get(), error)) {
            error = 0;
        }
    }
    if (error != 0) {
        unmap();
        fd_.failed(error);
        problem_ = params_.device + ": " + (why.empty() ? why_not_opened(error) : why);
        return false;
    }
    counting_ = false;
    heard_ = calls_.now();
    fd_.opened(std::move(fd));
    return true;
}

bool V4l2Camera::start(int fd, int& error) {
    if (format_.step != 1) {
        gray_ = GrayImage(static_cast<int>(format_.width_px), static_cast<int>(format_.height_px));
    }
    v4l2_requestbuffers request{};
    request.count = kBuffers;
    request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    request.memory = V4L2_MEMORY_MMAP;
    if (calls_.ioctl(fd, VIDIOC_REQBUFS, &request) < 0) {
        error = errno;
        return false;
    }
    // One is the caller's, one the driver's.
    if (request.count < 2) {
        error = ENOMEM;
        return false;
    }
    for (std::uint32_t i = 0; i < request.count; ++i) {
        error = map_buffer(fd, i);
        error = error == 0 ? give_back(fd, i) : error;
        if (error != 0) {
            return false;
        }
    }
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    error = calls_.ioctl(fd, VIDIOC_STREAMON, &type) < 0 ? errno : 0;
    return error == 0;
}

int V4l2Camera::map_buffer(int fd, std::uint32_t index) {
    v4l2_buffer buffer = buffer_of(index);
    if (calls_.ioctl(fd, VIDIOC_QUERYBUF, &buffer) < 0) {
        return errno;
    }
    if (buffer.length < format_.picture_bytes) {
        return EPROTO;
    }
    const std::uint32_t offset = buffer.m.offset;  // NOLINT(cppcoreguidelines-pro-type-union-access): mapped memory's
    std::uint8_t* const begin = calls_.map(fd, buffer.length, offset);
    if (begin == nullptr) {
        return errno;
    }
    buffers_.push_back({.begin = begin, .bytes = buffer.length});
    return 0;
}

int V4l2Camera::give_back(int fd, std::uint32_t index) {
    v4l2_buffer buffer = buffer_of(index);
    return calls_.ioctl(fd, VIDIOC_QBUF, &buffer) < 0 ? errno : 0;
}

/// 0, or errno.
int V4l2Camera::take(Filled& filled) {
    v4l2_buffer buffer = buffer_of(0);
    if (calls_.ioctl(fd_.get(), VIDIOC_DQBUF, &buffer) < 0) {
        return errno;
    }
    if (buffer.index >= buffers_.size()) {
        return EPROTO;
    }
    filled.index = buffer.index;
    filled.sequence = buffer.sequence;
    filled.whole = (buffer.flags & V4L2_BUF_FLAG_ERROR) == 0 && buffer.bytesused >= format_.picture_bytes;
    filled.stamped = (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
    filled.stamp = {buffer.timestamp.tv_sec * kSecond_ns + buffer.timestamp.tv_usec * kMicrosecond_ns};
    return 0;
}

void V4l2Camera::count_gap(std::uint32_t sequence) {
    const std::uint32_t gap = sequence - next_sequence_;
    if (counting_ && gap < kBackwards) {
        dropped_ += gap;
        counters_.dropped += gap;
    }
    counting_ = true;
    next_sequence_ = sequence + 1;
}

CameraPicture V4l2Camera::picture_of(const Filled& filled) {
    const Stamp now = calls_.now();
    const bool credible = filled.stamped && filled.stamp <= now && now - filled.stamp <= kOldest;
    counters_.host_stamped += credible ? 0 : 1;
    ++counters_.received;
    held_ = filled.index;
    const std::uint8_t* const first = buffers_[filled.index].begin + format_.first;
    CameraPicture out{.io = {.status = IoStatus::kOk,
                             .bytes = format_.picture_bytes,
                             .stamp = credible ? filled.stamp : now,
                             .dropped = std::exchange(dropped_, 0)},
                      .picture = {.pixels = first,
                                  .width = static_cast<int>(format_.width_px),
                                  .height = static_cast<int>(format_.height_px),
                                  .stride = format_.stride}};
    if (format_.step == 1) {
        return out;
    }
    std::uint8_t* to = gray_.pixels.data();
    for (std::size_t y = 0; y < format_.height_px; ++y) {
        const std::uint8_t* from = first + y * format_.stride;
        for (std::size_t x = 0; x < format_.width_px; ++x) {
            *to++ = from[x * format_.step];
        }
    }
    out.picture = gray_.view();
    return out;
}

CameraPicture V4l2Camera::receive(Duration wait) {
    const Stamp deadline = calls_.now() + wait;
    const bool was_open = fd_.is_open();
    if (!open(wait)) {
        return {.io = {.status = IoStatus::kClosed}, .picture = {}};
    }
    if (held_ != kNone) {
        if (const int error = give_back(fd_.get(), std::exchange(held_, kNone)); error != 0) {
            return lose(error);
        }
    }
    // Damaged pictures must not keep the caller beyond its wait: the clock is looked at after each of them.
    Duration left = was_open ? wait : Duration{};  // opening has waited already
    do {
        const short events = calls_.poll(fd_.get(), left);
        const Stamp now = calls_.now();
        if (events == 0) {
            return now - heard_ >= kSilence ? lose(ETIMEDOUT) : CameraPicture{};
        }
        heard_ = now;
        Filled filled;
        if (const int error = take(filled); error != 0) {
            if (is_temporary(error) && events == POLLIN) {
                return {};
            }
            // A camera that was unplugged is readable for ever, and gives nothing.
            return lose(is_temporary(error) ? ENODEV : error);
        }
        count_gap(filled.sequence);
        if (filled.whole) {
            return picture_of(filled);
        }
        ++counters_.damaged;
        if (const int error = give_back(fd_.get(), filled.index); error != 0) {
            return lose(error);
        }
        left = deadline - calls_.now();
    } while (left.ns > 0);
    return {};
}

}  // namespace crspf
