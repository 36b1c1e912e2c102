#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <vector>

#include "core/slam/map_update.hpp"
#include "core/slam/match_field.hpp"
#include "tests/unit/core/synthetic.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

constexpr double kResolution_m = 0.5;  // a power of two: cells and metres convert without rounding
constexpr double kNoise_m = 0.01;

MapParams map_params() {
    return {.resolution_m = kResolution_m,
            .hit = 80,
            .pass = 8,
            .behind_cells = 2,
            .no_return_clear_m = 0.0,
            .remove_errors = true,
            .stable_range_m = 3.0,
            .erosion_m = 0.08};
}

/// A map under update, and the field that follows it.
class Drawing {
 public:
    explicit Drawing(const MapParams& params = map_params()) : update_(make_large<MapUpdate>(params, kNoise_m)) {}

    void draw(const ScanPoints& points, const Pose2& P_map_base = {}, bool key_frame = false) {
        changes_->clear();
        update_->draw(points, P_map_base, key_frame, *changes_);
        field_->follow(changes_->view());
    }
    void set(Cell cell, Evidence evidence) {
        changes_->clear();
        update_->set(cell, evidence, *changes_);
        field_->follow(changes_->view());
    }
    [[nodiscard]] int at(std::int32_t x, std::int32_t y) const { return update_->map().at({.x = x, .y = y}); }
    [[nodiscard]] const OccupancyMap& map() const { return update_->map(); }
    [[nodiscard]] const MatchField& field() const { return *field_; }
    [[nodiscard]] const MapUpdateCounters& counters() const { return update_->counters(); }
    [[nodiscard]] const ChangeList& changes() const { return *changes_; }

 private:
    std::unique_ptr<MapUpdate> update_;
    std::unique_ptr<MatchField> field_ = make_large<MatchField>();
    std::unique_ptr<ChangeList> changes_ = std::make_unique<ChangeList>();
};

/// Rays from one place to points in base_link, none so near another that they share cells. [cells]
std::unique_ptr<ScanPoints> rays_from(double from_x, double from_y, const std::vector<std::pair<double, double>>& to) {
    auto points = std::make_unique<ScanPoints>();
    points->P_base_first_lidar = {.x_m = from_x * kResolution_m, .y_m = from_y * kResolution_m};
    points->P_base_last_lidar = points->P_base_first_lidar;
    points->beams = static_cast<std::uint32_t>(to.size());
    points->count = points->beams;
    for (std::size_t i = 0; i < to.size(); ++i) {
        points->x_m[i] = static_cast<float>(to[i].first * kResolution_m);
        points->y_m[i] = static_cast<float>(to[i].second * kResolution_m);
        points->range_m[i] =
            static_cast<float>(std::hypot(to[i].first - from_x, to[i].second - from_y) * kResolution_m);
        points->beam[i] = static_cast<std::uint16_t>(i);
    }
    return points;
}

/// The map's rules, cell by cell, on a plain array: no tiles, no blocks, no strides.
class NaiveMap {
 public:
    static constexpr std::int32_t kReach = 400;

    explicit NaiveMap(const MapParams& params) : params_(params) {}

    [[nodiscard]] int& at(std::int32_t x, std::int32_t y) {
        const std::int32_t index = (y + kReach) * 2 * kReach + x + kReach;
        return cells_.at(static_cast<std::size_t>(index));
    }

    /// [cells]
    void draw(double from_x, double from_y, double to_x, double to_y) {
        free_along(from_x, from_y, to_x, to_y);
        const double length = std::sqrt((to_x - from_x) * (to_x - from_x) + (to_y - from_y) * (to_y - from_y));
        const auto hit_x = static_cast<std::int32_t>(std::floor(to_x));
        const auto hit_y = static_cast<std::int32_t>(std::floor(to_y));
        for (int k = 1; k <= params_.behind_cells && length > 0.0; ++k) {
            const auto x = static_cast<std::int32_t>(std::floor(to_x + (to_x - from_x) * (k / length)));
            const auto y = static_cast<std::int32_t>(std::floor(to_y + (to_y - from_y) * (k / length)));
            if ((x != hit_x || y != hit_y) && at(x, y) > 1) {
                at(x, y) = std::max(at(x, y) - params_.pass, 1);
            }
        }
        at(hit_x, hit_y) = std::min(at(hit_x, hit_y) + params_.hit, 255);
    }

