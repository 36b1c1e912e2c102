#include "platform/linux/preflight.hpp"

#include <algorithm>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "platform/linux/preflight_device.hpp"
#include "platform/linux/proc_text.hpp"

namespace crspf {
namespace {

constexpr std::uint64_t kMebi = std::uint64_t{1} << 20U;

std::string mebibytes(std::uint64_t bytes) {
    return bytes == UINT64_MAX ? "unlimited" : std::to_string(bytes / kMebi) + " MiB";
}

PreflightCheck ok(std::string name, std::string found) {
    return {.name = std::move(name), .verdict = Verdict::kOk, .found = std::move(found), .remedy = {}};
}

PreflightCheck warning(std::string name, std::string found, std::string remedy) {
    return {std::move(name), Verdict::kWarning, std::move(found), std::move(remedy)};
}

PreflightCheck failure(std::string name, std::string found, std::string remedy) {
    return {std::move(name), Verdict::kFailure, std::move(found), std::move(remedy)};
}

/// The machine's texts.
class Preflight {
 public:
    Preflight(const PreflightNeeds& needs, const Machine& machine) : needs_(needs), machine_(machine) {}

    [[nodiscard]] PreflightCheck account() const;
    [[nodiscard]] PreflightCheck kernel() const;
    [[nodiscard]] PreflightCheck scheduling() const;
    [[nodiscard]] PreflightCheck throttling() const;
    [[nodiscard]] PreflightCheck locked_memory() const;
    [[nodiscard]] PreflightCheck memory() const;
    [[nodiscard]] PreflightCheck governor() const;
    [[nodiscard]] PreflightCheck cpus() const;
    [[nodiscard]] PreflightCheck clock_source() const;
    [[nodiscard]] PreflightCheck timer() const;
    [[nodiscard]] PreflightCheck calendar() const;
    [[nodiscard]] PreflightCheck disk() const;

 private:
    [[nodiscard]] std::string text(const std::string& file) const {
        return read_text(machine_.root / file).value_or("");
    }
    [[nodiscard]] std::vector<int> online() const { return parse_cpu_list(text("sys/devices/system/cpu/online")); }
    /// A soft limit of this process; empty where /proc does not tell.
    [[nodiscard]] std::optional<std::uint64_t> limit(std::string_view label) const {
        return to_number(word_after(text("proc/self/limits"), label));
    }

