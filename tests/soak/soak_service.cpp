// Runs the whole service on the simulated robot in real time, and says what its threads took: latencies, deadlines
// missed (and how many of them while the machine itself was late), heap calls, page faults, memory. Status 1 where what
// must not happen did.
#include <sched.h>
#include <sys/mman.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <thread>

#include "platform/crspfd/thread_health.hpp"
#include "tests/soak/machine_watch.hpp"
#include "tests/support/heap_guard.hpp"
#include "tests/support/resident.hpp"
#include "tests/support/service_bench.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

struct Faults {
    std::uint64_t minor = 0;
    std::uint64_t major = 0;
};

/// Of a thread of this process, since its beginning.
Faults faults_of(int thread) {
    std::ifstream stat("/proc/self/task/" + std::to_string(thread) + "/stat");
    stat.ignore(std::numeric_limits<std::streamsize>::max(), ')');  // behind its name
    std::string skipped;
    for (int field = 3; field < 10; ++field) {  // proc(5) counts from 1
        stat >> skipped;
    }
    Faults faults;
    stat >> faults.minor >> skipped >> faults.major;
    return faults;
}

/// Control: a thread that touches a page which memory has just given up has a fault, and it is seen.
bool sees_faults() {
    const auto size = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
    std::uint64_t seen = 0;
    std::thread([&seen, size] {
        void* const page = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        ::munlock(page, size);
        ::madvise(page, size, MADV_DONTNEED);
        const std::uint64_t before = faults_of(::gettid()).minor;
        *static_cast<volatile char*>(page) = 1;
        seen = faults_of(::gettid()).minor - before;
        ::munmap(page, size);
    }).join();
    if (seen == 0) {
        std::puts("page faults of threads cannot be read here");
    }
    return seen > 0;
}

double ms(Duration d) {
    return 1e-6 * static_cast<double>(d.ns);
}

/// Sensors are hardware, they do not wait for the service's processor. For this thread and those it makes from now on.
bool as_hardware(bool on) {
    const sched_param priority{.sched_priority = on ? 80 : 0};
    return ::sched_setscheduler(0, on ? SCHED_FIFO : SCHED_OTHER, &priority) == 0;
}

class Soak {
 public:
    Soak(const std::filesystem::path& directory, bool ordinary) {
        Config config = robot(directory / "tty", "[pose_output]\ncan = \"can1\"\n[service]\nstate_directory = \"" +
                                                     (directory / "state").string() + "\"\n");
        if (ordinary) {
            ThreadsConfig& threads = config.threads;
            for (ThreadConfig* thread :
                 {&threads.receive, &threads.odometry, &threads.filter, &threads.map, &threads.output}) {
                thread->priority = 0;
            }
        }
        if (!as_hardware(true)) {
            std::puts("the simulated sensors are ordinary threads: no right to SCHED_FIFO");
        }
        bench_ = std::make_unique<ServiceBench>(directory, config);
        as_hardware(false);
        bench_->on_pose = [this](const PoseReport& pose) { on_pose(pose); };
    }

    bool run(double seconds) {
        const Stamp begin = monotonic_now();
        bench_->service->start();
        if (!bench_->run_until([this] { return bench_->pose_known(); })) {
            std::printf("no pose within 20 s\n%s", bench_->log.c_str());
            return false;
        }
        std::printf("pose known %.2f s after the start\n", (monotonic_now() - begin).seconds());
        const nlohmann::ordered_json before = bench_->service->status();
        std::map<int, Faults> faults;
        for (const auto& thread : before["threads"]) {
            faults[thread["id"]] = faults_of(thread["id"]);
        }
        if (!is_watched(before) || !sees_faults()) {
            return false;
        }
        counting_ = true;
        const HeapWatch watch(kServiceThreads);
        const Stamp end = monotonic_now() + Duration::from_seconds(seconds);
        double settled_mib = 0.0;
        while (monotonic_now() < end) {
            const double rest_s = (end - monotonic_now()).seconds();
            run_watched(std::min(rest_s, kReport_s));
            if (settled_mib == 0.0) {
                settled_mib = resident_mib();
            }
            std::printf("%6.0f s  resident %.1f MiB, poses %llu, lost %llu, worst error %.0f mm\n",
                        seconds - (end - monotonic_now()).seconds(), resident_mib(),
                        static_cast<unsigned long long>(poses_), static_cast<unsigned long long>(lost_),
                        1000.0 * worst_m_);
            std::fflush(stdout);
        }
        const std::uint64_t heap_calls = watch.calls();
        look_for_misses();
        const bool paged = report(before, faults, bench_->service->status());
        std::printf(
            "from the last scan's first beam to a pose that is sent: 50%% below %.3f ms, 99.9%% below %.3f ms, max "
            "%.3f ms\n",
            ms(ages_.below(0.5)), ms(ages_.below(0.999)), ms(ages_.max()));
        const double grown_mib = resident_mib() - settled_mib;
        std::printf(
            "heap calls of these threads %llu%s, resident after the first minute %.1f MiB and at the end %.1f\n",
            static_cast<unsigned long long>(heap_calls), HeapGuard::available() ? "" : " (not counted)", settled_mib,
            settled_mib + grown_mib);
        bench_->service->stop();
        return heap_calls == 0 && !paged && lost_ == 0 && grown_mib < kGrowth_mib;
    }

 private:
    static constexpr double kReport_s = 60.0;
    static constexpr double kGrowth_mib = 0.5;  // of the ordinary threads' heap
    static constexpr Duration kLook{20'000'000};
    static constexpr Duration kWork{25'000'000};  ///< of which a miss may be told at its end

