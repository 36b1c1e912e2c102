// Sees when the machine itself was late: on each processor a thread above all those of the service sleeps for a
// millisecond at a time. What it oversleeps, a hypervisor, an interrupt or the kernel took, and from the service too.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <list>
#include <mutex>
#include <thread>
#include <vector>

#include "core/base/time.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "platform/linux/realtime_thread.hpp"

namespace crspf::test {

class MachineWatch {
 public:
    static constexpr Duration kLate{500'000};  // half of the service's shortest deadline

    MachineWatch() {
        for (unsigned cpu = 0; cpu < std::thread::hardware_concurrency(); ++cpu) {
            const ThreadParams params{.name = "machine", .priority = 95, .cpus = {cpu}};
            const int error = threads_.emplace_back().start(params, [this](const auto& stop) { watch(stop); });
            refused_ = refused_ || error != 0;
        }
    }
    MachineWatch(const MachineWatch&) = delete;
    MachineWatch& operator=(const MachineWatch&) = delete;
    ~MachineWatch() {
        for (RealtimeThread& thread : threads_) {
            thread.join();
        }
    }

    /// A processor is not watched: no right to SCHED_FIFO, or to that processor.
    [[nodiscard]] bool refused() const { return refused_; }
    /// Some processor was late between the two.
    [[nodiscard]] bool late_within(Stamp begin, Stamp end) const {
        const std::lock_guard lock(mutex_);
        return std::any_of(late_.rbegin(), late_.rend(),
                           [&](const Late& late) { return late.due < end && begin < late.woken; });
    }
    [[nodiscard]] std::size_t times_late() const {
        const std::lock_guard lock(mutex_);
        return late_.size();
    }
    [[nodiscard]] Duration latest() const {
        const std::lock_guard lock(mutex_);
        Duration latest;
        for (const Late& late : late_) {
            latest = std::max(latest, late.woken - late.due);
        }
        return latest;
    }

 private:
    static constexpr Duration kPeriod{1'000'000};

    struct Late {
        Stamp due;
        Stamp woken;
    };

    void watch(const std::atomic<bool>& stop) {
        while (!stop) {
            const Stamp due = monotonic_now() + kPeriod;
            sleep_until(due);
            const Stamp woken = monotonic_now();
            if (woken - due > kLate) {
                const std::lock_guard lock(mutex_);
                late_.push_back({due, woken});
            }
        }
    }

    mutable std::mutex mutex_;
    std::vector<Late> late_;
    std::list<RealtimeThread> threads_;
    bool refused_ = false;
};

}  // namespace crspf::test
