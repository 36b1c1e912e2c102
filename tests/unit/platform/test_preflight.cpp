#include "platform/linux/preflight.hpp"

#include <linux/can/netlink.h>
#include <sys/stat.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cerrno>

#include "platform/linux/proc_text.hpp"
#include "tests/unit/platform/port_peers.hpp"
#include "tests/unit/platform/scratch.hpp"

using crspf::CanLink;
using crspf::Machine;
using crspf::parse_cpu_list;
using crspf::PreflightCheck;
using crspf::PreflightDevice;
using crspf::PreflightNeeds;
using crspf::run_preflight;
using crspf::to_number;
using crspf::Verdict;
using crspf::word_after;
using crspf::test::Scratch;

namespace {

constexpr std::uint64_t kMebi = std::uint64_t{1} << 20U;

/// A machine without a fault; each test breaks one thing.
struct Planted {
    Planted() {
        put("proc/version", "Linux version 6.1.0-18-rt-amd64 (gcc-12) #1 SMP PREEMPT_RT Debian 6.1.76-1\n");
        put("sys/kernel/realtime", "1\n");
        put("proc/self/status", "Name:\tcrspf\nUid:\t998\t998\t998\t998\nCapEff:\t0000000000000000\n");
        put("proc/self/limits",
            "Limit                     Soft Limit           Hard Limit           Units     \n"
            "Max locked memory         unlimited            unlimited            bytes     \n"
            "Max realtime priority     95                   95                             \n");
        put("proc/self/timerslack_ns", "50000\n");
        put("proc/meminfo", "MemTotal:        4000000 kB\nMemFree:          100000 kB\nMemAvailable:    2048000 kB\n");
        put("proc/sys/kernel/sched_rt_runtime_us", "950000\n");
        put("proc/sys/kernel/sched_rt_period_us", "1000000\n");
        put("sys/devices/system/cpu/online", "0-3\n");
        put("sys/devices/system/cpu/isolated", "2-3\n");
        for (const char* cpu : {"cpu0", "cpu1", "cpu2", "cpu3"}) {
            put(std::string("sys/devices/system/cpu/") + cpu + "/cpufreq/scaling_governor", "performance\n");
        }
        put("sys/devices/system/clocksource/clocksource0/current_clocksource", "tsc\n");
        std::filesystem::create_directories(root / "var/lib/crspf");
        std::filesystem::create_directories(root / "dev");
        std::filesystem::create_symlink("/dev/null", root / "dev/ttyUSB0");  // some character device

        machine.root = root.directory();
        machine.try_fifo = [this](int priority) {
            asked_priority = priority;
            return 0;
        };
        machine.timer_resolution_ns = [] { return 1; };
        machine.clock_synchronised = [] { return true; };
        machine.access = [](const std::filesystem::path& /*file*/) { return 0; };
        machine.free_bytes = [](const std::filesystem::path& /*directory*/) { return 2048 * kMebi; };
        machine.try_udp = [](std::uint32_t /*address*/, std::uint16_t /*port*/) { return 0; };
        machine.route_to = [](std::uint32_t /*address*/) { return 0; };
        machine.can_link = [this](const std::string& /*interface*/, CanLink& link) {
            link = can;
            return can_error;
        };

        needs.cpus = {2, 3};
        needs.memory_bytes = 200 * kMebi;
        needs.disk_bytes = 1024 * kMebi;
        needs.directory = "/var/lib/crspf";
        needs.devices = {
            {.name = "urg", .kind = PreflightDevice::Kind::kSerial, .device = "/dev/ttyUSB0"},
            {.name = "sick", .kind = PreflightDevice::Kind::kTcp, .device = "", .address = 0xC0A80001, .port = 2112},
            {.name = "velodyne", .kind = PreflightDevice::Kind::kUdp, .device = "", .address = 0, .port = 2368},
            {.name = "base", .kind = PreflightDevice::Kind::kCan, .device = "can0"},
        };
    }

