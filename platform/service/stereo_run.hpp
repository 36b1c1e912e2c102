// The stereo camera, live: pictures in, motion out to crspfd, in a process of its own (`crspf stereo`).
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "config/config.hpp"
#include "platform/capture/recorder.hpp"
#include "platform/capture/source_report.hpp"
#include "platform/ports/camera.hpp"
#include "platform/service/motion_sender.hpp"

namespace crspf {

struct StereoStatus {
    double elapsed_s = 0.0;
    std::string sight;     ///< "sees", "no texture" ...; of the newest pair
    std::string problem;   ///< of the camera or of the disk; empty: none
    double work_ms = 0.0;  ///< [ms] processor time a pair, mean
    SourceCounts counts;   ///< of the odometry
    MotionSenderCounters sent;
    RecorderCounters recorder;
    std::filesystem::path file;  ///< that is being recorded; empty: none
};

struct StereoJob {
    Config config;
    std::optional<RecorderParams> record;  ///< the pictures, too
    std::optional<double> duration_s;
    /// Called about once a second.
    std::function<void(const StereoStatus&)> progress;
    /// In place of the configuration's cameras; for tests.
    std::function<std::unique_ptr<StereoSource>(const StereoConfig&)> open;
};

/// Until `stop`. Sends to the port of the configuration's motion source, if it has one. Throws InputError: no device, a
/// calibration that cannot be used, neither a motion source nor a recording, and what Recorder throws.
StereoStatus run_stereo(const StereoJob& job, const std::atomic<bool>& stop);

}  // namespace crspf
