#include "platform/linux/preflight_device.hpp"

#include <grp.h>
#include <linux/can/netlink.h>
#include <sys/stat.h>

#include <array>
#include <cerrno>
#include <system_error>

namespace crspf {
namespace {

std::string text_of(int error) {
    return std::generic_category().message(error);
}

std::string dotted(std::uint32_t address) {
    std::string text;
    for (unsigned shift = 32; shift > 0; shift -= 8) {
        text += std::to_string((address >> (shift - 8)) & 0xFFU) + (shift > 8 ? "." : "");
    }
    return text;
}

std::string group_name(gid_t id) {
    std::array<char, 4096> buffer{};
    group entry{};
    group* found = nullptr;
    return ::getgrgid_r(id, &entry, buffer.data(), buffer.size(), &found) == 0 && found != nullptr
               ? std::string(entry.gr_name)
               : std::to_string(id);
}

PreflightCheck begin_check(const PreflightDevice& device) {
    PreflightCheck check;
    check.name = "source " + device.name;
    return check;
}

PreflightCheck check_serial(const PreflightDevice& device, const Machine& machine) {
    PreflightCheck check = begin_check(device);
    const std::filesystem::path file = machine.root / std::filesystem::path(device.device).relative_path();
    struct stat status {};
    if (::stat(file.c_str(), &status) != 0) {
        check.verdict = Verdict::kFailure;
        check.found = device.device + ": " + text_of(errno);
        check.remedy =
            "plug it in and look for its name in /dev/serial/by-id or /dev/crspf (`dmesg -w` shows it come), then "
            "correct `port`";
        return check;
    }
    if (!S_ISCHR(status.st_mode)) {
        check.verdict = Verdict::kFailure;
        check.found = device.device + ": not a device";
        check.remedy = "name the serial line in `port`; they are listed in /dev/serial/by-id";
        return check;
    }
    const int error = machine.access(file);
    const std::string owner = group_name(status.st_gid);
    if (error != 0) {
        check.verdict = Verdict::kFailure;
        check.found = device.device + ": " + text_of(error) + ", group " + owner;
        check.remedy = "add the user to the group and log in anew: usermod -aG " + owner + " USER";
        return check;
    }
    check.found = device.device + ": readable and writable, group " + owner;
    return check;
}

const char* state_name(std::uint32_t state) {
    switch (state) {
        case CAN_STATE_ERROR_ACTIVE: return "error-active";
        case CAN_STATE_ERROR_WARNING: return "error-warning";
        case CAN_STATE_ERROR_PASSIVE: return "error-passive";
        case CAN_STATE_BUS_OFF: return "bus-off";
        case CAN_STATE_STOPPED: return "stopped";
        case CAN_STATE_SLEEPING: return "sleeping";
        default: return "in an unknown state";
    }
}

std::string set_up(const std::string& interface) {
    return "ip link set " + interface +
           " up type can bitrate BITRATE restart-ms 100, or for good as docs/deployment.md"
           " says";
}

/// Of a controller that is up: state and restart-ms.
void judge_controller(const CanLink& link, const std::string& interface, PreflightCheck& check) {
    check.found += ", " + std::to_string(link.bitrate_hz) + " bit/s, restart-ms " + std::to_string(link.restart_ms) +
                   ", " + state_name(link.state);
    const std::string again = "ip link set " + interface + " down; ";
    switch (link.state) {
        case CAN_STATE_ERROR_ACTIVE:
            if (link.restart_ms == 0) {
                check.verdict = Verdict::kWarning;
                check.found += "; after bus-off it stays off";
                check.remedy = again + set_up(interface);
            }
            return;
        case CAN_STATE_ERROR_WARNING:
        case CAN_STATE_ERROR_PASSIVE:
            check.verdict = Verdict::kWarning;
            check.remedy =
                "check the bus: both ends terminated with 120 ohm, one bit rate everywhere, a second node on";
            return;
        default:
            check.verdict = Verdict::kFailure;
            check.remedy = "check wiring, termination and bit rate, then " + again + set_up(interface);
            return;
    }
}

PreflightCheck check_can(const PreflightDevice& device, const Machine& machine) {
    PreflightCheck check = begin_check(device);
    CanLink link;
    const int error = machine.can_link(device.device, link);
    if (error != 0) {
        check.verdict = Verdict::kFailure;
        check.found = device.device + ": " + text_of(error);
        check.remedy = "plug the adapter in or load its driver; `ip -details link show type can` lists what is there";
    } else if (!link.is_can) {
        check.verdict = Verdict::kFailure;
        check.found = device.device + ": no CAN interface";
        check.remedy = "correct `port`; `ip -details link show type can` lists what is there";
    } else if (!link.up) {
        check.verdict = Verdict::kFailure;
        check.found = device.device + ": down";
        check.remedy = set_up(device.device);
    } else if (link.controller) {
        check.found = device.device + ": up";
        judge_controller(link, device.device, check);
    } else {
        check.found = device.device + ": up, virtual or on a serial line: its bit rate is not known here";
    }
    return check;
}

PreflightCheck check_udp(const PreflightDevice& device, const Machine& machine) {
    const std::string where = "udp " + dotted(device.address) + ":" + std::to_string(device.port);
    PreflightCheck check = begin_check(device);
    check.found = where + ": free";
    const int error = machine.try_udp(device.address, device.port);
    if (error == 0) {
        return check;
    }
    check.verdict = Verdict::kFailure;
    check.found = where + ": " + text_of(error);
    if (error == EADDRINUSE) {
        check.remedy = "`ss -ulnp 'sport = :" + std::to_string(device.port) + "'` names its owner; stop that";
        std::error_code ignored;
        if (std::filesystem::exists(machine.root / "run/crspf/control", ignored)) {
            check.verdict = Verdict::kWarning;
            check.found += "; the service runs and may be who";
        }
    } else if (error == EADDRNOTAVAIL) {
        check.remedy = "give the machine this address (`ip address` lists those it has), or leave it out of `port`";
    } else {
        check.remedy = "ports below 1024 are for root; choose another, in the sensor's settings and in `port`";
    }
    return check;
}

PreflightCheck check_tcp(const PreflightDevice& device, const Machine& machine) {
    const std::string where = "tcp " + dotted(device.address) + ":" + std::to_string(device.port);
    // Not connected to: a sensor takes few connections, and the service may hold one.
    PreflightCheck check = begin_check(device);
    check.found = where + ": there is a way to it";
    if (const int error = machine.route_to(device.address); error != 0) {
        check.verdict = Verdict::kFailure;
        check.found = where + ": " + text_of(error);
        check.remedy = "give the machine an address in the sensor's network; `ip route get " + dotted(device.address) +
                       "` shows the way";
    }
    return check;
}

}  // namespace

PreflightCheck check_device(const PreflightDevice& device, const Machine& machine) {
    switch (device.kind) {
        case PreflightDevice::Kind::kSerial: return check_serial(device, machine);
        case PreflightDevice::Kind::kTcp: return check_tcp(device, machine);
        case PreflightDevice::Kind::kUdp: return check_udp(device, machine);
        case PreflightDevice::Kind::kCan: return check_can(device, machine);
    }
    return {};
}

}  // namespace crspf
