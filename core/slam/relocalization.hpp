// Where in a known map is the robot (beyond the paper): one scan against every place and heading, for a robot that is
// lost or was carried away. The answer says how well the best place explains the scan, and how well the best other one.
//
// The search is complete to its cells: every heading, every coarse cell that a lidar can be in. One sum over the points
// of the scan bounds a block of 4 x 4 poses, headings are looked into in the order of their best blocks, and only
// blocks that may come near the best place found so far (branch and bound, after Olson 2015, "M3RSM", and Hess et al.
// 2016; core/DESIGN.md). What remains is judged on the map itself, beam by beam.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/pose.hpp"
#include "core/slam/map_view.hpp"
#include "core/slam/scan_points.hpp"
#include "core/slam/search_grid.hpp"
#include "core/slam/sparse_scan.hpp"

namespace crspf {

struct RelocalizationParams {
    double cell_m = 0.1;          ///< [m] side of the search's cells; rounded to whole cells of the map
    double tolerance_m = 0.06;    ///< [m] see PlaceCheck: range noise, and half the thickness of a drawn wall
    double found_above = 0.5;     ///< share of the scan that the robot's place must explain [0 .. 1]
    double stddevs = 2.0;         ///< by so many it must explain more than any other place
    std::uint32_t hits_min = 30;  ///< a scan with fewer hits, a cell apart, says too little
    std::uint64_t nodes_max = 1'000'000'000;  ///< poses and blocks of poses that a search may try
};

enum class PlaceVerdict : std::uint8_t {
    kUnfinished,  ///< the search has not come to its end
    kNoAnswer,    ///< there is no map, the scan has too few hits, or nodes_max is used up
    kNotFound,    ///< no place explains the scan
    kAmbiguous,   ///< another place explains it about as well
    kFound,
};

struct Relocalization {
    PlaceVerdict verdict = PlaceVerdict::kUnfinished;
    Pose2 P_map_base;            ///< the place that explains most; meaningful for kAmbiguous and kFound
    double share = 0.0;          ///< of the scan that it explains [0 .. 1]
    Pose2 P_map_runner_up;       ///< the best clearly different place; meaningful where runner_up > 0
    double runner_up = 0.0;      ///< the share that that one explains
    std::uint32_t hits = 0;      ///< of the scan in use
    std::uint64_t nodes = 0;     ///< poses and blocks of poses tried
    std::uint64_t left_out = 0;  ///< places that found no room among 64 better ones
};

/// load() a map, begin() a scan, step() until it returns true, read result().
/// What grows with the map lies in memory of the caller. No heap, no throw, no clock, no random number: the same scan
/// on the same map gives the same bits. One owner.
class Relocalizer {
 public:
    explicit Relocalizer(const RelocalizationParams& params) : params_(params) {}

    /// Bytes that load() needs beside the map: about 4 for each cell of the search. 0: no map.
    [[nodiscard]] std::size_t bytes_needed(const MapView& map) const;
    /// What `map` and `memory` point to must outlive the searches. False: no map, or too little memory. Linear in the
    /// map's cells.
    [[nodiscard]] bool load(const MapView& map, std::span<std::uint8_t> memory);

    /// Forgets the scan before. The map's walls are where the scan's points say: de-skewed, or taken at rest.
    void begin(const ScanPoints& points);
    /// Goes on for about `nodes` poses and blocks of poses: until that many are done, by whole rows of blocks and whole
    /// places. True: it has come to an end.
    bool step(std::uint64_t nodes);
    /// Also while the search goes on: the counters, with kUnfinished.
    [[nodiscard]] const Relocalization& result() const { return result_; }

 private:
    static constexpr std::uint32_t kPoints = 3 * SparseScan::kHits;
    static constexpr std::size_t kHeadings = 1440;
    static constexpr std::size_t kPlaces = 64;

    /// Bound every heading by its best block; look into the headings, best first; judge the places that came out.
    enum class Phase : std::uint8_t { kBound, kSearch, kCheck };

    struct Place {
        std::int32_t heading = 0;
        std::int32_t x = 0;  ///< [cells]
        std::int32_t y = 0;  ///< [cells]
        std::int32_t sum = 0;
        Pose2 P_corner_lidar;  ///< once checked
        double share = 0.0;    ///< once checked
    };

    void lay_out_points();
    [[nodiscard]] Layer layer(std::uint32_t point) const { return point < scan_.count ? Layer::kHit : Layer::kFree; }
    [[nodiscard]] double heading_rad(std::int32_t heading) const;
    void turn_to(std::int32_t heading);
    void next_heading();
    void sweep_row(std::int32_t by);
    void sum_blocks(std::int32_t by, std::int32_t low, std::int32_t high, std::uint16_t* sums) const;
    void look_into(std::int32_t bx, std::int32_t by);
    [[nodiscard]] std::int32_t sum_at(std::int32_t x, std::int32_t y) const;
    void keep(const Place& place);
    void raise_threshold(std::int32_t best_sum);
    void check(Place& place);
    void conclude();

    RelocalizationParams params_;
    MapView map_;
    SearchGrid grid_;
    double cell_m_ = 0.0;  ///< 0: no map

    Pose2 P_base_lidar_;
    SparseScan scan_;
    std::uint32_t points_ = 0;        ///< hits first, then points that beams have passed
    std::array<float, kPoints> x_{};  ///< [cells] from the lidar
    std::array<float, kPoints> y_{};  ///< [cells]
    std::int32_t headings_ = 0;       ///< into which the circle is divided
    std::int32_t full_ = 0;           ///< the sum of a scan that fits altogether
    std::int32_t best_sum_ = 0;
    std::int32_t threshold_ = 0;  ///< sums up to this are of no interest

    Phase phase_ = Phase::kBound;
    std::int32_t heading_ = 0;
    std::int32_t row_ = 0;                           ///< [blocks]
    std::array<std::int32_t, kPoints> dx_{};         ///< [cells] of the points at heading_
    std::array<std::int32_t, kPoints> dy_{};         ///< [cells]
    std::array<std::uint16_t, kHeadings> bounds_{};  ///< the best block of each heading; 0 once it is done
    std::size_t places_count_ = 0;
    std::size_t checked_ = 0;
    std::array<Place, kPlaces> places_{};

    Relocalization result_;
};

}  // namespace crspf
