#include "tools/crspf/calibrate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>

#include "core/base/trig.hpp"
#include "core/odometry/imu_mounting.hpp"
#include "platform/files/input_error.hpp"
#include "platform/service/open_run.hpp"
#include "tools/calibrate/cutter.hpp"
#include "tools/calibrate/drive.hpp"
#include "tools/calibrate/imu_mounting.hpp"
#include "tools/calibrate/unknowns.hpp"
#include "tools/crspf/replay.hpp"

namespace crspf {
namespace {

using calibrate::Drive;
using calibrate::Estimate;
using calibrate::Odometer;
using calibrate::Unknown;

// A scan is matched near to where the odometry expected it, the more so the fewer walls it sees: what was found moves
// that, and what is found then, until it stays.
constexpr int kRoundsMax = 8;
constexpr double kSettled = 1.0;     // standard deviation: of what the rounds choose to compare, too
constexpr double kNegligible = 0.1;  // of what is wanted

struct Read {
    Drive drive;
    Config config;
    bool scans = false;
    std::string what_else;  ///< for want of an odometer
};

/// All that the run says but its scans.
Read read(const CalibrateJob& job) {
    Read read;
    Run run = open_run(job.logs, job.config);
    read.config = run.config;
    // Of the mounting, what is told of its tilt; the yaw is to be found.
    const OdometryParams& told = run.config.slam.odometry;
    const ImuMounting tilt(OdometryParams{.imu_roll_rad = told.imu_roll_rad, .imu_pitch_rad = told.imu_pitch_rad});
    const auto event = std::make_unique<LogEvent>();
    Duration origin;
    Stamp newest;
    for (const std::unique_ptr<LogReader>& log : run.parts) {
        while (log->next(*event)) {
            shift(*event, origin);
            newest = std::max(newest, stamp_of(*event));
            switch (event->kind) {
                case LogEvent::Kind::kDifferential: read.drive.wheels.push_back(event->differential); break;
                case LogEvent::Kind::kAckermann: read.drive.car.push_back(event->ackermann); break;
                case LogEvent::Kind::kImu:
                    if (event->imu.speed_told) {
                        tilt.to_base(event->imu);
                        read.drive.imu.push_back(event->imu);
                    } else {
                        read.what_else = "; its IMU tells a yaw rate without a speed";
                    }
                    break;
                case LogEvent::Kind::kMotion: read.what_else = "; it holds poses that an odometer has summed up"; break;
                case LogEvent::Kind::kScan:
                case LogEvent::Kind::kCloud: read.scans = true; break;
                case LogEvent::Kind::kPlace: break;
            }
        }
        origin = newest - Stamp{};
    }
    return read;
}

Odometer odometer_of(const Read& read, const std::filesystem::path& log) {
    const std::array counts{read.drive.wheels.size(), read.drive.car.size(), read.drive.imu.size()};
    const auto* const most = std::max_element(counts.begin(), counts.end());
    if (*most == 0) {
        throw InputError(log.string() + ": no wheels, no speed with a steering angle or a yaw rate in it" +
                         read.what_else +
                         "; record them with `crspf record`, or give their [source.NAME] table with "
                         "--config");
    }
    return static_cast<Odometer>(most - counts.begin());
}

Finding finding_of(const Unknown& unknown, const Config& before, const Estimate& estimate) {
    return {.section = std::string(unknown.section),
            .key = std::string(unknown.key),
            .unit = std::string(unknown.unit),
            .before = unknown.get(before) / unknown.per_unit,
            .value = estimate.value / unknown.per_unit,
            .stddev = estimate.stddev / unknown.per_unit,
            .found = estimate.stddev <= unknown.wanted,
            .shown_by = std::string(unknown.shown_by)};
}

/// What an IMU tells by itself.
void add_imu(const Drive& drive, const Config& config, bool scans, std::vector<Finding>& findings) {
    constexpr double kDegree = radians(1.0);
    if (const auto bias = calibrate::standing_bias(drive.imu); bias && !scans) {
        const std::span<const Unknown> unknowns = unknowns_of(Odometer::kImu);
        const auto at = std::find_if(unknowns.begin(), unknowns.end(),
                                     [](const Unknown& unknown) { return unknown.key == "yaw_rate_bias_deg"; });
        findings.push_back(finding_of(*at, config, *bias));
    }
    if (const auto yaw = calibrate::imu_yaw(drive.imu)) {
        constexpr double kWanted_deg = 3.0;
        findings.push_back({.section = "odometry",
                            .key = "imu_yaw_deg",
                            .unit = "deg",
                            .before = config.slam.odometry.imu_yaw_rad / kDegree,
                            .value = yaw->value / kDegree,
                            .stddev = yaw->stddev / kDegree,
                            .found = yaw->stddev <= kWanted_deg * kDegree,
                            .shown_by = "speeding up, braking and bends"});
    }
}

/// Which pieces the scans tell, where the run is played with this configuration.
void play(const CalibrateJob& job, const Config& config, int round, calibrate::Cutter cutter, Drive& drive) {
    ReplayJob replay;
    replay.logs = job.logs;
    replay.config = config;
    if (job.progress) {
        replay.progress = [&](double share, std::uint64_t) { job.progress(round, share); };
    }
    replay.on_result = [&](const Scan* scan, const ScanResult& result) {
        if (scan != nullptr && result.matched && !result.lost) {
            cutter.add(*scan, result.P_map_base);
        }
    };
    static_cast<void>(run_replay(replay));
    drive.pieces = cutter.pieces();
}

}  // namespace

CalibrateOutcome run_calibration(const CalibrateJob& job) {
    Read run = read(job);
    const Odometer odometer = odometer_of(run, job.logs.back());
    CalibrateOutcome outcome;
    if (run.scans) {
        const std::span<const Unknown> unknowns = unknowns_of(odometer);
        Config config = run.config;
        std::optional<calibrate::Calibration> found;
        for (outcome.settled = false; !outcome.settled && outcome.rounds < kRoundsMax;) {
            std::vector<double> values;
            for (const Unknown& unknown : unknowns) {
                values.push_back(unknown.get(config));
            }
            play(job, config, ++outcome.rounds,
                 calibrate::Cutter(way_of(run.drive, odometer, values), config.slam.lidar.P_base_lidar), run.drive);
            found = estimate(run.drive, odometer, values);
            if (!found) {
                throw InputError(job.logs.back().string() +
                                 ": too short a drive, or the scans match too badly to tell anything; drive for a "
                                 "minute among walls, straight on and with turns to both sides");
            }
            outcome.settled = true;
            for (std::size_t i = 0; i < unknowns.size(); ++i) {
                const Estimate& now = found->estimates[i];
                outcome.settled =
                    outcome.settled && std::abs(now.value - values[i]) <=
                                           std::max(kSettled * now.stddev, kNegligible * unknowns[i].wanted);
                unknowns[i].set(config, now.value);
            }
        }
        for (std::size_t i = 0; i < unknowns.size(); ++i) {
            outcome.findings.push_back(finding_of(unknowns[i], run.config, found->estimates[i]));
        }
        outcome.pieces = found->pieces;
        outcome.rest_m = found->rest_m;
        outcome.rest_rad = found->rest_rad;
    }
    if (odometer == Odometer::kImu) {
        add_imu(run.drive, run.config, run.scans, outcome.findings);
    }
    if (outcome.findings.empty()) {
        throw InputError(
            job.logs.back().string() +
            ": no scans, and no IMU that stands for a second or tells accelerations; nothing can be found");
    }
    return outcome;
}

std::string fragment_of(const CalibrateOutcome& outcome) {
    std::string text;
    for (const char* section : {"lidar", "odometry"}) {
        bool begun = false;
        for (const Finding& finding : outcome.findings) {
            if (finding.section != section || !finding.found) {
                continue;
            }
            if (!std::exchange(begun, true)) {
                text += (text.empty() ? "[" : "\n[") + finding.section + "]\n";
            }
            std::array<char, 128> line{};
            std::snprintf(line.data(), line.size(), "%s = %.6f  # +- %.6f %s\n", finding.key.c_str(), finding.value,
                          finding.stddev, finding.unit.c_str());
            text += line.data();
        }
    }
    return text;
}

}  // namespace crspf