    void put(const std::string& file, std::string_view content) const {
        std::filesystem::create_directories((root / file).parent_path());
        static_cast<void>(root.file(file, content));
    }
    void remove(const std::string& file) const { std::filesystem::remove_all(root / file); }

    [[nodiscard]] std::vector<PreflightCheck> checks() const { return run_preflight(needs, machine); }
    [[nodiscard]] PreflightCheck operator[](const std::string& name) const {
        for (const PreflightCheck& check : checks()) {
            if (check.name == name) {
                return check;
            }
        }
        FAIL("no check named " + name);
        return {};
    }

    Scratch root;
    Machine machine;
    PreflightNeeds needs;
    CanLink can{.is_can = true,
                .up = true,
                .controller = true,
                .bitrate_hz = 500'000,
                .restart_ms = 100,
                .state = CAN_STATE_ERROR_ACTIVE};
    int can_error = 0;
    int asked_priority = 0;
};

/// That the check names what it found and what to do.
void require(const PreflightCheck& check, Verdict verdict, const std::string& found, const std::string& remedy) {
    CAPTURE(check.name, check.found, check.remedy);
    CHECK(check.verdict == verdict);
    CHECK_THAT(check.found, Catch::Contains(found));
    CHECK_THAT(check.remedy, Catch::Contains(remedy));
}

}  // namespace

TEST_CASE("preflight: a machine without a fault passes every check, one a device, and gets no advice") {
    const Planted planted;
    const std::vector<PreflightCheck> checks = planted.checks();
    CHECK(checks.size() == 16);
    for (const PreflightCheck& check : checks) {
        CAPTURE(check.name, check.found);
        CHECK(check.verdict == Verdict::kOk);
        CHECK_FALSE(check.found.empty());
        CHECK(check.remedy.empty());
    }
    CHECK(planted.asked_priority == 80);
    for (const char* what : {"urg", "sick", "velodyne", "base"}) {
        CHECK(planted[std::string("source ") + what].verdict == Verdict::kOk);
    }
}

TEST_CASE("preflight: a machine of which nothing can be read gets no check passed for that") {
    Planted planted;
    planted.remove("proc");
    planted.remove("sys");
    for (const char* name : {"kernel", "throttling", "memory", "clock source", "locked memory", "processors"}) {
        CAPTURE(name);
        CHECK(planted[name].verdict != Verdict::kOk);
        CHECK_FALSE(planted[name].remedy.empty());
    }
}

TEST_CASE("preflight: root learns that its word does not count") {
    const Planted planted;
    planted.put("proc/self/status", "Uid:\t0\t0\t0\t0\nCapEff:\t0000000000000000\n");
    require(planted["account"], Verdict::kWarning, "root", "docs/deployment.md");
}

TEST_CASE("preflight: an ordinary kernel is a warning, its version text is believed where /sys is silent") {
    const Planted planted;
    planted.remove("sys/kernel/realtime");
    CHECK(planted["kernel"].verdict == Verdict::kOk);
    planted.put("proc/version", "Linux version 6.1.0-18-amd64 #1 SMP PREEMPT_DYNAMIC Debian\n");
    require(planted["kernel"], Verdict::kWarning, "not PREEMPT_RT", "linux-image-rt-amd64");
}

TEST_CASE("preflight: SCHED_FIFO refused names the priority, the limit and where to raise it") {
    Planted planted;
    planted.put("proc/self/limits", "Max realtime priority     0                    0\n");
    planted.needs.priority = 70;
    planted.machine.try_fifo = [](int priority) { return priority == 70 ? EPERM : 0; };
    require(planted["scheduling"], Verdict::kFailure, "SCHED_FIFO 70 refused", "LimitRTPRIO");
    CHECK_THAT(planted["scheduling"].found, Catch::EndsWith("the limit is 0"));
}