 private:
    // One cell per step along the longer axis: the one in which the ray passes the middle of that step, in fixed point
    // of 2^-16 cells as the map update has it.
    void free_along(double from_x, double from_y, double to_x, double to_y) {
        const bool steep = std::abs(to_y - from_y) > std::abs(to_x - from_x);
        const double a = steep ? from_y : from_x;
        const double b = steep ? from_x : from_y;
        const double da = steep ? to_y - from_y : to_x - from_x;
        const double db = steep ? to_x - from_x : to_y - from_y;
        const auto first = static_cast<std::int32_t>(std::floor(a));
        const auto last = static_cast<std::int32_t>(std::floor(a + da));
        if (first == last) {
            return;
        }
        const std::int32_t step = last > first ? 1 : -1;
        const double slope = db / da;
        const auto start = static_cast<std::int64_t>((b + (first + 0.5 - a) * slope) * 65536.0);
        const auto increment = static_cast<std::int64_t>(slope * step * 65536.0);
        for (std::int32_t k = 0; first + k * step != last; ++k) {
            const auto across = static_cast<std::int32_t>((start + k * increment) >> 16);
            int& cell = steep ? at(across, first + k * step) : at(first + k * step, across);
            cell = cell == 0 ? 1 : std::max(cell - params_.pass, 1);
        }
    }

    MapParams params_;
    std::vector<int> cells_ = std::vector<int>(4UL * kReach * kReach);
};

void require_field_agrees(const Drawing& drawing, std::int32_t reach) {
    int wrong = 0;
    for (std::int32_t y = -reach; y <= reach; ++y) {
        for (std::int32_t x = -reach; x <= reach; ++x) {
            int sum = 0;
            for (int dy = -2; dy <= 2; ++dy) {
                for (int dx = -2; dx <= 2; ++dx) {
                    sum += (3 - std::max(std::abs(dx), std::abs(dy))) *
                           pixel(static_cast<Evidence>(drawing.at(x + dx, y + dy)));
                }
            }
            wrong += drawing.field().at({.x = x, .y = y}) != sum ? 1 : 0;
            wrong += drawing.field().seen({.x = x, .y = y}) != (drawing.at(x, y) != kUnseen) ? 1 : 0;
        }
    }
    REQUIRE(wrong == 0);
}

}  // namespace

TEST_CASE("a ray: free up to its hit, occupied there, unknown behind") {
    Drawing drawing;
    drawing.draw(*rays_from(0.5, 0.5, {{10.5, 0.5}}));
    for (std::int32_t x = 0; x < 10; ++x) {
        CHECK(drawing.at(x, 0) == kFreeCell);
    }
    CHECK(drawing.at(10, 0) == 80);
    for (const auto& [x, y] : {std::pair{11, 0}, {12, 0}, {20, 0}, {-1, 0}, {5, 1}, {5, -1}, {10, 1}}) {
        CHECK(drawing.at(x, y) == kUnseen);
    }
    CHECK(drawing.counters().drawn == 1);
    CHECK(drawing.counters().cleaned == 0);

    SECTION("hits add up and are held at the top") {
        for (int i = 0; i < 10; ++i) {
            drawing.draw(*rays_from(0.5, 0.5, {{10.5, 0.5}}));
        }
        CHECK(drawing.at(10, 0) == kOccupiedCell);
    }
    SECTION("a ray that passes takes evidence away, down to free") {
        drawing.draw(*rays_from(0.5, 0.5, {{15.5, 0.5}}));
        CHECK(drawing.at(10, 0) == 72);
        CHECK(drawing.at(15, 0) == 80);
        for (int i = 0; i < 20; ++i) {
            drawing.draw(*rays_from(0.5, 0.5, {{15.5, 0.5}}));
        }
        CHECK(drawing.at(10, 0) == kFreeCell);
    }
    SECTION("a hit takes evidence from behind it, but knows nothing of what was never seen") {
        drawing.draw(*rays_from(0.5, 0.5, {{9.5, 0.5}}));
        CHECK(drawing.at(9, 0) == 81);
        CHECK(drawing.at(10, 0) == 72);
        CHECK(drawing.at(11, 0) == kUnseen);
    }
    SECTION("a ray within one cell marks that cell only") {
        Drawing other;
        other.draw(*rays_from(0.3, 0.5, {{0.7, 0.5}}));
        CHECK(other.at(0, 0) == 80);
        CHECK(other.map().tiles() == 1);
    }
}

