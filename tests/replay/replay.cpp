#include "tests/replay/replay.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <memory>
#include <span>

#include "platform/files/input_error.hpp"
#include "platform/files/sha256.hpp"
#include "tests/support/heap_guard.hpp"

namespace crspf::test {

namespace {

/// Calls the core. Nothing but the call stands between the guard's two ends.
template <typename Call>
void guarded(Replay& out, Call call) {
    const HeapGuard guard;
    call();
    out.heap_calls += guard.calls();
    ++out.core_calls;
}

void run(LogReader& reader, Pipeline& pipeline, const ReplayOptions& options, Replay& out) {
    const auto event = std::make_unique<LogEvent>();
    ScanResult result;
    while (reader.next(*event)) {
        switch (event->kind) {
            case LogEvent::Kind::kMotion: guarded(out, [&] { pipeline.on_motion(event->motion); }); break;
            case LogEvent::Kind::kDifferential: guarded(out, [&] { pipeline.on_wheel(event->differential); }); break;
            case LogEvent::Kind::kAckermann: guarded(out, [&] { pipeline.on_wheel(event->ackermann); }); break;
            case LogEvent::Kind::kImu: guarded(out, [&] { pipeline.on_imu(event->imu); }); break;
            case LogEvent::Kind::kCloud:
            case LogEvent::Kind::kPlace: break;  // no log holds them
            case LogEvent::Kind::kScan:
                guarded(out, [&] {
                    result = pipeline.on_scan(event->scan);
                    options.beside_scan();
                });
                out.trajectory.push_back({.stamp_s = event->recorded_stamp_s, .P_map_base = result.P_map_base});
                break;
        }
    }
}

void add(Sha256& sha, const Pose2& pose) {
    const std::array<double, 3> values{pose.x_m, pose.y_m, pose.theta_rad};
    sha.update(std::as_bytes(std::span(values)));
}

}  // namespace

Replay replay(const std::filesystem::path& log, const Config& config, const ReplayOptions& options) {
    const std::unique_ptr<LogReader> reader = open_log(log, config.slam.lidar, config.wheels);
    const auto pipeline = std::make_unique<Pipeline>(config.slam, options.kernel);
    Replay out;
    try {
        run(*reader, *pipeline, options, out);
    } catch (const InputError& e) {
        out.error = e.what();
    }
    out.log = reader->counts();
    out.pipeline = pipeline->counters();
    out.odometry = pipeline->odometry().counters();
    Sha256 sha;
    for (const TimedPose& pose : out.trajectory) {
        const Pose2& P = pose.P_map_base;
        out.finite = out.finite && std::isfinite(P.x_m) && std::isfinite(P.y_m) && std::isfinite(P.theta_rad);
        add(sha, P);
    }
    out.digest = sha.hex();
    return out;
}

}  // namespace crspf::test
