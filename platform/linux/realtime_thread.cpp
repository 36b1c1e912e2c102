#include "platform/linux/realtime_thread.hpp"

#include <sched.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <utility>

namespace crspf {

namespace {

/// A stack that is touched for the first time in the middle of a scan costs a page fault there.
[[gnu::noinline]] void touch_stack() {
    std::array<volatile char, RealtimeThread::kTouchedBytes> stack{};
    constexpr std::size_t kPage = 4096;
    for (std::size_t i = 0; i < stack.size(); i += kPage) {
        stack[i] = 0;
    }
}

class Attributes {
 public:
    Attributes() { ::pthread_attr_init(&attributes_); }
    Attributes(const Attributes&) = delete;
    Attributes& operator=(const Attributes&) = delete;
    ~Attributes() { ::pthread_attr_destroy(&attributes_); }

    int set(const ThreadParams& params) {
        int error = ::pthread_attr_setstacksize(&attributes_, RealtimeThread::kStackBytes);
        if (error == 0 && params.priority > 0) {
            const sched_param priority{.sched_priority = params.priority};
            error = ::pthread_attr_setinheritsched(&attributes_, PTHREAD_EXPLICIT_SCHED);
            error = error != 0 ? error : ::pthread_attr_setschedpolicy(&attributes_, SCHED_FIFO);
            error = error != 0 ? error : ::pthread_attr_setschedparam(&attributes_, &priority);
        }
        if (error == 0 && !params.cpus.empty()) {
            cpu_set_t cpus;
            CPU_ZERO(&cpus);
            for (const std::uint32_t cpu : params.cpus) {
                if (cpu >= CPU_SETSIZE) {
                    return EINVAL;
                }
                CPU_SET(cpu, &cpus);
            }
            error = ::pthread_attr_setaffinity_np(&attributes_, sizeof cpus, &cpus);
        }
        return error;
    }
    [[nodiscard]] const pthread_attr_t* get() const { return &attributes_; }

 private:
    pthread_attr_t attributes_{};
};

}  // namespace

int lock_memory() {
    return ::mlockall(MCL_CURRENT | MCL_FUTURE) == 0 ? 0 : errno;
}

int RealtimeThread::start(const ThreadParams& params, std::function<void(const std::atomic<bool>& stop)> body) {
    body_ = std::move(body);
    name_ = params.name;
    Attributes attributes;
    int error = attributes.set(params);
    error = error != 0 ? error : ::pthread_create(&thread_, attributes.get(), run, this);
    running_ = error == 0;
    return error;
}

void RealtimeThread::join() {
    request_stop();
    if (std::exchange(running_, false)) {
        ::pthread_join(thread_, nullptr);
    }
}

void* RealtimeThread::run(void* self) {
    auto& thread = *static_cast<RealtimeThread*>(self);
    ::pthread_setname_np(::pthread_self(), thread.name_.c_str());
    thread.thread_id_.store(::gettid(), std::memory_order_relaxed);
    touch_stack();
    thread.body_(thread.stop_);
    return nullptr;
}

}  // namespace crspf