TEST_CASE("preflight: throttling below the kernel's own 95 % is a warning, none of it a failure, off is fine") {
    const Planted planted;
    planted.put("proc/sys/kernel/sched_rt_runtime_us", "949999\n");
    require(planted["throttling"], Verdict::kWarning, "949999 of 1000000 us", "950000");
    planted.put("proc/sys/kernel/sched_rt_runtime_us", "0\n");
    require(planted["throttling"], Verdict::kFailure, "0 of", "950000");
    planted.put("proc/sys/kernel/sched_rt_runtime_us", "-1\n");
    require(planted["throttling"], Verdict::kOk, "off", "");
}

TEST_CASE("preflight: memory that may not be locked, unless the capability is there") {
    const Planted planted;
    planted.put("proc/self/limits", "Max locked memory         8388608              8388608              bytes\n");
    require(planted["locked memory"], Verdict::kFailure, "8 MiB for a need of 200 MiB", "LimitMEMLOCK");
    planted.put("proc/self/status", "Uid:\t998\nCapEff:\t0000000000004000\n");
    CHECK(planted["locked memory"].verdict == Verdict::kOk);
    planted.put("proc/self/status", "Uid:\t998\nCapEff:\tffffffffffffbfff\n");  // all but that one
    CHECK(planted["locked memory"].verdict == Verdict::kFailure);
}

TEST_CASE("preflight: too little memory") {
    Planted planted;
    planted.needs.memory_bytes = 2000 * kMebi;
    CHECK(planted["memory"].verdict == Verdict::kOk);
    planted.needs.memory_bytes = 2001 * kMebi;
    require(planted["memory"], Verdict::kFailure, "2000 MiB available for a need of 2001 MiB", "--capacities");
}

TEST_CASE("preflight: a governor other than performance is named with its processor, without scaling there is none") {
    const Planted planted;
    planted.put("sys/devices/system/cpu/cpu2/cpufreq/scaling_governor", "powersave\n");
    require(planted["governor"], Verdict::kWarning, "cpu2 powersave:", "cpupower");
    for (const char* cpu : {"cpu0", "cpu1", "cpu2", "cpu3"}) {
        planted.remove(std::string("sys/devices/system/cpu/") + cpu);
    }
    require(planted["governor"], Verdict::kOk, "not the kernel's", "");
}

TEST_CASE("preflight: threads bound to processors that are absent or shared") {
    Planted planted;
    planted.needs.cpus = {1, 2};
    require(planted["processors"], Verdict::kWarning, "there, too: 1", "isolcpus");
    planted.needs.cpus = {1, 2, 4};
    require(planted["processors"], Verdict::kFailure, "not online: 4", "online");
    planted.needs.cpus = {};
    require(planted["processors"], Verdict::kOk, "no thread", "");
}

TEST_CASE("preflight: clock sources that are slow to read") {
    const Planted planted;
    for (const char* slow : {"hpet", "acpi_pm", "jiffies"}) {
        planted.put("sys/devices/system/clocksource/clocksource0/current_clocksource", std::string(slow) + "\n");
        require(planted["clock source"], Verdict::kWarning, slow, "dmesg");
    }
    for (const char* fast : {"tsc", "kvm-clock", "arch_sys_counter"}) {
        planted.put("sys/devices/system/clocksource/clocksource0/current_clocksource", std::string(fast) + "\n");
        require(planted["clock source"], Verdict::kOk, fast, "");
    }
}

TEST_CASE("preflight: timers that end on ticks only, and a great slack") {
    Planted planted;
    planted.machine.timer_resolution_ns = [] { return 4'000'000; };
    require(planted["timer"], Verdict::kFailure, "resolution 4000000 ns", "HIGH_RES_TIMERS");
    planted.machine.timer_resolution_ns = [] { return 1; };
    planted.put("proc/self/timerslack_ns", "1000001\n");
    require(planted["timer"], Verdict::kWarning, "slack 1000001 ns", "TimerSlackNSec");
    planted.remove("proc/self/timerslack_ns");  // kernels before 4.6
    require(planted["timer"], Verdict::kOk, "slack unknown", "");
}

