// How one thread wakes another.
#pragma once

#include <semaphore.h>

#include <atomic>

#include "core/base/time.hpp"

namespace crspf {

/// Any number of notifiers, one waiter. A notification that comes before the wait is not lost; several are one.
/// notify(): no heap, no throw, no lock that the waiter could hold.
class Wakeup {
 public:
    Wakeup() { ::sem_init(&semaphore_, 0, 0); }
    Wakeup(const Wakeup&) = delete;
    Wakeup& operator=(const Wakeup&) = delete;
    ~Wakeup() { ::sem_destroy(&semaphore_); }

    void notify() {
        // Release, with the acquire of wait_until(): the waiter sees what was done before.
        if (!pending_.exchange(true, std::memory_order_acq_rel)) {
            ::sem_post(&semaphore_);
        }
    }
    /// Waits for a notification, at most until `deadline` on the monotonic clock. False: none came.
    bool wait_until(Stamp deadline);

 private:
    sem_t semaphore_{};
    std::atomic<bool> pending_{false};
};

}  // namespace crspf
