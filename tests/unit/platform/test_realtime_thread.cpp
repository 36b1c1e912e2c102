#include <sched.h>
#include <unistd.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <cerrno>
#include <fstream>
#include <string>
#include <thread>

#include "platform/linux/monotonic_clock.hpp"
#include "platform/linux/realtime_thread.hpp"
#include "platform/linux/wakeup.hpp"

using namespace crspf;

TEST_CASE("thread: runs with its name until it is stopped") {
    RealtimeThread thread;
    std::atomic<int> turns{0};
    REQUIRE(thread.start({.name = "crspf-test", .priority = 0, .cpus = {}}, [&turns](const std::atomic<bool>& stop) {
        while (!stop) {
            ++turns;
            sleep_until(monotonic_now() + Duration{1'000'000});
        }
    }) == 0);
    while (turns < 3) {
        std::this_thread::yield();
    }
    std::ifstream name("/proc/self/task/" + std::to_string(thread.thread_id()) + "/comm");
    std::string text;
    std::getline(name, text);
    CHECK(text == "crspf-test");
    thread.join();
    const int before = turns;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    CHECK(turns == before);
}

TEST_CASE("thread: has the priority and the processor it was given, or says why not") {
    RealtimeThread thread;
    std::atomic<int> policy{-1};
    std::atomic<int> priority{-1};
    std::atomic<int> cpus{-1};
    const int error =
        thread.start({.name = "fifo", .priority = 7, .cpus = {0}}, [&](const std::atomic<bool>& /*stop*/) {
            sched_param param{};
            int what = 0;
            ::pthread_getschedparam(::pthread_self(), &what, &param);
            policy = what;
            priority = param.sched_priority;
            cpu_set_t set;
            ::sched_getaffinity(0, sizeof set, &set);
            cpus = CPU_COUNT(&set);
        });
    if (error == EPERM) {
        WARN("skipped: this user may not use SCHED_FIFO");
        return;
    }
    REQUIRE(error == 0);
    thread.join();
    CHECK(policy == SCHED_FIFO);
    CHECK(priority == 7);
    CHECK(cpus == 1);
}

TEST_CASE("thread: a processor that is not there is an error") {
    RealtimeThread thread;
    CHECK(thread.start({.name = "x", .priority = 0, .cpus = {1000}}, [](const std::atomic<bool>&) {}) == EINVAL);
    CHECK(thread.start({.name = "x", .priority = 0, .cpus = {5000}}, [](const std::atomic<bool>&) {}) == EINVAL);
}

TEST_CASE("wakeup: a notification is not lost, several are one, and none is a timeout") {
    Wakeup wakeup;
    const auto soon = [] { return monotonic_now() + Duration{2'000'000}; };
    CHECK_FALSE(wakeup.wait_until(soon()));
    wakeup.notify();
    wakeup.notify();
    CHECK(wakeup.wait_until(soon()));
    CHECK_FALSE(wakeup.wait_until(soon()));
    CHECK_FALSE(wakeup.wait_until(Stamp{}));  // long ago
}

TEST_CASE("wakeup: whoever waits is woken, every time") {
    Wakeup there;
    Wakeup back;
    constexpr int kRounds = 2000;
    std::jthread other([&] {
        for (int i = 0; i < kRounds; ++i) {
            if (there.wait_until(monotonic_now() + Duration{5'000'000'000})) {
                back.notify();
            }
        }
    });
    int answers = 0;
    for (int i = 0; i < kRounds; ++i) {
        there.notify();
        answers += back.wait_until(monotonic_now() + Duration{5'000'000'000}) ? 1 : 0;
    }
    CHECK(answers == kRounds);
}
