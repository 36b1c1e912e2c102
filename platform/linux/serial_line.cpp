#include "platform/linux/serial_line.hpp"

#include <asm/termbits.h>
#include <linux/serial.h>
#include <sys/file.h>
#include <sys/ioctl.h>

#include <cerrno>

namespace crspf {
namespace {

bool is_near(std::uint32_t got, std::uint32_t wanted) {
    const std::uint64_t difference = got > wanted ? got - wanted : wanted - got;
    return difference * 100 <= std::uint64_t{wanted} * 3;
}

}  // namespace

int set_serial_line(int fd, std::uint32_t baud) {
    struct termios2 line {};
    if (::ioctl(fd, TCGETS2, &line) != 0) {
        return errno;
    }
    line.c_iflag = IGNBRK | IGNPAR;
    line.c_oflag = 0;
    line.c_lflag = 0;
    line.c_cflag = CS8 | CREAD | CLOCAL | BOTHER;
    line.c_ispeed = baud;
    line.c_ospeed = baud;
    // With one byte at least, a read of none can only mean that the line is gone.
    line.c_cc[VMIN] = 1;
    line.c_cc[VTIME] = 0;
    if (::ioctl(fd, TCSETSW2, &line) != 0 || ::ioctl(fd, TCGETS2, &line) != 0) {
        return errno;
    }
    return is_near(line.c_ospeed, baud) ? 0 : EINVAL;
}

int claim_serial_line(int fd) {
    // TIOCEXCL keeps out other users, the lock keeps out root's second instance of us.
    if (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
        return errno == EWOULDBLOCK ? EBUSY : errno;
    }
    if (::ioctl(fd, TIOCEXCL) != 0) {
        return errno;
    }
    struct serial_struct serial {};
    if (::ioctl(fd, TIOCGSERIAL, &serial) == 0) {
        serial.flags = static_cast<int>(static_cast<unsigned>(serial.flags) | unsigned{ASYNC_LOW_LATENCY});
        static_cast<void>(::ioctl(fd, TIOCSSERIAL, &serial));  // not every driver can, and it works without
    }
    static_cast<void>(::ioctl(fd, TCFLSH, TCIOFLUSH));
    return 0;
}

void release_serial_line(int fd) {
    static_cast<void>(::ioctl(fd, TIOCNXCL));  // an unplugged one has nothing to release
}

}  // namespace crspf
