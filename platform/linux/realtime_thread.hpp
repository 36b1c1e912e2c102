// A thread that is on time: SCHED_FIFO, its own processors, a stack that is there already.
#pragma once

#include <pthread.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace crspf {

struct ThreadParams {
    std::string name;                 ///< at most 15 characters, as ps and top show it
    int priority = 0;                 ///< of SCHED_FIFO, 1 to 99; 0: an ordinary thread
    std::vector<std::uint32_t> cpus;  ///< it may run on; empty: any
};

/// Memory that is used now and later stays in RAM. @return 0 or errno: EPERM, ENOMEM where RLIMIT_MEMLOCK is too low
int lock_memory();

class RealtimeThread {
 public:
    /// Of the stack, which also holds the thread's own variables of the C library and of sanitizers.
    static constexpr std::size_t kStackBytes = std::size_t{2} << 20U;
    /// Of it, touched before `body` begins.
    static constexpr std::size_t kTouchedBytes = std::size_t{256} << 10U;

    RealtimeThread() = default;
    RealtimeThread(const RealtimeThread&) = delete;
    RealtimeThread& operator=(const RealtimeThread&) = delete;
    ~RealtimeThread() { join(); }

    /// Starts `body`, which must return soon after `stop` becomes true. Only once.
    /// @return 0 or errno of what cannot be had: EPERM for the priority, EINVAL for processors that are not there. The
    /// thread does not run then.
    int start(const ThreadParams& params, std::function<void(const std::atomic<bool>& stop)> body);
    void request_stop() { stop_.store(true, std::memory_order_relaxed); }
    /// request_stop() and wait for the end.
    void join();

    /// As the kernel numbers it, for /proc/self/task; 0 before it runs.
    [[nodiscard]] int thread_id() const { return thread_id_.load(std::memory_order_relaxed); }

 private:
    static void* run(void* self);

    std::function<void(const std::atomic<bool>&)> body_;
    std::string name_;
    std::atomic<bool> stop_{false};
    std::atomic<int> thread_id_{0};
    pthread_t thread_{};
    bool running_ = false;
};

}  // namespace crspf