TEST_CASE("preflight: a calendar that nobody keeps, or that may not be asked") {
    Planted planted;
    planted.machine.clock_synchronised = [] { return false; };
    require(planted["calendar clock"], Verdict::kWarning, "not synchronised", "chrony");
    planted.machine.clock_synchronised = [] { return std::nullopt; };
    require(planted["calendar clock"], Verdict::kOk, "not asked", "");
}

TEST_CASE("preflight: the state directory absent, closed, full") {
    Planted planted;
    planted.machine.free_bytes = [](const std::filesystem::path& /*directory*/) { return 1023 * kMebi; };
    require(planted["disk"], Verdict::kWarning, "1023 MiB free, wanted 1024 MiB", "recordings");
    planted.machine.access = [](const std::filesystem::path& file) { return file.filename() == "crspf" ? EACCES : 0; };
    require(planted["disk"], Verdict::kFailure, "/var/lib/crspf: Permission denied", "chown crspf:crspf");
    planted.remove("var/lib/crspf");
    require(planted["disk"], Verdict::kWarning, "/var/lib/crspf: not there", "StateDirectory");
}

TEST_CASE("preflight: a serial line absent, of no device, closed to us") {
    Planted planted;
    planted.machine.access = [](const std::filesystem::path& file) {
        return file.filename() == "ttyUSB0" ? EACCES : 0;
    };
    require(planted["source urg"], Verdict::kFailure, "/dev/ttyUSB0: Permission denied, group root",
            "usermod -aG root USER");
    planted.remove("dev/ttyUSB0");
    require(planted["source urg"], Verdict::kFailure, "/dev/ttyUSB0: No such file", "by-id");
    planted.put("dev/ttyUSB0", "");
    require(planted["source urg"], Verdict::kFailure, "not a device", "by-id");
}

TEST_CASE("preflight: a CAN bus absent, of another kind, down, without restart, in each state") {
    Planted planted;
    CHECK(planted["source base"].found == "can0: up, 500000 bit/s, restart-ms 100, error-active");
    planted.can.restart_ms = 0;
    require(planted["source base"], Verdict::kWarning, "after bus-off it stays off", "restart-ms 100");
    planted.can.restart_ms = 100;
    for (const std::uint32_t state : {CAN_STATE_ERROR_WARNING, CAN_STATE_ERROR_PASSIVE}) {
        planted.can.state = state;
        require(planted["source base"], Verdict::kWarning, "error-", "120 ohm");
    }
    for (const std::uint32_t state : {CAN_STATE_BUS_OFF, CAN_STATE_STOPPED, CAN_STATE_SLEEPING}) {
        planted.can.state = state;
        require(planted["source base"], Verdict::kFailure, "500000 bit/s", "wiring");
    }
    planted.can.controller = false;
    require(planted["source base"], Verdict::kOk, "virtual", "");
    planted.can.up = false;
    require(planted["source base"], Verdict::kFailure, "can0: down", "ip link set can0 up type can bitrate");
    planted.can.is_can = false;
    require(planted["source base"], Verdict::kFailure, "no CAN interface", "`port`");
    planted.can_error = ENODEV;
    require(planted["source base"], Verdict::kFailure, "No such device", "adapter");
}

TEST_CASE("preflight: a UDP port in use is a failure, but for the service that runs already") {
    Planted planted;
    planted.machine.try_udp = [](std::uint32_t /*address*/, std::uint16_t port) {
        return port == 2368 ? EADDRINUSE : 0;
    };
    require(planted["source velodyne"], Verdict::kFailure, "udp 0.0.0.0:2368: Address already in use", "ss -ulnp");
    planted.put("run/crspf/control", "");
    require(planted["source velodyne"], Verdict::kWarning, "the service runs", "ss -ulnp");
    planted.machine.try_udp = [](std::uint32_t /*address*/, std::uint16_t /*port*/) { return EADDRNOTAVAIL; };
    require(planted["source velodyne"], Verdict::kFailure, "Cannot assign", "ip address");
    planted.machine.try_udp = [](std::uint32_t /*address*/, std::uint16_t /*port*/) { return EACCES; };
    require(planted["source velodyne"], Verdict::kFailure, "Permission denied", "1024");
}

