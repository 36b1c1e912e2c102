#include "tools/crspf/inspect_samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "core/base/trig.hpp"
#include "platform/service/open_run.hpp"

namespace crspf::cli {
namespace {

void print_scan(const Scan& scan) {
    std::uint32_t hits = 0;
    float nearest_m = 0.0F;
    float farthest_m = 0.0F;
    for (std::uint32_t i = 0; i < scan.count; ++i) {
        if (scan.beam[i] == Beam::kHit) {
            nearest_m = hits == 0 ? scan.range_m[i] : std::min(nearest_m, scan.range_m[i]);
            farthest_m = std::max(farthest_m, scan.range_m[i]);
            ++hits;
        }
    }
    std::printf("scan    %u beams from %.2f deg by %.3f deg, %u hits from %.3f to %.3f m, %.1f ms\n", scan.count,
                degrees(scan.angle_min_rad), degrees(scan.angle_increment_rad), hits, static_cast<double>(nearest_m),
                static_cast<double>(farthest_m), 1e3 * scan.time_per_beam_s * scan.count);
}

void print_event(const LogEvent& event) {
    std::printf("%.6f  ", event.recorded_stamp_s);
    switch (event.kind) {
        case LogEvent::Kind::kMotion:
            std::printf("motion  %.4f m, %.4f m, %.3f deg", event.motion.P_previous_base.x_m,
                        event.motion.P_previous_base.y_m, degrees(event.motion.P_previous_base.theta_rad));
            if (event.motion.translation_variance_m2 > 0.0) {
                std::printf("  +- %.4f m, %.3f deg", std::sqrt(event.motion.translation_variance_m2),
                            degrees(std::sqrt(event.motion.rotation_variance_rad2)));
            }
            std::printf("%s\n", event.motion.blind ? ", blind" : "");
            break;
        case LogEvent::Kind::kDifferential:
            std::printf("wheels  left %.5f m, right %.5f m\n", event.differential.left_m, event.differential.right_m);
            break;
        case LogEvent::Kind::kAckermann:
            std::printf("car     %.3f m/s, steering %.3f deg\n", event.ackermann.speed_mps,
                        degrees(event.ackermann.steering_rad));
            break;
        case LogEvent::Kind::kImu:
            if (event.imu.speed_told) {
                std::printf("imu     %.3f m/s, ", event.imu.speed_mps);
            } else {
                std::printf("imu     no speed, ");
            }
            std::printf("%.3f deg/s", degrees(event.imu.yaw_rate_radps));
            if (const auto& i = event.imu.inertial) {
                std::printf(", roll %.3f deg/s, pitch %.3f deg/s, force %.3f %.3f %.3f m/s2",
                            degrees(i->roll_rate_radps), degrees(i->pitch_rate_radps), i->acceleration_x_mps2,
                            i->acceleration_y_mps2, i->acceleration_z_mps2);
            }
            std::puts("");
            break;
        case LogEvent::Kind::kScan: print_scan(event.scan); break;
        case LogEvent::Kind::kCloud:
            std::printf("cloud   %u columns of %u lasers, %u of them in lost packets\n", event.cloud->columns,
                        event.cloud->lasers, event.cloud->missing_columns);
            break;
        case LogEvent::Kind::kPlace:
            std::printf("placed  %.3f m, %.3f m, %.1f deg\n", event.place.P_map_base.x_m, event.place.P_map_base.y_m,
                        degrees(event.place.P_map_base.theta_rad));
            break;
    }
}

}  // namespace

void print_samples(const std::vector<std::filesystem::path>& files, const std::optional<Config>& config) {
    const Run run = open_run(files, config);
    const auto event = std::make_unique<LogEvent>();
    for (const std::unique_ptr<LogReader>& part : run.parts) {
        while (part->next(*event)) {
            print_event(*event);
        }
        for (const SourceReport& source : part->sources()) {
            std::puts(text_of(source).c_str());
        }
    }
}

}  // namespace crspf::cli
