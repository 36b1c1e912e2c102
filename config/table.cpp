// The parameter table itself: the one place to add a parameter.
#include "config/parameters.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "config/capacities.hpp"

namespace crspf {

namespace {

constexpr auto kSections = std::to_array<Section>({
    {"lidar", "How the lidar is mounted, and which of its readings are believed."},
    {"obstacles", "What is an obstacle to the vehicle (paper 4.1); used by a Velodyne whose planar is obstacles."},
    {"wheels", "What turns wheel encoder counts into metres; used by logs of raw counts."},
    {"odometry", "What the odometry must know of the vehicle, and how far its word is trusted."},
    {"critical_rays", "The rays that weigh more because they see corners (paper 4.2)."},
    {"particle_filter", "The search for the pose; its range and size follow the last match (paper 4.3)."},
    {"analyser", "What the match value decides (paper 4.4, 5); match values are 0 to 2975."},
    {"map", "The map and how it is updated (paper 5)."},
    {"slam", "The pipeline as a whole."},
    {"stereo", "The stereo camera and its place on the vehicle; used by `crspf stereo` and by replays of pictures."},
    {"pose_output", "The pose on the CAN bus, as config/crspf.dbc describes it; used by the service."},
    {"threads", "The service's real-time threads: SCHED_FIFO priorities, processors, deadlines."},
    {"service", "Where the service keeps its map, and how it is spoken to."},
});

// Bounds that several rows share.
constexpr double kEvaluationsMax = capacity::kEvaluationsPerScan;
constexpr double kMatchMax = 2975.0;
constexpr double kWindowMax = 16.0;
constexpr double kBaseIdMax = 0x7FB;  // the five identifiers are standard ones
constexpr double kPriorityMax = 99.0;
constexpr double kCpuMax = 1023.0;

// Table, key, field, meaning; and for numbers: unit, least and largest value.
constexpr auto kParameters = std::to_array<Parameter>({
    {"lidar", "x_m", [](Config& c) -> Field { return &c.slam.lidar.P_base_lidar.x_m; },
     "Position of the lidar ahead of base_link.", "m", -100.0, 100.0},
    {"lidar", "y_m", [](Config& c) -> Field { return &c.slam.lidar.P_base_lidar.y_m; },
     "Position of the lidar to the left of base_link.", "m", -100.0, 100.0},
    {"lidar", "yaw_deg", [](Config& c) -> Field { return &c.slam.lidar.P_base_lidar.theta_rad; },
     "Direction of the lidar's zero angle, counter-clockwise from straight ahead.", "deg", -180.0, 180.0},
    {"lidar", "mount_inverted", [](Config& c) -> Field { return &c.slam.lidar.mount_inverted; },
     "The lidar hangs upside down: its angles run clockwise seen from above."},
    {"lidar", "range_min_m", [](Config& c) -> Field { return &c.slam.lidar.range_min_m; },
     "Nearer readings are invalid.", "m", 0.0, 300.0},
    {"lidar", "range_max_m", [](Config& c) -> Field { return &c.slam.lidar.range_max_m; },
     "Readings at or beyond this mean that nothing was seen.", "m", 0.1, 300.0},
    {"lidar", "range_noise_m", [](Config& c) -> Field { return &c.slam.lidar.range_noise_m; },
     "Standard deviation of a reading.", "m", 0.0, 1.0},
    {"lidar", "stamp_offset_s", [](Config& c) -> Field { return &c.slam.lidar.stamp_offset_s; },
     "Added to the stamps of scans: negative where scans are stamped late, after their transfer.", "s", -10.0, 10.0},
    {"lidar", "time_per_beam_s", [](Config& c) -> Field { return &c.slam.lidar.time_per_beam_s; },
     "Time from a beam to the next where the source does not tell; 0 means unknown, without de-skew.", "s", 0.0, 0.01},

    {"obstacles", "beams", [](Config& c) -> Field { return &c.slam.obstacles.beams; },
     "Sectors of the full turn, each of which gives one beam.", "", 16.0, static_cast<double>(capacity::kSectors)},
    {"obstacles", "height_step_m", [](Config& c) -> Field { return &c.slam.obstacles.height_step_m; },
     "Lower steps are no obstacles.", "m", 0.01, 2.0},
    {"obstacles", "slope_deg", [](Config& c) -> Field { return &c.slam.obstacles.slope_rad; },
     "Gentler slopes are no obstacles.", "deg", 1.0, 60.0},
    {"obstacles", "range_max_m", [](Config& c) -> Field { return &c.slam.obstacles.range_max_m; },
     "Farther obstacles are not told.", "m", 1.0, 200.0},
    {"obstacles", "vehicle_height_m", [](Config& c) -> Field { return &c.slam.obstacles.vehicle_height_m; },
     "What hangs higher above the ground is no obstacle.", "m", 0.1, 10.0},
    {"obstacles", "lidar_height_m", [](Config& c) -> Field { return &c.slam.obstacles.lidar_height_m; },
     "Height of the lidar above the ground.", "m", 0.0, 10.0},
    {"obstacles", "lidar_roll_deg", [](Config& c) -> Field { return &c.slam.obstacles.lidar_roll_rad; },
     "Of the lidar's mounting: its left side up.", "deg", -45.0, 45.0},
    {"obstacles", "lidar_pitch_deg", [](Config& c) -> Field { return &c.slam.obstacles.lidar_pitch_rad; },
     "Of the lidar's mounting: looking down.", "deg", -45.0, 45.0},
    {"obstacles", "body_x_min_m", [](Config& c) -> Field { return &c.slam.obstacles.body_x_min_m; },
     "The vehicle's own body, which the lidar sees, in base_link: its rear end.", "m", -20.0, 20.0},
    {"obstacles", "body_x_max_m", [](Config& c) -> Field { return &c.slam.obstacles.body_x_max_m; }, "Its front end.",
     "m", -20.0, 20.0},
    {"obstacles", "body_half_width_m", [](Config& c) -> Field { return &c.slam.obstacles.body_half_width_m; },
     "How far it reaches to each side; 0: nothing is left out.", "m", 0.0, 10.0},

    {"wheels", "counts_per_turn", [](Config& c) -> Field { return &c.wheels.counts_per_turn; },
     "Encoder counts of one turn of a wheel.", "counts", 1.0, 1e6},
    {"wheels", "wheel_radius_m", [](Config& c) -> Field { return &c.wheels.wheel_radius_m; },
     "Radius of a driven wheel.", "m", 0.001, 10.0},

    {"odometry", "wheel_span_m", [](Config& c) -> Field { return &c.slam.odometry.wheel_span_m; },
     "Distance between the two driven wheels: B of formula (2).", "m", 0.01, 10.0},
    {"odometry", "wheel_base_m", [](Config& c) -> Field { return &c.slam.odometry.wheel_base_m; },
     "Distance between the axles of a car-like vehicle: L of formula (3).", "m", 0.01, 30.0},
    {"odometry", "front_driven", [](Config& c) -> Field { return &c.slam.odometry.front_driven; },
     "The speed told beside a steering angle is that of the steered front wheels, not of the rear axle."},
    {"odometry", "left_wheel_factor", [](Config& c) -> Field { return &c.slam.odometry.left_wheel_factor; },
     "Metres rolled by the left wheel for each that it tells. `crspf calibrate` finds it.", "", 0.1, 10.0},
    {"odometry", "right_wheel_factor", [](Config& c) -> Field { return &c.slam.odometry.right_wheel_factor; },
     "The same of the right wheel.", "", 0.1, 10.0},
    {"odometry", "speed_factor", [](Config& c) -> Field { return &c.slam.odometry.speed_factor; },
     "True speed for each m/s that is told beside a steering angle or a yaw rate.", "", 0.1, 10.0},
    {"odometry", "steering_offset_deg", [](Config& c) -> Field { return &c.slam.odometry.steering_offset_rad; },
     "Added to the steering angle, which is 0 driving straight ahead.", "deg", -45.0, 45.0},
    {"odometry", "yaw_rate_bias_deg", [](Config& c) -> Field { return &c.slam.odometry.yaw_rate_bias_radps; },
     "What an IMU's yaw rate says while the heading stays, at the start; from there on it is learnt.", "deg/s", -5.0,
     5.0},
    {"odometry", "imu_roll_deg", [](Config& c) -> Field { return &c.slam.odometry.imu_roll_rad; },
     "How an IMU of six axes is mounted: turned to the left by imu_yaw_deg, then its x axis down by imu_pitch_deg, "
     "then "
     "about that its left side up by this much (REP-103).",
     "deg", -180.0, 180.0},
    {"odometry", "imu_pitch_deg", [](Config& c) -> Field { return &c.slam.odometry.imu_pitch_rad; },
     "The same: its x axis down; -90 where that points up.", "deg", -90.0, 90.0},
    {"odometry", "imu_yaw_deg", [](Config& c) -> Field { return &c.slam.odometry.imu_yaw_rad; },
     "Where the x axis of an IMU of six axes points, seen from the vehicle.", "deg", -180.0, 180.0},
    {"odometry", "translation_per_metre", [](Config& c) -> Field { return &c.slam.odometry.translation_per_metre; },
     "Standard deviation along and across, per metre driven.", "m/m", 0.0, 10.0},
    {"odometry", "rotation_per_radian", [](Config& c) -> Field { return &c.slam.odometry.rotation_per_radian; },
     "Standard deviation of the heading, per radian turned.", "rad/rad", 0.0, 10.0},
    {"odometry", "rotation_per_metre_deg", [](Config& c) -> Field { return &c.slam.odometry.rotation_per_metre; },
     "Standard deviation of the heading, per metre driven.", "deg/m", 0.0, 360.0},
    {"odometry", "translation_floor_m", [](Config& c) -> Field { return &c.slam.odometry.translation_floor_m; },
     "Least standard deviation of the position from one scan to the next.", "m", 1e-6, 10.0},
    {"odometry", "rotation_floor_deg", [](Config& c) -> Field { return &c.slam.odometry.rotation_floor_rad; },
     "Least standard deviation of the heading from one scan to the next.", "deg", 1e-5, 180.0},

    {"critical_rays", "enabled", [](Config& c) -> Field { return &c.slam.critical_rays.enabled; },
     "Critical rays weigh more than others; off: all rays weigh the same."},
    {"critical_rays", "window_min", [](Config& c) -> Field { return &c.slam.critical_rays.window_min; },
     "Points from a point to the nearest ones its angle is taken with: d_min of (4), (5).", "points", 1.0, kWindowMax},
    {"critical_rays", "window_max", [](Config& c) -> Field { return &c.slam.critical_rays.window_max; },
     "Points from a point to the farthest ones its angle is taken with: d_max of (4), (5).", "points", 1.0, kWindowMax},
    {"critical_rays", "angle_max_deg", [](Config& c) -> Field { return &c.slam.critical_rays.angle_max_rad; },
     "A point with a sharper angle than this is critical.", "deg", 0.0, 180.0},
    {"critical_rays", "weight", [](Config& c) -> Field { return &c.slam.critical_rays.weight; },
     "Weight a_i of (10) of a critical ray; other rays weigh 1.", "", 1.0, 100.0, true},

    {"particle_filter", "feedback", [](Config& c) -> Field { return &c.slam.particle_filter.feedback; },
     "Range and number of particles follow the last match by (9); off: always the largest."},
    {"particle_filter", "match_min", [](Config& c) -> Field { return &c.slam.particle_filter.match_min; },
     "Match at and below which the search is widest: M_min of (9).", "", 0.0, kMatchMax},
    {"particle_filter", "match_max", [](Config& c) -> Field { return &c.slam.particle_filter.match_max; },
     "Match at and above which the search is narrowest: M_max of (9).", "", 0.0, kMatchMax},
    {"particle_filter", "particles_min", [](Config& c) -> Field { return &c.slam.particle_filter.particles_min; },
     "Particles at match_max.", "", 1.0, kEvaluationsMax},
    {"particle_filter", "particles_max", [](Config& c) -> Field { return &c.slam.particle_filter.particles_max; },
     "Particles at match_min.", "", 1.0, kEvaluationsMax},
    {"particle_filter", "range_min_m", [](Config& c) -> Field { return &c.slam.particle_filter.range_min_m; },
     "Search range in x and y at match_max.", "m", 0.0001, 10.0},
    {"particle_filter", "range_max_m", [](Config& c) -> Field { return &c.slam.particle_filter.range_max_m; },
     "Search range in x and y at match_min.", "m", 0.0001, 10.0},
    {"particle_filter", "angle_min_deg", [](Config& c) -> Field { return &c.slam.particle_filter.angle_min_rad; },
     "Search range in heading at match_max.", "deg", 0.001, 180.0},
    {"particle_filter", "angle_max_deg", [](Config& c) -> Field { return &c.slam.particle_filter.angle_max_rad; },
     "Search range in heading at match_min.", "deg", 0.001, 180.0},
    {"particle_filter", "range_stddevs", [](Config& c) -> Field { return &c.slam.particle_filter.range_stddevs; },
     "The search range is at least so many standard deviations of the odometry.", "", 0.0, 100.0},
    {"particle_filter", "points_min_fraction",
     [](Config& c) -> Field { return &c.slam.particle_filter.points_min_fraction; },
     "Share of a scan's beams that must hit something, else the odometry stands: N_s of the paper.", "", 0.0, 1.0},
    {"particle_filter", "evaluations_max", [](Config& c) -> Field { return &c.slam.particle_filter.evaluations_max; },
     "Poses tried for one scan, refinement included, at most.", "", 1.0, kEvaluationsMax},
    {"particle_filter", "pull_weight", [](Config& c) -> Field { return &c.slam.particle_filter.pull_weight; },
     "Score lost per squared standard deviation away from the odometry's pose.", "", 0.0, 1.0},
    {"particle_filter", "pull_saturation", [](Config& c) -> Field { return &c.slam.particle_filter.pull_saturation; },
     "Squared standard deviations at which half of the pull is let go.", "", 0.01, 1e4},
    {"particle_filter", "refinement", [](Config& c) -> Field { return &c.slam.particle_filter.refinement; },
     "The best pose is sought on below the cell size."},
    {"particle_filter", "degeneracy", [](Config& c) -> Field { return &c.slam.particle_filter.degeneracy; },
     "In directions that the scan does not see, such as along a bare corridor, the odometry's word is kept."},
    {"particle_filter", "degenerate_below", [](Config& c) -> Field { return &c.slam.particle_filter.degenerate_below; },
     "Information along the least seen direction, over that across it, below which it counts as not seen.", "", 0.0,
     1.0},
    {"particle_filter", "seed", [](Config& c) -> Field { return &c.slam.particle_filter.seed; },
     "Seed of the random numbers; the same seed and input give the same result.", "", 0.0, kWholeMax},

    {"analyser", "result_on", [](Config& c) -> Field { return &c.slam.analyser.result_on; },
     "Match above which scans are key frames: M_u of (12).", "", 0.0, kMatchMax},
    {"analyser", "result_off", [](Config& c) -> Field { return &c.slam.analyser.result_off; },
     "Match below which scans cease to be key frames: M_l of (12).", "", 0.0, kMatchMax},
    {"analyser", "draw_on", [](Config& c) -> Field { return &c.slam.analyser.draw_on; },
     "Match above which scans are drawn again: upper threshold of (13).", "", 0.0, kMatchMax},
    {"analyser", "draw_off", [](Config& c) -> Field { return &c.slam.analyser.draw_off; },
     "Match below which scans are no longer drawn: lower threshold of (13).", "", 0.0, kMatchMax},

    {"map", "resolution_m", [](Config& c) -> Field { return &c.slam.map.resolution_m; }, "Side of a cell.", "m", 0.005,
     1.0},
    {"map", "hit", [](Config& c) -> Field { return &c.slam.map.hit; }, "Added to a cell by a hit.", "1/255", 1.0,
     255.0},
    {"map", "pass", [](Config& c) -> Field { return &c.slam.map.pass; },
     "Taken from a cell by a ray that passes through it or ends just before it.", "1/255", 0.0, 255.0},
    {"map", "behind_cells", [](Config& c) -> Field { return &c.slam.map.behind_cells; },
     "How far behind a hit evidence is taken: keeps walls thin.", "cells", 0.0, 16.0},
    {"map", "no_return_clear_m", [](Config& c) -> Field { return &c.slam.map.no_return_clear_m; },
     "How far a beam without echo clears the map; 0: not at all.", "m", 0.0, 300.0},
    {"map", "remove_errors", [](Config& c) -> Field { return &c.slam.map.remove_errors; },
     "Wrong points inside the passable area are removed."},
    {"map", "stable_range_m", [](Config& c) -> Field { return &c.slam.map.stable_range_m; },
     "Points of a key frame that are nearer than this bound the passable area.", "m", 0.0, 300.0},
    {"map", "erosion_m", [](Config& c) -> Field { return &c.slam.map.erosion_m; },
     "The passable area shrinks by this much before it is cleared.", "m", 0.0, 5.0},

    {"slam", "deskew", [](Config& c) -> Field { return &c.slam.deskew; },
     "Each beam is placed by the odometry at its own time."},

    {"stereo", "device", [](Config& c) -> Field { return &c.stereo.device; },
     "Camera as V4L2 names it: /dev/video0, better /dev/v4l/by-id/..., which stays the same."},
    {"stereo", "right_device", [](Config& c) -> Field { return &c.stereo.right_device; },
     "The right camera, where it is a device of its own; empty: device gives both pictures side by side."},
    {"stereo", "width_px", [](Config& c) -> Field { return &c.stereo.width_px; }, "Width of each picture.", "px", 64.0,
     4096.0},
    {"stereo", "height_px", [](Config& c) -> Field { return &c.stereo.height_px; }, "Height of each picture.", "px",
     64.0, 4096.0},
    {"stereo", "rate_hz", [](Config& c) -> Field { return &c.stereo.rate_hz; }, "Pairs a second.", "Hz", 1.0, 120.0},
    {"stereo", "calibration", [](Config& c) -> Field { return &c.stereo.calibration; },
     "File of `crspf calibrate stereo`, of OpenCV, or KITTI's calib.txt, as seen from this file; empty: pictures are "
     "rectified already and their folder holds calib.txt."},
    {"stereo", "calibration_text", [](Config& c) -> Field { return &c.stereo.calibration_text; },
     "What such a file would hold, in its place; recordings carry it."},
    {"stereo", "x_m", [](Config& c) -> Field { return &c.stereo.odometry.mounting.x_m; },
     "Position of the left camera ahead of base_link.", "m", -100.0, 100.0},
    {"stereo", "y_m", [](Config& c) -> Field { return &c.stereo.odometry.mounting.y_m; },
     "Its position to the left of base_link.", "m", -100.0, 100.0},
    {"stereo", "z_m", [](Config& c) -> Field { return &c.stereo.odometry.mounting.z_m; },
     "Its height above the ground.", "m", 0.0, 100.0},
    {"stereo", "roll_deg", [](Config& c) -> Field { return &c.stereo.odometry.mounting.roll_rad; },
     "How it is mounted: turned to the left by yaw_deg, then down by pitch_deg, then about its view its left side up "
     "by "
     "this much (REP-103).",
     "deg", -180.0, 180.0},
    {"stereo", "pitch_deg", [](Config& c) -> Field { return &c.stereo.odometry.mounting.pitch_rad; },
     "The same: looking down.", "deg", -90.0, 90.0},
    {"stereo", "yaw_deg", [](Config& c) -> Field { return &c.stereo.odometry.mounting.yaw_rad; },
     "The same: looking to the left.", "deg", -180.0, 180.0},

    {"pose_output", "can", [](Config& c) -> Field { return &c.pose_output.can; },
     "CAN interface that the pose is sent on; empty: none."},
    {"pose_output", "rate_hz", [](Config& c) -> Field { return &c.pose_output.rate_hz; }, "Poses a second.", "Hz", 1.0,
     200.0},
    {"pose_output", "base_id", [](Config& c) -> Field { return &c.pose_output.base_id; },
     "Identifier of the first of the five frames.", "", 0.0, kBaseIdMax},
    {"pose_output", "correction_mps", [](Config& c) -> Field { return &c.pose_output.correction_mps; },
     "Speed at which a correction of the filter is let into the pose that is sent.", "m/s", 0.01, 100.0},
    {"pose_output", "correction_deg", [](Config& c) -> Field { return &c.pose_output.correction_radps; },
     "The same for the heading.", "deg/s", 0.1, 3600.0},
    {"pose_output", "jump_m", [](Config& c) -> Field { return &c.pose_output.jump_m; },
     "A larger correction is a jump: taken at once and announced by the reset counter.", "m", 0.01, 100.0},
    {"pose_output", "jump_deg", [](Config& c) -> Field { return &c.pose_output.jump_rad; }, "The same for the heading.",
     "deg", 0.1, 180.0},
    {"pose_output", "odometry_stale_s", [](Config& c) -> Field { return &c.pose_output.odometry_stale_s; },
     "Without a sample of the odometer for so long, the pose is sent as lost.", "s", 0.05, 10.0},
    {"pose_output", "match_stale_s", [](Config& c) -> Field { return &c.pose_output.match_stale_s; },
     "Without a matched scan for so long, the pose is sent as lost.", "s", 0.1, 60.0},

    {"threads", "receive_priority", [](Config& c) -> Field { return &c.threads.receive.priority; },
     "Priority of a thread that listens to a source.", "", 1.0, kPriorityMax},
    {"threads", "receive_cpus", [](Config& c) -> Field { return &c.threads.receive.cpus; },
     "Processors it may run on; empty: any.", "", 0.0, kCpuMax},
    {"threads", "receive_deadline_ms", [](Config& c) -> Field { return &c.threads.receive.deadline_ms; },
     "More is counted as a miss: what a source's data take to be understood.", "ms", 0.01, 10000.0},
    {"threads", "odometry_priority", [](Config& c) -> Field { return &c.threads.odometry.priority; },
     "Priority of the odometry's thread.", "", 1.0, kPriorityMax},
    {"threads", "odometry_cpus", [](Config& c) -> Field { return &c.threads.odometry.cpus; },
     "Processors it may run on; empty: any.", "", 0.0, kCpuMax},
    {"threads", "odometry_deadline_ms", [](Config& c) -> Field { return &c.threads.odometry.deadline_ms; },
     "More is counted as a miss: from a sample's reception to the observed pose.", "ms", 0.01, 10000.0},
    {"threads", "filter_priority", [](Config& c) -> Field { return &c.threads.filter.priority; },
     "Priority of the particle filter's thread.", "", 1.0, kPriorityMax},
    {"threads", "filter_cpus", [](Config& c) -> Field { return &c.threads.filter.cpus; },
     "Processors it may run on; empty: any.", "", 0.0, kCpuMax},
    {"threads", "filter_deadline_ms", [](Config& c) -> Field { return &c.threads.filter.deadline_ms; },
     "More is counted as a miss: from a scan's reception to its pose.", "ms", 0.01, 10000.0},
    {"threads", "map_priority", [](Config& c) -> Field { return &c.threads.map.priority; },
     "Priority of the map update's thread.", "", 1.0, kPriorityMax},
    {"threads", "map_cpus", [](Config& c) -> Field { return &c.threads.map.cpus; },
     "Processors it may run on; empty: any.", "", 0.0, kCpuMax},
    {"threads", "map_deadline_ms", [](Config& c) -> Field { return &c.threads.map.deadline_ms; },
     "More is counted as a miss: what drawing a scan takes.", "ms", 0.01, 10000.0},
    {"threads", "output_priority", [](Config& c) -> Field { return &c.threads.output.priority; },
     "Priority of the thread that sends the pose.", "", 1.0, kPriorityMax},
    {"threads", "output_cpus", [](Config& c) -> Field { return &c.threads.output.cpus; },
     "Processors it may run on; empty: any.", "", 0.0, kCpuMax},
    {"threads", "output_deadline_ms", [](Config& c) -> Field { return &c.threads.output.deadline_ms; },
     "More is counted as a miss: how late a pose is sent.", "ms", 0.01, 10000.0},

    {"service", "control_socket", [](Config& c) -> Field { return &c.service.control_socket; },
     "Socket of `crspf ctl`."},
    {"service", "state_directory", [](Config& c) -> Field { return &c.service.state_directory; },
     "Where the map and the last pose are kept."},
    {"service", "save_every_s", [](Config& c) -> Field { return &c.service.save_every_s; },
     "Time between two savings of the map; 0: only at the end and on command.", "s", 0.0, 86400.0},
    {"service", "planning_every_s", [](Config& c) -> Field { return &c.service.planning_every_s; },
     "Time between two writings of planning.pgm and planning.yaml into the state directory, the map as `crspf export "
     "--planning` makes it; 0: not at all.",
     "s", 0.0, 86400.0},
    {"service", "localize_only", [](Config& c) -> Field { return &c.service.localize_only; },
     "Localise on the saved map and leave it as it is."},
    {"service", "relocalize", [](Config& c) -> Field { return &c.service.relocalize; },
     "Look for a robot that is lost in the whole map."},
    {"service", "record_directory", [](Config& c) -> Field { return &c.service.record_directory; },
     "Record the whole run there; empty: do not."},
});

constexpr auto kOrders = std::to_array<Order>({
    {"lidar", "range_min_m", "range_max_m", false},
    {"obstacles", "body_x_min_m", "body_x_max_m", true},
    {"critical_rays", "window_min", "window_max", true},
    {"particle_filter", "match_min", "match_max", false},
    {"particle_filter", "particles_min", "particles_max", true},
    {"particle_filter", "range_min_m", "range_max_m", true},
    {"particle_filter", "angle_min_deg", "angle_max_deg", true},
    {"analyser", "result_off", "result_on", true},
    {"analyser", "draw_off", "draw_on", true},
});

// --- The table is complete: each struct has as many fields as its section has keys. A field that was added without a
// --- row does not compile. (That no two rows share a field is a test's matter.)

/// Turns into whatever type a struct's field has.
struct Anything {
    template <class T>
    operator T() const;  // NOLINT(google-explicit-constructor): the conversion is its purpose
};

/// The number of fields of a plain struct: how many initialisers it takes.
template <class T, class... Init>
consteval std::size_t fields() {
    if constexpr (requires { T{Init{}..., Anything{}}; }) {
        return fields<T, Init..., Anything>();
    } else {
        return sizeof...(Init);
    }
}

consteval std::size_t rows(std::string_view table) {
    std::size_t n = 0;
    for (const Parameter& p : kParameters) {
        n += p.table == table ? 1U : 0U;
    }
    return n;
}

constexpr std::size_t kModules = 7;  // structs inside SlamParams: lidar to map
static_assert(rows("lidar") == fields<LidarParams>() - 1 + fields<Pose2>(), "LidarParams: add the new field's row");
static_assert(rows("obstacles") == fields<ObstacleParams>(), "ObstacleParams: add the new field's row");
static_assert(rows("wheels") == fields<WheelEncoderParams>(), "WheelEncoderParams: add the new field's row");
static_assert(rows("odometry") == fields<OdometryParams>(), "OdometryParams: add the new field's row");
static_assert(rows("critical_rays") == fields<CriticalRaysParams>(), "CriticalRaysParams: add the new field's row");
static_assert(rows("particle_filter") == fields<ParticleFilterParams>(),
              "ParticleFilterParams: add the new field's row");
static_assert(rows("analyser") == fields<AnalyserParams>(), "AnalyserParams: add the new field's row");
static_assert(rows("map") == fields<MapParams>(), "MapParams: add the new field's row");
static_assert(rows("slam") == fields<SlamParams>() - kModules - 1,  // localize_only belongs to the command line
              "SlamParams: add the new field's row, or the new module's section");
static_assert(rows("pose_output") == fields<PoseOutputConfig>(), "PoseOutputConfig: add the new field's row");
static_assert(rows("threads") == fields<ThreadsConfig>() * fields<ThreadConfig>(),
              "ThreadsConfig: add the new thread's rows");
static_assert(rows("service") == fields<ServiceConfig>(), "ServiceConfig: add the new field's row");
static_assert(rows("stereo") == fields<StereoConfig>() - 1 + fields<CameraMounting>(),
              "StereoConfig: add the new field's row");
static_assert(kSections.size() == kModules + 6, "a section without checks of its rows");

constexpr bool has_row(std::string_view table, std::string_view key) {
    return std::any_of(kParameters.begin(), kParameters.end(),
                       [&](const Parameter& p) { return p.table == table && p.key == key; });
}
static_assert(std::all_of(kOrders.begin(), kOrders.end(),
                          [](const Order& o) { return has_row(o.table, o.lower) && has_row(o.table, o.upper); }));

}  // namespace

std::span<const Section> sections() {
    return kSections;
}

std::span<const Parameter> parameters() {
    return kParameters;
}

std::span<const Order> orders() {
    return kOrders;
}

}  // namespace crspf