TEST_CASE("preflight: no way to a sensor's address") {
    Planted planted;
    planted.machine.route_to = [](std::uint32_t address) { return address == 0xC0A80001 ? ENETUNREACH : 0; };
    require(planted["source sick"], Verdict::kFailure, "tcp 192.168.0.1:2112: Network is unreachable",
            "ip route get 192.168.0.1");
}

TEST_CASE("preflight: a pipe where a text should be does not stop it") {
    const Planted planted;
    planted.remove("proc/version");
    planted.remove("sys/kernel/realtime");
    REQUIRE(::mkfifo((planted.root / "proc/version").c_str(), 0600) == 0);
    CHECK(planted["kernel"].verdict == Verdict::kWarning);
}

TEST_CASE("preflight: this machine answers every question") {
    const Machine machine = crspf::this_machine();
    CHECK(machine.try_fifo(10'000) == EINVAL);  // no such priority; 80 may be granted or not
    CHECK(machine.timer_resolution_ns() > 0);
    CHECK(machine.access("/dev/null") == 0);
    CHECK(machine.access("/dev/no_such_device") == ENOENT);
    CHECK(machine.free_bytes("/").has_value());
    CHECK_FALSE(machine.free_bytes("/no/such/directory").has_value());
    CHECK(machine.route_to(0x7F000001) == 0);

    const crspf::UniqueFd other(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    sockaddr_in own = crspf::socket_address(0x7F000001, 0);
    REQUIRE(::bind(other.get(), crspf::any_address(own), sizeof(own)) == 0);
    socklen_t size = sizeof(own);
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): POSIX's way to pass addresses
    REQUIRE(::getsockname(other.get(), reinterpret_cast<sockaddr*>(&own), &size) == 0);
    CHECK(machine.try_udp(0x7F000001, ntohs(own.sin_port)) == EADDRINUSE);
    CHECK(machine.try_udp(0x7F000001, 0) == 0);
    CHECK(machine.try_udp(0x08080808, 0) == EADDRNOTAVAIL);

    PreflightNeeds needs;
    needs.directory = "/var/lib/crspf";
    for (const PreflightCheck& check : run_preflight(needs, machine)) {
        CAPTURE(check.name, check.found);
        CHECK(check.remedy.empty() == (check.verdict == Verdict::kOk));
        CHECK_FALSE(check.found.empty());
    }
}

TEST_CASE("proc text: lists of processors, words and numbers") {
    CHECK(parse_cpu_list("0-3,8") == std::vector<int>{0, 1, 2, 3, 8});
    CHECK(parse_cpu_list("5") == std::vector<int>{5});
    for (const char* wrong : {"", "a", "3-1", "1-", "-1", "0-99999999", "1,,2", "0 1"}) {
        CAPTURE(wrong);
        CHECK(parse_cpu_list(wrong).empty());
    }
    CHECK(word_after("MemTotal:  5 kB\nMemFree:\t16384 kB\n", "MemFree:") == "16384");
    CHECK(word_after("MemTotal:  5 kB\nMemFree:", "MemFree:").empty());
    CHECK(word_after("x MemFree: 5", "MemFree:").empty());
    CHECK(to_number("unlimited") == UINT64_MAX);
    CHECK(to_number("ff", 16) == 255U);
    for (const char* wrong : {"", "-1", "5x", "99999999999999999999999"}) {
        CAPTURE(wrong);
        CHECK_FALSE(to_number(wrong).has_value());
    }
}
