// Whatever the bytes of a log, plain or compressed: samples that keep their promises, counters, or an InputError.
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <memory>
#include <string>

#include "platform/capture/log_reader.hpp"
#include "platform/files/input_error.hpp"

namespace {

void require(bool promise) {
    if (!promise) {
        std::abort();
    }
}

// The bytes as a file that lies in memory only.
std::string file_of(const std::uint8_t* data, std::size_t size) {
    static const int fd = memfd_create("fuzz_log", MFD_CLOEXEC);
    require(fd >= 0 && ftruncate(fd, 0) == 0 && pwrite(fd, data, size, 0) == static_cast<ssize_t>(size));
    return "/proc/self/fd/" + std::to_string(fd);
}

void check_scan(const crspf::Scan& scan, const crspf::LidarParams& lidar) {
    require(scan.count > 0 && scan.count <= crspf::capacity::kBeams);
    require(std::isfinite(scan.angle_min_rad) && scan.angle_increment_rad > 0.0);
    require(scan.angle_increment_rad * (scan.count - 1) <= 2.0 * crspf::kPi);
    for (std::uint32_t i = 0; i < scan.count; ++i) {
        require(scan.beam[i] == crspf::classify(scan.range_m[i], lidar) || scan.beam[i] == crspf::Beam::kNoReturn);
    }
}

void check_motion(const crspf::MotionSample& motion) {
    const crspf::Pose2& step = motion.P_previous_base;
    require(std::hypot(step.x_m, step.y_m) <= 10.0 && std::abs(step.theta_rad) <= crspf::kPi);
}

/// Upside down, beam 0 was measured last.
crspf::Stamp first_beam(const crspf::Scan& scan) {
    return scan.stamp +
           crspf::Duration::from_seconds(std::min(scan.time_per_beam_s, 0.0) * static_cast<double>(scan.count - 1));
}

/// Odometry never runs back, nor do scans; a scan may be older than the odometry before it.
void check_order(crspf::Stamp stamp, crspf::Stamp& newest) {
    require(stamp.ns >= newest.ns - 1);  // first_beam() rounds
    newest = std::max(newest, stamp);
}

void read_all(crspf::LogReader& reader, const crspf::LidarParams& lidar) {
    static const auto event = std::make_unique<crspf::LogEvent>();
    constexpr crspf::Stamp kNone{std::numeric_limits<std::int64_t>::min() + 1};
    crspf::Stamp newest_odometry = kNone;
    crspf::Stamp newest_scan = kNone;
    std::uint64_t scans = 0;
    std::uint64_t odometry = 0;
    while (reader.next(*event)) {
        require(std::isfinite(event->recorded_stamp_s));
        switch (event->kind) {
            case crspf::LogEvent::Kind::kMotion:
                check_motion(event->motion);
                check_order(event->motion.stamp, newest_odometry);
                ++odometry;
                break;
            case crspf::LogEvent::Kind::kDifferential:
                require(std::abs(event->differential.left_m) <= 10.0 && std::abs(event->differential.right_m) <= 10.0);
                check_order(event->differential.stamp, newest_odometry);
                ++odometry;
                break;
            case crspf::LogEvent::Kind::kAckermann:
            case crspf::LogEvent::Kind::kImu:
            case crspf::LogEvent::Kind::kCloud:
            case crspf::LogEvent::Kind::kPlace: require(false); break;  // no log holds them
            case crspf::LogEvent::Kind::kScan:
                check_scan(event->scan, lidar);
                check_order(first_beam(event->scan), newest_scan);
                ++scans;
                break;
        }
        require(reader.progress() >= 0.0 && reader.progress() <= 1.0);
    }
    const crspf::LogCounts& counts = reader.counts();
    require(counts.scans == scans && counts.odometry == odometry);
    require(counts.damaged_lines + counts.ignored_lines <= counts.lines);
    require((counts.damaged_lines == 0) == counts.first_damage.empty());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    crspf::LidarParams lidar;
    lidar.mount_inverted = size % 2 == 1;
    try {
        const std::string file = file_of(data, size);
        read_all(*crspf::open_log(file, lidar, {}), lidar);
    } catch (const crspf::InputError& e) {
        require(std::string(e.what()).starts_with("/proc/self/fd/"));
    }
    return 0;
}