TEST_CASE("the pose places the rays") {
    Drawing drawing;
    // From (-20.5, 30.5), heading +y: a point 10 cells ahead.
    drawing.draw(*rays_from(0.0, 0.0, {{10.0, 0.0}}),
                 {.x_m = -20.5 * kResolution_m, .y_m = 30.5 * kResolution_m, .theta_rad = kPi / 2.0});
    CHECK(drawing.at(-21, 40) == 80);
    CHECK(drawing.at(-21, 39) == kFreeCell);
    CHECK(drawing.at(-21, 30) == kFreeCell);
    CHECK(drawing.at(-21, 29) == kUnseen);
}

TEST_CASE("rays of a moving lidar begin where the lidar was") {
    Drawing drawing;
    auto points = rays_from(0.5, 0.5, {{0.5, 20.5}, {8.5, 20.5}});
    points->P_base_last_lidar = {.x_m = 16.5 * kResolution_m, .y_m = 0.5 * kResolution_m};
    drawing.draw(*points);  // beam 1 of 2 starts half way, at 8.5
    CHECK(drawing.at(0, 0) == kFreeCell);
    CHECK(drawing.at(8, 0) == kFreeCell);
    CHECK(drawing.at(8, 10) == kFreeCell);
    CHECK(drawing.at(4, 10) == kUnseen);
}

TEST_CASE("strides over free blocks change nothing: the map is the naive tracer's") {
    Drawing drawing;
    auto naive = std::make_unique<NaiveMap>(map_params());
    Rng rng(91);
    const auto compare = [&] {
        int known = 0;
        int wrong = 0;
        for (std::int32_t y = -360; y <= 360; ++y) {
            for (std::int32_t x = -360; x <= 360; ++x) {
                wrong += drawing.at(x, y) != naive->at(x, y) ? 1 : 0;
                known += drawing.at(x, y) != kUnseen ? 1 : 0;
            }
        }
        REQUIRE(wrong == 0);
        return known;
    };
    int known = 0;
    for (int round = 0; round < 300; ++round) {
        // From a few places, so that the land between fills with free blocks and is crossed again and again.
        const double from_x = std::floor(uniform(rng, -2.0, 2.0)) * 40.0 + uniform(rng, 0.0, 1.0);
        const double from_y = std::floor(uniform(rng, -2.0, 2.0)) * 40.0 + uniform(rng, 0.0, 1.0);
        std::vector<std::pair<double, double>> to;
        for (int i = 0; i < 100; ++i) {
            const double radius = uniform(rng, 0.0, 250.0);
            const double any = uniform(rng, -kPi, kPi);
            const std::int32_t kind = whole(rng, 0, 5);
            const double angle = kind == 0   ? 0.5 * kPi * whole(rng, 0, 3)   // along an axis
                                 : kind == 1 ? 0.25 * kPi * whole(rng, 0, 7)  // on a diagonal
                                 : kind == 2 ? 0.5 * kPi * whole(rng, 0, 3) + 0.02 * rng.symmetric()
                                             : any;
            to.emplace_back(from_x + radius * std::cos(angle), from_y + radius * std::sin(angle));
        }
        const auto points = rays_from(from_x, from_y, to);
        drawing.draw(*points);
        const double x0 = points->P_base_first_lidar.x_m / kResolution_m;
        const double y0 = points->P_base_first_lidar.y_m / kResolution_m;
        for (std::uint32_t i = 0; i < points->count; ++i) {
            naive->draw(x0, y0, static_cast<double>(points->x_m[i]) / kResolution_m,
                        static_cast<double>(points->y_m[i]) / kResolution_m);
        }
        if (round % 60 == 59) {
            known = compare();
        }
    }
    CHECK(known > 100000);
    CHECK(drawing.changes().refused() == 0);
    require_field_agrees(drawing, 300);
}

