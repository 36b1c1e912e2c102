#include "platform/linux/wakeup.hpp"

#include <cerrno>
#include <ctime>

#include "platform/linux/monotonic_clock.hpp"

namespace crspf {

bool Wakeup::wait_until(Stamp deadline) {
    const timespec until = timespec_of(deadline);
    int result = 0;
    do {
        result = ::sem_clockwait(&semaphore_, CLOCK_MONOTONIC, &until);
    } while (result != 0 && errno == EINTR);
    return result == 0 && pending_.exchange(false, std::memory_order_acq_rel);
}

}  // namespace crspf