    const PreflightNeeds& needs_;
    const Machine& machine_;
};

PreflightCheck Preflight::account() const {
    const std::string user(word_after(text("proc/self/status"), "Uid:"));
    if (user == "0") {
        return warning("account", "root, who may do everything: what follows says nothing about the service's user",
                       "run it as the service would be; docs/deployment.md has the command");
    }
    return ok("account", "user " + user);
}

PreflightCheck Preflight::kernel() const {
    const std::string version = text("proc/version");
    if (text("sys/kernel/realtime") == "1" || version.find("PREEMPT_RT") != std::string::npos) {
        return ok("kernel", "PREEMPT_RT");
    }
    return warning("kernel", "not PREEMPT_RT: under load a scan may wait for the kernel for milliseconds",
                   "apt install linux-image-rt-amd64 (or -arm64), then reboot");
}

PreflightCheck Preflight::scheduling() const {
    const std::string wanted = "SCHED_FIFO " + std::to_string(needs_.priority);
    const int error = machine_.try_fifo(needs_.priority);
    if (error == 0) {
        return ok("scheduling", wanted + " granted");
    }
    const std::optional<std::uint64_t> most = limit("Max realtime priority");
    return failure("scheduling",
                   wanted + " refused: " + std::generic_category().message(error) + "; the limit is " +
                       (most ? std::to_string(*most) : "not known"),
                   "LimitRTPRIO=95 in the unit, or `@crspf - rtprio 95` in /etc/security/limits.d/crspf.conf and a "
                   "new login");
}

PreflightCheck Preflight::throttling() const {
    const std::string runtime = text("proc/sys/kernel/sched_rt_runtime_us");
    const std::optional<std::uint64_t> runtime_us = to_number(runtime);
    const std::optional<std::uint64_t> period_us = to_number(text("proc/sys/kernel/sched_rt_period_us"));
    if (runtime == "-1") {
        return ok("throttling", "off");
    }
    if (!runtime_us || !period_us || *period_us == 0) {
        return warning("throttling", "not known", "check that /proc is mounted");
    }
    const std::string found = runtime + " of " + std::to_string(*period_us) + " us for real-time threads";
    const std::string remedy = "sysctl kernel.sched_rt_runtime_us=950000, for good in /etc/sysctl.d/crspf.conf";
    if (*runtime_us == 0) {
        return failure("throttling", found, remedy);
    }
    // The kernel's 95 % are a net below threads that never sleep; ours do. Less could stop them in the middle of a
    // scan.
    return *runtime_us * 100 >= *period_us * 95 ? ok("throttling", found) : warning("throttling", found, remedy);
}

PreflightCheck Preflight::locked_memory() const {
    constexpr unsigned kCapIpcLock = 14;  // linux/capability.h
    const std::uint64_t capabilities = to_number(word_after(text("proc/self/status"), "CapEff:"), 16).value_or(0);
    if (((capabilities >> kCapIpcLock) & 1U) != 0) {
        return ok("locked memory", "without limit, by CAP_IPC_LOCK");
    }
    const std::optional<std::uint64_t> most = limit("Max locked memory");
    const std::string found =
        (most ? mebibytes(*most) : "an unknown limit") + " for a need of " + mebibytes(needs_.memory_bytes);
    if (most && *most >= needs_.memory_bytes) {
        return ok("locked memory", found);
    }
    return failure("locked memory", found,
                   "LimitMEMLOCK=infinity in the unit, or `@crspf - memlock unlimited` in "
                   "/etc/security/limits.d/crspf.conf and a new login");
}

PreflightCheck Preflight::memory() const {
    const std::optional<std::uint64_t> kib = to_number(word_after(text("proc/meminfo"), "MemAvailable:"));
    if (!kib) {
        return warning("memory", "not known", "check that /proc is mounted");
    }
    const std::string found = mebibytes(*kib * 1024) + " available for a need of " + mebibytes(needs_.memory_bytes);
    if (*kib * 1024 >= needs_.memory_bytes) {
        return ok("memory", found);
    }
    return failure("memory", found, "end other programs, or build with smaller bounds (`crspf config --capacities`)");
}

PreflightCheck Preflight::governor() const {
    std::string slow;
    bool scaled = false;
    for (const int cpu : online()) {
        const std::string name = std::string("cpu").append(std::to_string(cpu));
        const std::string governor = text("sys/devices/system/cpu/" + name + "/cpufreq/scaling_governor");
        scaled = scaled || !governor.empty();
        if (!governor.empty() && governor != "performance") {
            slow.append(slow.empty() ? "" : ", ").append(name).append(" ").append(governor);
        }
    }
    if (!slow.empty()) {
        return warning("governor", slow + ": a scan may find the processor slow",
                       "cpupower frequency-set -g performance (package linux-cpupower), at each start of the machine");
    }
    return ok("governor", scaled ? "performance on all processors" : "the frequency is not the kernel's to scale");
}

PreflightCheck Preflight::cpus() const {
    if (needs_.cpus.empty()) {
        return ok("processors", "no thread is bound to one");
    }
    const std::vector<int> there = online();
    const std::vector<int> isolated = parse_cpu_list(text("sys/devices/system/cpu/isolated"));
    std::string absent;
    std::string shared;
    for (const int cpu : needs_.cpus) {
        if (std::find(there.begin(), there.end(), cpu) == there.end()) {
            absent.append(" ").append(std::to_string(cpu));
        } else if (std::find(isolated.begin(), isolated.end(), cpu) == isolated.end()) {
            shared.append(" ").append(std::to_string(cpu));
        }
    }
    if (!absent.empty()) {
        return failure("processors", "not online:" + absent,
                       "bind the threads to processors of /sys/devices/system/cpu/online");
    }
    if (!shared.empty()) {
        return warning(
            "processors", "not isolated, other programs run there, too:" + shared,
            "isolcpus=domain,managed_irq,LIST on the kernel's command line (/etc/default/grub), update-grub, "
            "reboot");
    }
    return ok("processors", "all that threads are bound to are online and isolated");
}

PreflightCheck Preflight::clock_source() const {
    const std::string source = text("sys/devices/system/clocksource/clocksource0/current_clocksource");
    if (source.empty()) {
        return warning("clock source", "not known", "check that /sys is mounted");
    }
    // These are read from a device or count ticks; all others are a register of the processor.
    for (const std::string_view slow : {"hpet", "acpi_pm", "jiffies", "refined-jiffies", "pit"}) {
        if (source == slow) {
            return warning(
                "clock source", source + ": slow to read, or coarse",
                "`dmesg | grep -i tsc` says why the kernel left the processor's; newer firmware may mend it");
        }
    }
    return ok("clock source", source);
}

PreflightCheck Preflight::timer() const {
    constexpr std::int64_t kResolutionMax_ns = 1'000;
    constexpr std::uint64_t kSlackMax_ns = 1'000'000;
    const std::int64_t resolution_ns = machine_.timer_resolution_ns();
    // Slack is of ordinary threads; the kernel gives real-time ones none.
    const std::optional<std::uint64_t> slack_ns = to_number(text("proc/self/timerslack_ns"));
    const std::string found = "resolution " + std::to_string(resolution_ns) + " ns, slack " +
                              (slack_ns ? std::to_string(*slack_ns) : "unknown") + " ns";
    if (resolution_ns > kResolutionMax_ns) {
        return failure("timer", found + ": waits end on ticks only",
                       "a kernel with CONFIG_HIGH_RES_TIMERS, and no highres=off on its command line");
    }
    if (slack_ns && *slack_ns > kSlackMax_ns) {
        return warning("timer", found, "TimerSlackNSec= of the unit, or of what started this, is larger than need be");
    }
    return ok("timer", found);
}

PreflightCheck Preflight::calendar() const {
    const std::optional<bool> synchronised = machine_.clock_synchronised();
    if (!synchronised) {
        // The unit forbids all that could set a clock, and this question with it.
        return ok("calendar clock", "not asked: this process may not");
    }
    if (*synchronised) {
        return ok("calendar clock", "synchronised");
    }
    return warning("calendar clock",
                   "not synchronised: stamps in recordings and logs may be off; poses do not depend on it",
                   "apt install chrony or systemd-timesyncd, with a server that the robot can reach");
}

PreflightCheck Preflight::disk() const {
    const std::filesystem::path directory = machine_.root / needs_.directory.relative_path();
    const std::string name = needs_.directory.string();
    std::error_code error;
    if (!std::filesystem::is_directory(directory, error)) {
        return warning("disk", name + ": not there", "the service's start makes it (StateDirectory=crspf in the unit)");
    }
    if (const int refused = machine_.access(directory); refused != 0) {
        return failure("disk", name + ": " + std::generic_category().message(refused),
                       "chown crspf:crspf " + name + ", and run this as crspf");
    }
    const std::optional<std::uint64_t> free = machine_.free_bytes(directory);
    const std::string found =
        name + ": " + (free ? mebibytes(*free) : "unknown") + " free, wanted " + mebibytes(needs_.disk_bytes);
    if (free && *free >= needs_.disk_bytes) {
        return ok("disk", found);
    }
    return warning("disk", found + ": maps and recordings may not be saved",
                   "remove old recordings, or mount a larger disk there");
}

}  // namespace

std::vector<PreflightCheck> run_preflight(const PreflightNeeds& needs, const Machine& machine) {
    const Preflight preflight(needs, machine);
    std::vector<PreflightCheck> checks = {preflight.account(),    preflight.kernel(),        preflight.scheduling(),
                                          preflight.throttling(), preflight.locked_memory(), preflight.memory(),
                                          preflight.governor(),   preflight.cpus(),          preflight.clock_source(),
                                          preflight.timer(),      preflight.calendar(),      preflight.disk()};
    for (const PreflightDevice& device : needs.devices) {
        checks.push_back(check_device(device, machine));
    }
    return checks;
}

const char* name_of(Verdict verdict) {
    switch (verdict) {
        case Verdict::kOk: return "ok";
        case Verdict::kWarning: return "warning";
        case Verdict::kFailure: return "failure";
    }
    return "";
}

}  // namespace crspf