TEST_CASE("free blocks stay in step with cells that are set or lost again") {
    Drawing drawing;
    auto naive = std::make_unique<NaiveMap>(map_params());
    Rng rng(92);
    for (std::int32_t y = -40; y < 40; ++y) {
        for (std::int32_t x = -40; x < 40; ++x) {
            drawing.set({.x = x, .y = y}, kFreeCell);
            naive->at(x, y) = kFreeCell;
        }
    }
    for (int round = 0; round < 2000; ++round) {
        const std::int32_t x = whole(rng, -40, 39);
        const std::int32_t y = whole(rng, -40, 39);
        const auto evidence = static_cast<Evidence>(whole(rng, 0, 3) == 0 ? whole(rng, 0, 255) : kFreeCell);
        drawing.set({.x = x, .y = y}, evidence);
        naive->at(x, y) = evidence;
        const double angle = uniform(rng, -kPi, kPi);
        const auto points = rays_from(0.5, 0.5, {{0.5 + 38.0 * std::cos(angle), 0.5 + 38.0 * std::sin(angle)}});
        drawing.draw(*points);
        naive->draw(0.5, 0.5, static_cast<double>(points->x_m[0]) / kResolution_m,
                    static_cast<double>(points->y_m[0]) / kResolution_m);
    }
    for (std::int32_t y = -60; y <= 60; ++y) {
        for (std::int32_t x = -60; x <= 60; ++x) {
            CAPTURE(x, y);
            REQUIRE(drawing.at(x, y) == naive->at(x, y));
        }
    }
}

TEST_CASE("beams without return clear only when they are trusted to, and invalid ones never") {
    MapParams params = map_params();
    params.no_return_clear_m = GENERATE(0.0, 5.0);
    Drawing drawing(params);
    Scan scan = beams_of(3, 0.0, kPi);
    scan.beam = {Beam::kNoReturn, Beam::kInvalid, Beam::kHit};
    scan.range_m = {0.0F, 3.0F, 2.0F};
    auto points = std::make_unique<ScanPoints>();
    LidarParams lidar;
    lidar.P_base_lidar = {.x_m = 0.25, .y_m = 0.25};
    ScanProjector(lidar, false).project(scan, Odometry({}), *points);
    drawing.draw(*points);
    for (std::int32_t x = 1; x < 10; ++x) {
        CHECK(drawing.at(x, 0) == (params.no_return_clear_m > 0.0 ? kFreeCell : kUnseen));
    }
    CHECK(drawing.at(10, 0) == kUnseen);  // the end of the clearing is no obstacle
    CHECK(drawing.at(11, 0) == kUnseen);
    for (std::int32_t y = 1; y < 10; ++y) {
        CHECK(drawing.at(0, y) == kUnseen);  // the invalid beam
    }
    CHECK(drawing.at(-4, 0) == 80);
}

