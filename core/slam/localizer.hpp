// Particle filtering (paper Section 4), the odometry's corrections included: samples in, poses out.
//
// Frames (REP-105): map -> odom -> base_link -> lidar. Poses are of base_link in the map frame, whose origin is the
// robot's place at the start unless set_pose() says otherwise. The map itself is MapUpdate's; this module has its own
// image of it and is told what changed, so that the two may run in threads of their own (pipeline.hpp calls them one
// after the other). Real-time guarantee of every on_...(): no heap, no lock, no throw, no I/O, no clock; time bounded
// by the beams and the configured evaluations.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "config/capacities.hpp"
#include "core/base/cloud.hpp"
#include "core/base/samples.hpp"
#include "core/odometry/odometry.hpp"
#include "core/slam/critical_rays.hpp"
#include "core/slam/match_analyser.hpp"
#include "core/slam/match_field.hpp"
#include "core/slam/match_objective.hpp"
#include "core/slam/obstacle_scan.hpp"
#include "core/slam/particle_filter.hpp"
#include "core/slam/refinement.hpp"
#include "core/slam/scan_points.hpp"
#include "core/slam/slam_params.hpp"
#include "core/slam/surface_normals.hpp"

namespace crspf {

/// What one scan gave.
struct ScanResult {
    Stamp stamp;                      ///< of the scan's first beam: the time of the poses
    Pose2 P_map_base;                 ///< the robot's pose: P(t) where matched, else P~(t)
    Pose2 P_map_observed;             ///< P~(t), the odometry's word before the correction
    double M = 0.0;                   ///< filtered match value (11) [0 .. 2975 and a little over]
    double m = 0.0;                   ///< match value (10) at P(t), over rays into seen land [0 .. 2975]
    std::uint32_t rays = 0;           ///< N_s: hits used
    std::uint32_t critical_rays = 0;  ///< of those
    std::uint32_t evaluations = 0;    ///< passes over the rays, search and refinement
    double range_m = 0.0;             ///< [m] half the width of the particle filter's search; 0 where none was
    double range_rad = 0.0;           ///< [rad] and in heading
    bool matched = false;             ///< P(t) was sought: enough rays, inside the map's extent
    bool result = false;              ///< Result of (12): key frame
    bool draw = false;                ///< Draw of (13); new land is drawn without it
    bool lost = false;                ///< has matched well or been placed before, and not matched well for kLostAfter
    bool to_draw = false;             ///< the scan is to be drawn into the map: matched, Draw, and the map may change
    MatchShape shape;                 ///< covariance and degeneracy; meaningful when matched
};

/// Never reset. See also OdometryCounters.
struct LocalizerCounters {
    std::uint64_t scans = 0;
    std::uint64_t matched = 0;
    std::uint64_t too_few_rays = 0;  ///< N_s rule: the odometry stood
    std::uint64_t outside_map = 0;   ///< the robot has left the map's extent
    std::uint64_t key_frames = 0;    ///< Result = 1
    std::uint64_t to_draw = 0;       ///< scans that were to be drawn into the map
    std::uint64_t degenerate = 0;    ///< a direction kept the odometry's word
    std::uint64_t stood = 0;         ///< the robot stood and kept its pose
    std::uint64_t not_believed = 0;  ///< Draw = 0: the map stayed as it was
    std::uint64_t lost = 0;          ///< scans while lost
    std::uint64_t evaluations = 0;
};

class Localizer {
 public:
    /// Longer than a person needs to step aside; the scans' time.
    static constexpr Duration kLostAfter{1'000'000'000};

    /// Beyond the paper: having stood for so long a robot keeps its pose until the match has moved by half a cell, or
    /// 0.3 deg.
    static constexpr Duration kParked{10'000'000'000};

    explicit Localizer(const SlamParams& params, Kernel kernel = Kernel::kFastest);

    void on_wheel(const DifferentialSample& sample) { odometry_.add(sample); }
    void on_wheel(const AckermannSample& sample) { odometry_.add(sample); }
    void on_imu(const ImuSample& sample) { odometry_.add(sample); }
    void on_motion(const MotionSample& sample) { odometry_.add(sample); }
    /// Brings the image of the map up to date. Linear in the changes.
    void follow(const ChangeList& changes) { field_.follow(changes); }
    /// Odometry up to the scan's last beam should have come before; where it has not, the last speed is extrapolated.
    ScanResult on_scan(const Scan& scan);
    /// The scan of a revolution's obstacles. None where it is not complete.
    std::optional<ScanResult> on_cloud(const Cloud& cloud);

    /// Places the robot, for example on a loaded map. It is not lost then, for kLostAfter. Nothing is drawn before a
    /// scan has matched well there, or shows land that was never seen.
    void set_pose(const Pose2& P_map_base);
    /// The robot may be anywhere on the map: it is lost, and nothing is drawn, until a scan matches well or set_pose().
    void forget_pose();

    /// Of the last scan, for drawing it at the pose found.
    [[nodiscard]] const ScanPoints& points() const { return points_; }
    /// Which of its hits lie on critical rays, by their order in points().
    [[nodiscard]] std::span<const bool> critical() const { return {critical_.data(), points_.count}; }
    [[nodiscard]] const Odometry& odometry() const { return odometry_; }
    [[nodiscard]] const LocalizerCounters& counters() const { return counters_; }

 private:
    void match_scan(ScanResult& out);
    [[nodiscard]] double heading_trust() const;
    void stand(ScanResult& out);
    void judge(ScanResult& out);
    void watch(ScanResult& out, bool new_land);

    SlamParams params_;
    Odometry odometry_;
    ObstacleScanner obstacles_;
    Scan obstacle_scan_;
    ScanProjector projector_;
    CriticalRays critical_rays_;
    SurfaceNormals normals_;
    MatchField field_;
    MatchObjective objective_;
    ParticleFilter filter_;
    MatchAnalyser analyser_;

    ScanPoints points_;
    std::array<bool, capacity::kBeams> critical_{};
    LocalizerCounters counters_;

    // Of the scan before.
    Stamp previous_stamp_;
    double previous_M_ = 0.0;  ///< the first search is the widest
    double previous_m_ = 0.0;
    std::uint32_t previous_rays_ = 0;

    Stamp stopped_;      ///< since then the odometry has stayed where it was, and nobody has placed the robot
    Pose2 P_odom_stop_;  ///< there

    bool watched_ = false;  ///< from the first scan with Result = 1, or the first place it was given
    Stamp good_;            ///< the last scan with Result = 1, or in land never seen
    bool lost_ = false;
    bool placed_ = false;    ///< since the last scan
    bool confirmed_ = true;  ///< what was seen agrees with the place that the robot was given
};

}  // namespace crspf
