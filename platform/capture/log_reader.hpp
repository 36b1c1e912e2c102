// Recorded runs as a sequence of samples in the order of the file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/cloud.hpp"
#include "core/base/lidar_params.hpp"
#include "core/base/samples.hpp"
#include "core/base/wheel_encoder_params.hpp"
#include "platform/capture/journal.hpp"
#include "platform/capture/source_report.hpp"
#include "platform/files/kitti_poses.hpp"

namespace crspf {

/// One sample of a log. Scans are large: the event is meant to be reused from call to call.
struct LogEvent {
    enum class Kind : std::uint8_t { kMotion, kDifferential, kAckermann, kImu, kScan, kCloud, kPlace };
    Kind kind = Kind::kMotion;
    /// [s] exactly as a log has it; of a recording of sensors the sample's stamp, since 1970 UTC.
    double recorded_stamp_s = 0.0;
    MotionSample motion;
    DifferentialSample differential;
    AckermannSample ackermann;
    ImuSample imu;
    /// The stamps inside the samples are on the repaired time line (timeline.hpp): those of the odometry never run
    /// back, nor do those of the scans' first beams; a scan may be older than the odometry before it. A lidar that
    /// hangs upside down sweeps from its last beam to beam 0: time_per_beam_s is negative then, and the stamp, beam
    /// 0's, ends the sweep.
    Scan scan;
    std::shared_ptr<Cloud> cloud;  ///< of a lidar of many lasers, in place of a scan
    /// kPlace: an operator told the service where the robot is, when the odometry was at `stamp`.
    struct Place {
        Stamp stamp;
        Pose2 P_map_base;
    };
    Place place;
    /// Of a scan that a running service matched: how it was timed, and the pose that it found.
    std::optional<JournalEntry> live;
};

/// The stamp of the sample that the event holds: of its first beam or column.
[[nodiscard]] Stamp stamp_of(const LogEvent& event);
/// Puts the sample off by so much.
void shift(LogEvent& event, Duration by);

/// What was read, skipped and repaired so far. The lines of a recording of sensors are its records.
struct LogCounts {
    std::uint64_t lines = 0;
    std::uint64_t scans = 0;
    std::uint64_t odometry = 0;
    std::uint64_t ignored_lines = 0;  ///< of kinds that are not ours (RLASER, SYNC, comments ...)
    std::uint64_t damaged_lines = 0;  ///< of our kinds, but unusable, be it only in their odometry
    std::uint64_t stamp_jumps = 0;    ///< stamps that ran back, or forward beyond belief
    std::uint64_t invalid_beams = 0;  ///< NaN, negative, below range_min, error codes
    std::uint64_t no_return_beams = 0;
    std::string first_damage;  ///< "FILE:LINE: reason" of the first damaged line
};

class LogReader {
 public:
    virtual ~LogReader() = default;
    /// Fills `event` with the next sample; false at the end of the log.
    /// Throws InputError when the file cannot be read on (I/O, decompression).
    virtual bool next(LogEvent& event) = 0;
    [[nodiscard]] virtual const LogCounts& counts() const = 0;
    /// How far the reading has come, 0 to 1, by the compressed bytes consumed.
    [[nodiscard]] virtual double progress() const = 0;
    /// "carmen", "urg-dat" or "capture".
    [[nodiscard]] virtual const char* format() const = 0;
    /// Of a recording of sensors, for each configured source.
    [[nodiscard]] virtual std::vector<SourceReport> sources() const { return {}; }
    /// Of a recording of pictures, after its end: the left camera's way, a pose for each pair.
    [[nodiscard]] virtual std::vector<KittiPose> take_camera_path() { return {}; }
};

/// Opens a log, plain or compressed, and recognises its format by content. Throws InputError for a path that cannot be
/// read, and for content that is neither format.
[[nodiscard]] std::unique_ptr<LogReader> open_log(const std::filesystem::path& file, const LidarParams& lidar,
                                                  const WheelEncoderParams& wheels);

}  // namespace crspf
