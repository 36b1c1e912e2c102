// What the service's threads hand to each other, and nothing else: each member has one writer and one reader, named
// beside it. All of it is plain data, allocated once before the threads run.
//
//   receive (lidar) ---scan---------------------------> filter ---orders----> map
//   receive (odometer) -motion-> odometry --motion----> filter <--changes---- map <--far tiles--> tile keeper
//                                odometry <-corrections- filter
//                                odometry --odometry---> output, control
//                                                        filter --filter----> output, control
//   while somebody watches:                              filter --watched---> control <--picture-- map
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <variant>

#include "config/capacities.hpp"
#include "core/base/cloud.hpp"
#include "core/base/latest_value.hpp"
#include "core/base/samples.hpp"
#include "core/base/spsc_ring.hpp"
#include "core/slam/localizer.hpp"
#include "core/slam/occupancy.hpp"
#include "core/slam/roaming_map.hpp"
#include "core/slam/scan_points.hpp"
#include "platform/capture/journal.hpp"

namespace crspf {

/// What an odometer said, and when it was received.
struct Motion {
    std::variant<DifferentialSample, AckermannSample, ImuSample, MotionSample> sample;
    Stamp received;
};

struct ReceivedScan {
    Scan scan;
    Stamp received;  ///< its last byte
};

/// A revolution of many lasers, in place of a scan.
struct ReceivedCloud {
    Cloud cloud;
    Stamp received;
};

/// The filter's word to the odometry: the pose was this at that instant.
struct Correction {
    Stamp stamp;
    Pose2 P_map_base;
    bool jump = false;  ///< an operator has placed the robot
};

/// A scan for the map.
struct MapOrder {
    MapTask task;
    ScanPoints points;  ///< where it is to be drawn
};

/// The odometry as of its newest sample.
struct OdometryState {
    Stamp stamp;                  ///< of the newest sample; the beginning of time: none yet
    Stamp blind_since;            ///< of the first sample that measured nothing; the beginning of time: the newest did
    Pose2 P_odom_base;            ///< smooth
    Pose2 P_map_odom;             ///< by the newest correction
    double speed_mps = 0.0;       ///< [m/s] forward
    double yaw_rate_radps = 0.0;  ///< [rad/s] counter-clockwise positive
    std::uint8_t jumps = 0;       ///< corrections that were jumps, mod 256
    Duration latency;             ///< from the newest sample's reception to this
    OdometryCounters counters;
};

/// The filter as of its last scan.
struct FilterState {
    ScanResult result;
    std::uint64_t skipped_scans = 0;  ///< a newer one was there already
    std::uint64_t undrawn = 0;        ///< scans to be drawn that the map thread had no room for
    Duration latency;                 ///< from the scan's reception to this
    LocalizerCounters counters;
};

/// The map thread's.
struct MapState {
    MapUpdateCounters counters;
    std::uint64_t tiles = 0;
    std::uint64_t refused = 0;  ///< cells beyond the map's extent or the pool of tiles
};

/// A tile of the map on its way to whoever asked for all of them.
struct TileCopy {
    Cell corner;
    OccupancyTile tile;
    bool last = false;  ///< after it there is none; it is itself one unless `empty`
    bool empty = false;
    std::uint32_t copy = 0;  ///< which one it belongs to: the value of Exchange::copies_wanted that asked for it
};

/// A scan for the search of the whole map, and where the odometry had the robot when it was taken.
struct SeenScan {
    ScanPoints points;
    Pose2 P_odom_base;
};

/// A scan for those who watch.
struct WatchedScan {
    ScanResult result;
    Pose2 P_map_odom;
    std::uint32_t count = 0;  ///< hits
    std::array<float, capacity::kBeams> x_m{};
    std::array<float, capacity::kBeams> y_m{};  ///< in base_link
    std::array<bool, capacity::kBeams> critical{};
};

/// What those who watch want of the map: a picture of all its tiles, then of those that have changed since the last
/// one.
struct alignas(4) PictureOrder {  // or clang calls a library for atomic ones
    std::uint16_t number = 0;     ///< another one: begin it
    bool watched = false;         ///< else nobody is interested any longer
    bool whole = false;
};
static_assert(std::atomic<PictureOrder>::is_always_lock_free);

/// A tile of a picture.
struct PictureTile {
    Cell corner;
    TileCells cells{};
    std::uint16_t picture = 0;  ///< PictureOrder::number
    bool end = false;           ///< no tile: the picture is complete
    bool missed = false;        ///< at the end: a tile that has changed went to the keeper before it was in a picture
};

/// The robot's place, by an operator's word or found in the map.
struct FilterCommand {
    Pose2 P_map_base;
    /// Where the odometry had it there; it may have moved on since. None: it is there now.
    std::optional<Pose2> P_odom_base = {};
};

/// What one thread's readers may ask twice: a cell for each of them.
template <class T>
struct LatestForTwo {
    LatestValue<T> for_output;
    LatestValue<T> for_control;

    void publish(const T& value) {
        for_output.publish(value);
        for_control.publish(value);
    }
};

struct Exchange {
    static constexpr std::size_t kMotions = 1024;  ///< 5 s at 200 Hz
    static constexpr std::size_t kMotionsOfFilter = 4096;

    LatestValue<ReceivedScan> scan;  ///< receive (lidar) -> filter
    /// The same; 11 MiB, made before the threads run where the lidar gives revolutions.
    std::unique_ptr<LatestValue<ReceivedCloud>> cloud;
    SpscRing<Motion, kMotions> motions;                    ///< receive (odometer) -> odometry
    SpscRing<Motion, kMotionsOfFilter> motions_to_filter;  ///< odometry -> filter
    SpscRing<Correction, 64> corrections;                  ///< filter -> odometry
    SpscRing<MapOrder, 4> orders;                          ///< filter -> map
    SpscRing<ChangeList, 4> changes;                       ///< map -> filter
    TileRings far_tiles;                                   ///< map <-> tile keeper; the filter counts them
    SpscRing<FilterCommand, 4> commands;                   ///< control -> filter
    std::atomic<bool> scans_wanted{false};                 ///< control -> filter
    LatestValue<SeenScan> seen;                            ///< filter -> control, while wanted
    SpscRing<TileCopy, 16> tiles;                          ///< map -> control
    std::atomic<std::uint32_t> copies_wanted{0};           ///< control -> map: one more for each copy of the map
    std::atomic<bool> scans_watched{false};                ///< control -> filter
    LatestValue<WatchedScan> watched;                      ///< filter -> control, while watched
    std::atomic<PictureOrder> picture_order{};             ///< control -> map
    SpscRing<PictureTile, 32> picture;                     ///< map -> control
    std::atomic<bool> recording{false};                    ///< control -> filter, receive
    SpscRing<JournalEntry, 256> journal;                   ///< filter -> recorder, while recording
    LatestForTwo<OdometryState> odometry;                  ///< odometry -> output, control
    LatestForTwo<FilterState> filter;                      ///< filter -> output, control
    LatestValue<MapState> map;                             ///< map -> control
};

}  // namespace crspf