TEST_CASE("a key frame erases what stands in the passable area and leaves the walls") {
    MapParams params = map_params();
    params.resolution_m = 0.05;
    params.remove_errors = GENERATE(true, false);
    const bool key_frame = GENERATE(true, false);
    CAPTURE(params.remove_errors, key_frame);
    Drawing drawing(params);
    const Walls walls = square_room(2.0);
    Scan scan = beams_of(720, radians(-179.75), radians(179.75));
    measure_at(scan, walls, {});
    auto points = std::make_unique<ScanPoints>();
    ScanProjector({}, false).project(scan, Odometry({}), *points);
    for (int i = 0; i < 5; ++i) {
        drawing.draw(*points);
    }
    // A wrong obstacle in the middle of the room, and the walls as they are.
    for (std::int32_t y = 10; y < 14; ++y) {
        for (std::int32_t x = 18; x < 22; ++x) {
            drawing.set({.x = x, .y = y}, kOccupiedCell);
        }
    }
    const auto wall_evidence = [&] {
        long sum = 0;
        for (std::int32_t k = -38; k < 38; ++k) {
            for (std::int32_t across = 39; across <= 41; ++across) {
                sum += pixel(static_cast<Evidence>(drawing.at(across, k))) +
                       pixel(static_cast<Evidence>(drawing.at(k, across))) +
                       pixel(static_cast<Evidence>(drawing.at(-across, k))) +
                       pixel(static_cast<Evidence>(drawing.at(k, -across)));
            }
        }
        return sum;
    };
    const long before = wall_evidence();
    REQUIRE(before > 4L * 70 * 200);
    drawing.draw(*points, {}, key_frame);
    CHECK(wall_evidence() >= before - before / 20);
    const bool cleans = key_frame && params.remove_errors;
    int standing = 0;
    for (std::int32_t y = 10; y < 14; ++y) {
        for (std::int32_t x = 18; x < 22; ++x) {
            standing += drawing.at(x, y) != kFreeCell ? 1 : 0;
        }
    }
    CHECK(standing == (cleans ? 0 : 16));
    CHECK(drawing.counters().cleaned == (cleans ? 1 : 0));
    CHECK(drawing.counters().cells_erased == (cleans ? 16 : 0));
}

TEST_CASE("only near points bound the passable area") {
    MapParams params = map_params();
    params.resolution_m = 0.05;
    params.stable_range_m = GENERATE(1.5, 3.0);
    Drawing drawing(params);
    Scan scan = beams_of(720, radians(-179.75), radians(179.75));
    measure_at(scan, square_room(2.0), {});
    auto points = std::make_unique<ScanPoints>();
    ScanProjector({}, false).project(scan, Odometry({}), *points);
    drawing.draw(*points);
    drawing.set({.x = 20, .y = 0}, kOccupiedCell);
    drawing.draw(*points, {}, true);
    CHECK((drawing.at(20, 0) == kFreeCell) == (params.stable_range_m > 2.0));
}

TEST_CASE("a change list that is full refuses and counts, map and field do not part") {
    Drawing drawing;
    // 2048 rays of 250 cells to every side change more cells than the list holds.
    std::vector<std::pair<double, double>> to;
    for (std::size_t i = 0; i < capacity::kBeams; ++i) {
        const double angle = static_cast<double>(i) * (2.0 * kPi / capacity::kBeams);
        to.emplace_back(0.5 + 250.0 * std::cos(angle), 0.5 + 250.0 * std::sin(angle));
    }
    const auto points = rays_from(0.5, 0.5, to);
    drawing.draw(*points);
    REQUIRE(drawing.changes().full());
    const std::uint64_t refused = drawing.changes().refused();
    CHECK(refused > 0);
    require_field_agrees(drawing, 255);
    // What did not fit comes with the next scans.
    for (int i = 0; i < 10 && drawing.changes().full(); ++i) {
        drawing.draw(*points);
    }
    CHECK_FALSE(drawing.changes().full());
    require_field_agrees(drawing, 255);
    int unknown = 0;
    for (std::int32_t y = -100; y <= 100; ++y) {
        for (std::int32_t x = -100; x <= 100; ++x) {
            unknown += drawing.at(x, y) == kUnseen ? 1 : 0;
        }
    }
    CHECK(unknown == 0);
}

TEST_CASE("a used-up pool of tiles is counted, the map that is there stays good") {
    Drawing drawing;
    drawing.draw(*rays_from(0.5, 0.5, {{100.5, 0.5}}));
    // The robot drives ever on, up and down, and looks 3000 cells to both sides: 94 tiles a scan, until all are used.
    for (int i = 0; drawing.map().refused() == 0 && i < 400; ++i) {
        const double y_m = (200 + 64 * i) * kResolution_m;
        drawing.draw(*rays_from(0.5, 0.5, {{3000.5, 0.5}, {-3000.5, 0.5}}), {.x_m = 0.0, .y_m = y_m, .theta_rad = 0.0});
    }
    CHECK(drawing.map().tiles() == capacity::kTiles - 1);
    CHECK(drawing.map().refused() > 0);
    CHECK(drawing.at(50, 0) == kFreeCell);
    CHECK(drawing.at(100, 0) == 80);
    const std::uint64_t refused = drawing.map().refused();
    drawing.draw(*rays_from(0.5, 0.5, {{0.5, -2000.5}}));  // new land: refused, and counted
    CHECK(drawing.map().refused() > refused);
    CHECK(drawing.at(0, -2001) == kUnseen);
    drawing.draw(*rays_from(0.5, 0.5, {{100.5, 0.5}}));  // old land: goes on
    CHECK(drawing.at(100, 0) == 160);
    CHECK(drawing.field().at({.x = 100, .y = 0}) == 3 * 160);
}

