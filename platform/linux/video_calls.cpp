#include "platform/linux/video_calls.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>

#include <cerrno>

#include "platform/linux/monotonic_clock.hpp"

namespace crspf {
namespace {

class KernelCalls final : public VideoCalls {
 public:
    UniqueFd open(const std::string& path) override {
        return UniqueFd(::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
    }
    int ioctl(int fd, unsigned long request, void* argument) override {
        int result = 0;
        do {
            result = ::ioctl(fd, request, argument);
        } while (result < 0 && errno == EINTR);
        return result;
    }
    std::uint8_t* map(int fd, std::size_t bytes, std::uint32_t offset) override {
        void* const begin = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, static_cast<off_t>(offset));
        return begin == MAP_FAILED ? nullptr : static_cast<std::uint8_t*>(begin);
    }
    void unmap(std::uint8_t* begin, std::size_t bytes) override { ::munmap(begin, bytes); }
    short poll(int fd, Duration wait) override { return wait_for(fd, POLLIN, wait); }
    Stamp now() override { return monotonic_now(); }
};

}  // namespace

VideoCalls& video_calls() {
    static KernelCalls calls;
    return calls;
}

}  // namespace crspf
