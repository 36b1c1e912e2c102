#include "platform/service/preflight_needs.hpp"

#include <algorithm>
#include <utility>

#include "core/slam/pipeline.hpp"

namespace crspf {
namespace {

constexpr std::uint64_t kMebi = std::uint64_t{1} << 20U;
/// Program, libraries, stacks, and buffers of the sources; the largest of these is a Velodyne's turn (4 MiB).
constexpr std::uint64_t kBesidesCore_bytes = 64 * kMebi;
/// As `crspf record` keeps free by default.
constexpr std::uint64_t kDisk_bytes = 1024 * kMebi;

PreflightDevice::Kind kind_of(PortConfig::Kind kind) {
    switch (kind) {
        case PortConfig::Kind::kSerial: return PreflightDevice::Kind::kSerial;
        case PortConfig::Kind::kTcp: return PreflightDevice::Kind::kTcp;
        case PortConfig::Kind::kUdp: return PreflightDevice::Kind::kUdp;
        case PortConfig::Kind::kCan: return PreflightDevice::Kind::kCan;
    }
    return PreflightDevice::Kind::kSerial;
}

}  // namespace

PreflightNeeds needs_of(const Config& config) {
    PreflightNeeds needs;
    needs.memory_bytes = sizeof(Pipeline) + kBesidesCore_bytes;
    needs.disk_bytes = kDisk_bytes;
    needs.directory = config.service.state_directory;
    needs.priority = 0;
    for (const ThreadConfig* thread : {&config.threads.receive, &config.threads.odometry, &config.threads.filter,
                                       &config.threads.map, &config.threads.output}) {
        needs.priority = std::max(needs.priority, thread->priority);
        needs.cpus.insert(needs.cpus.end(), thread->cpus.begin(), thread->cpus.end());
    }
    for (const SourceConfig& source : config.sources) {
        needs.devices.push_back({.name = source.name,
                                 .kind = kind_of(source.port.kind),
                                 .device = source.port.device,
                                 .address = source.port.address,
                                 .port = source.port.port});
    }
    return needs;
}

}  // namespace crspf