TEST_CASE("rays past the map's extent are cut off there and counted") {
    Drawing drawing;
    constexpr std::int32_t kEdge = TileGeometry::kHalf;
    const Pose2 at_edge{.x_m = (kEdge - 20) * kResolution_m, .y_m = 0.0, .theta_rad = 0.0};
    drawing.draw(*rays_from(0.5, 0.5, {{60.5, 0.5}, {-60.5, 0.5}, {10.5, 0.5}}), at_edge);
    CHECK(drawing.map().refused() > 0);
    CHECK(drawing.at(kEdge - 15, 0) == kFreeCell);
    CHECK(drawing.at(kEdge - 1, 0) == kFreeCell);
    CHECK(drawing.at(kEdge - 10, 0) == 81);  // passed by the first ray, hit by the third
    CHECK(drawing.at(kEdge - 81, 0) == 80);
    // A robot outside altogether draws nothing.
    const std::size_t tiles = drawing.map().tiles();
    const std::uint64_t refused = drawing.map().refused();
    drawing.draw(*rays_from(0.5, 0.5, {{5.5, 0.5}}), {.x_m = 2.0 * kEdge * kResolution_m});
    CHECK(drawing.map().tiles() == tiles);
    CHECK(drawing.map().refused() > refused);
}

TEST_CASE("a scan raises a cell once, however many neighbouring beams end in it") {
    Drawing drawing;
    drawing.draw(*rays_from(0.5, 0.5, {{10.2, 0.5}, {10.4, 0.5}, {10.6, 0.5}, {0.5, 10.5}}));
    CHECK(drawing.at(10, 0) == 80);
    CHECK(drawing.at(0, 10) == 80);
}

TEST_CASE("the rays of a dense scan share the way, leave hardly a gap, and cross a near cell a few times at most") {
    const auto beams = static_cast<std::uint32_t>(GENERATE(360, 720, 1440));
    MapParams params = map_params();
    params.pass = 1;
    Drawing drawing(params);
    constexpr int kRadius = 100;
    for (std::int32_t y = -kRadius; y <= kRadius; ++y) {
        for (std::int32_t x = -kRadius; x <= kRadius; ++x) {
            drawing.set({.x = x, .y = y}, 200);
        }
    }
    std::vector<std::pair<double, double>> circle;
    for (std::uint32_t i = 0; i < beams; ++i) {
        const SinCos r = sin_cos(2.0 * kPi * i / beams);
        circle.emplace_back(0.5 + kRadius * r.cos, 0.5 + kRadius * r.sin);
    }
    auto points = rays_from(0.5, 0.5, circle);
    points->angle_increment_rad = 2.0 * kPi / beams;
    drawing.draw(*points);
    // As far as neighbouring beams are less than a cell apart.
    int cells = 0;
    int missed = 0;
    const double dense = std::min(0.9 * kRadius, beams / (2.0 * kPi));
    for (std::int32_t y = -kRadius; y <= kRadius; ++y) {
        for (std::int32_t x = -kRadius; x <= kRadius; ++x) {
            const double range = std::hypot(x, y);
            if (range < dense) {
                CAPTURE(beams, x, y);
                ++cells;
                missed += drawing.at(x, y) == 200 ? 1 : 0;
                REQUIRE((range < 3.0 || drawing.at(x, y) >= 200 - 8));
            }
        }
    }
    CHECK(missed < cells / 30);
}
