// Whether a machine can run the service: each thing it needs, what was found, and what to do about it.
//
// Ordinary code, for the start and for `crspf doctor`. No check changes the machine or waits for more than a second.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "platform/linux/machine.hpp"

namespace crspf {

enum class Verdict : std::uint8_t {
    kOk,
    kWarning,  ///< it runs, with the loss that `found` names
    kFailure,  ///< it does not run, or not in real time
};

struct PreflightCheck {
    std::string name;
    Verdict verdict = Verdict::kOk;
    std::string found;
    std::string remedy;  ///< empty where the verdict is kOk
};

/// A port of a sensor.
struct PreflightDevice {
    enum class Kind : std::uint8_t { kSerial, kTcp, kUdp, kCan };
    std::string name;  ///< of its source
    Kind kind = Kind::kSerial;
    std::string device;         ///< kSerial: /dev/...; kCan: the interface
    std::uint32_t address = 0;  ///< IPv4. kTcp: of the sensor; kUdp: our own, 0 for any
    std::uint16_t port = 0;     ///< kUdp, kTcp
};

struct PreflightNeeds {
    int priority = 80;                ///< the highest SCHED_FIFO priority of its threads
    std::vector<int> cpus;            ///< that its threads are bound to
    std::uint64_t memory_bytes = 0;   ///< locked
    std::uint64_t disk_bytes = 0;     ///< free in the state directory
    std::filesystem::path directory;  ///< maps and state
    std::vector<PreflightDevice> devices;
};

/// All checks, those of the machine first, then one a device.
[[nodiscard]] std::vector<PreflightCheck> run_preflight(const PreflightNeeds& needs, const Machine& machine);

/// "ok", "warning", "failure".
[[nodiscard]] const char* name_of(Verdict verdict);

}  // namespace crspf