    struct Misses {
        std::uint64_t all = 0;
        std::uint64_t machines = 0;  ///< at a time when the machine itself was late
    };

    /// The heap calls counted below are those of the service's threads, and of all of them.
    static bool is_watched(const nlohmann::ordered_json& status) {
        const bool all = status["threads"].size() == kServiceThreads.size() &&
                         std::all_of(status["threads"].begin(), status["threads"].end(), [](const auto& thread) {
                             return std::count(kServiceThreads.begin(), kServiceThreads.end(),
                                               thread["name"].template get<std::string>()) == 1;
                         });
        if (!all) {
            std::puts("the service has other threads than those whose heap calls are counted");
        }
        return all;
    }
    void run_watched(double seconds) {
        const Stamp end = monotonic_now() + Duration::from_seconds(seconds);
        bench_->run_until(
            [&] {
                const Stamp now = monotonic_now();
                if (now - looked_ >= kLook) {
                    look_for_misses();
                }
                return now >= end;
            },
            seconds + 1.0);
    }
    void look_for_misses() {
        const nlohmann::ordered_json status = bench_->service->status();
        const Stamp now = monotonic_now();
        const bool machine_late = machine_.late_within(looked_ - kWork, now);
        looked_ = now;
        for (const auto& thread : status["threads"]) {
            Misses& misses = misses_[thread["id"]];
            const std::uint64_t more = thread["misses"].get<std::uint64_t>() - misses.all;
            misses.all += more;
            misses.machines += machine_late ? more : 0;
        }
    }
    void on_pose(const PoseReport& pose) {
        if (!counting_) {
            return;
        }
        ++poses_;
        lost_ += pose.lost ? 1 : 0;
        ages_.add(pose.age);
        // Where it is now; half a period of output ago it was a few millimetres from there.
        const Pose2 there = pose_at((monotonic_now() - bench_->begun).seconds());
        worst_m_ = std::max(worst_m_, std::hypot(pose.P_map_base.x_m - there.x_m, pose.P_map_base.y_m - there.y_m));
    }

    /// @return whether a thread had to wait for a page of the disk
    bool report(const nlohmann::ordered_json& before, std::map<int, Faults>& faults_before,
                const nlohmann::ordered_json& now) {
        std::printf("%-10s %8s %10s %10s %10s %10s %8s %10s %12s %12s\n", "thread", "priority", "50% [ms]",
                    "99.9% [ms]", "max [ms]", "limit [ms]", "misses", "machine's", "minor faults", "major faults");
        bool paged = false;
        for (const auto& thread : now["threads"]) {
            Faults faults = faults_of(thread["id"]);
            faults.minor -= faults_before[thread["id"]].minor;
            faults.major -= faults_before[thread["id"]].major;
            paged = paged || faults.major > 0;
            const Misses& misses = misses_[thread["id"]];
            std::printf("%-10s %8d %10.3f %10.3f %10.3f %10.1f %8llu %10llu %12llu %12llu\n",
                        thread["name"].get<std::string>().c_str(), thread["priority"].get<int>(),
                        1e-3 * thread["median_below_us"].get<double>(), 1e-3 * thread["p999_below_us"].get<double>(),
                        1e-3 * thread["max_us"].get<double>(), 1e-3 * thread["deadline_us"].get<double>(),
                        static_cast<unsigned long long>(misses.all), static_cast<unsigned long long>(misses.machines),
                        static_cast<unsigned long long>(faults.minor), static_cast<unsigned long long>(faults.major));
        }
        if (machine_.refused()) {
            std::puts("the machine is not watched: a processor refused a thread of SCHED_FIFO 95");
        } else {
            std::printf("the machine woke a thread at priority 95 more than %.1f ms late %zu times, at most %.1f ms\n",
                        ms(MachineWatch::kLate), machine_.times_late(), ms(machine_.latest()));
        }
        const auto grown = [&](const char* part, const char* key) {
            return static_cast<unsigned long long>(now[part][key].get<std::uint64_t>() -
                                                   before[part][key].get<std::uint64_t>());
        };
        std::printf("scans %llu, skipped %llu, not drawn %llu; wheel samples %llu, of full rings %llu\n",
                    grown("filter", "scans"), grown("filter", "skipped"), grown("filter", "undrawn"),
                    grown("odometry", "samples"), grown("odometry", "lost_to_full_rings"));
        return paged;
    }

    std::unique_ptr<ServiceBench> bench_;
    MachineWatch machine_;
    Stamp looked_ = monotonic_now();
    std::map<int, Misses> misses_;
    bool counting_ = false;
    std::uint64_t poses_ = 0;
    std::uint64_t lost_ = 0;
    double worst_m_ = 0.0;
    TimeHistogram ages_;
};

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("The service on a simulated robot in real time, for long, with figures.", "soak_service");
    double seconds = 60.0;
    bool ordinary = false;
    app.add_option("--seconds", seconds, "how long, from the first pose on")->check(CLI::PositiveNumber);
    app.add_flag("--ordinary", ordinary, "without SCHED_FIFO, to see what it is good for");
    CLI11_PARSE(app, argc, argv);

    std::string directory = (std::filesystem::temp_directory_path() / "crspf_soak_XXXXXX").string();
    if (::mkdtemp(directory.data()) == nullptr) {
        std::perror(directory.c_str());
        return 1;
    }
    const bool well = Soak(directory, ordinary).run(seconds);
    std::filesystem::remove_all(directory);
    std::puts(well ? "soak: all is well" : "soak: FAILED");
    return well ? 0 : 1;
} catch (const std::exception& e) {
    std::fprintf(stderr, "soak: %s\n", e.what());
    return 1;
}
