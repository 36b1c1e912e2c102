// The system calls that a camera takes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "core/base/time.hpp"
#include "platform/files/unique_fd.hpp"

namespace crspf {

/// Tests stand in for the kernel here. Each call is the one of its name, and leaves errno as that does.
class VideoCalls {
 public:
    virtual ~VideoCalls() = default;
    /// To read and write, not to wait in.
    [[nodiscard]] virtual UniqueFd open(const std::string& path) = 0;
    [[nodiscard]] virtual int ioctl(int fd, unsigned long request, void* argument) = 0;
    /// Shared memory to read; nullptr where there is none.
    [[nodiscard]] virtual std::uint8_t* map(int fd, std::size_t bytes, std::uint32_t offset) = 0;
    virtual void unmap(std::uint8_t* begin, std::size_t bytes) = 0;
    /// What happened of POLLIN, POLLERR, POLLHUP and POLLNVAL within `wait`; 0: nothing.
    [[nodiscard]] virtual short poll(int fd, Duration wait) = 0;
    /// On the monotonic clock.
    [[nodiscard]] virtual Stamp now() = 0;
};

/// The kernel's own.
[[nodiscard]] VideoCalls& video_calls();

}  // namespace crspf
