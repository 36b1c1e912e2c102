#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <vector>

#include "core/base/real.hpp"
#include "core/slam/map_update.hpp"
#include "core/slam/relocalization.hpp"
#include "tests/unit/core/synthetic.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

constexpr double kResolution_m = 0.05;
constexpr Pose2 kMounting{.x_m = 0.2, .y_m = -0.1, .theta_rad = 0.3};

/// What a lidar on a robot sees there.
std::unique_ptr<ScanPoints> scan_at(const Walls& walls, const Pose2& P_map_base) {
    Scan scan = beams_of(361, radians(-135.0), radians(135.0));
    measure_at(scan, walls, P_map_base * kMounting);
    LidarParams lidar;
    lidar.P_base_lidar = kMounting;
    auto points = std::make_unique<ScanPoints>();
    ScanProjector(lidar, false).project(scan, Odometry({}), *points);
    return points;
}

/// A map drawn from scans at some poses, copied, and what searches it.
class KnownPlace {
 public:
    KnownPlace(const Walls& walls, const std::vector<Pose2>& visited, const RelocalizationParams& params = {})
        : relocalizer(std::make_unique<Relocalizer>(params)) {
        MapParams map_params;
        map_params.resolution_m = kResolution_m;
        const auto update = make_large<MapUpdate>(map_params, 0.01);
        const auto changes = std::make_unique<ChangeList>();
        for (const Pose2& P : visited) {
            for (int i = 0; i < 4; ++i) {
                changes->clear();
                update->draw(*scan_at(walls, {.x_m = P.x_m, .y_m = P.y_m, .theta_rad = i * kPi / 2.0}),
                             {.x_m = P.x_m, .y_m = P.y_m, .theta_rad = i * kPi / 2.0}, false, *changes);
            }
        }
        copy(update->map());
        memory.resize(relocalizer->bytes_needed(view));
        REQUIRE(relocalizer->load(view, memory));
    }

    Relocalization find(const ScanPoints& points, std::uint64_t slice = 1'000'000) const {
        relocalizer->begin(points);
        while (!relocalizer->step(slice)) {
        }
        return relocalizer->result();
    }

    MapView view;
    std::vector<std::uint8_t> memory;
    std::unique_ptr<Relocalizer> relocalizer;

 private:
    void copy(const OccupancyMap& map) {
        Cell low{.x = TileGeometry::kHalf, .y = TileGeometry::kHalf};
        Cell high{.x = -TileGeometry::kHalf, .y = -TileGeometry::kHalf};
        map.for_each_tile([&](Cell corner, const OccupancyTile&) {
            low = {.x = std::min(low.x, corner.x), .y = std::min(low.y, corner.y)};
            high = {.x = std::max(high.x, corner.x + TileGeometry::kSide),
                    .y = std::max(high.y, corner.y + TileGeometry::kSide)};
        });
        for (std::int32_t y = low.y; y < high.y; ++y) {
            for (std::int32_t x = low.x; x < high.x; ++x) {
                cells_.push_back(map.at({.x = x, .y = y}));
            }
        }
        view = {.cells = cells_,
                .width = high.x - low.x,
                .height = high.y - low.y,
                .resolution_m = kResolution_m,
                .P_map_corner = {.x_m = low.x * kResolution_m, .y_m = low.y * kResolution_m, .theta_rad = 0.0}};
    }

    std::vector<Evidence> cells_;
};

/// A room like no other.
Walls odd_room() {
    Walls walls;
    add_box(walls, -4.0, -3.0, 5.0, 3.5);
    add_box(walls, 1.0, 1.0, 2.0, 1.8);
    walls.push_back({-4.0, 0.5, -2.0, 0.5});
    walls.push_back({3.0, -3.0, 3.0, -1.5});
    walls.push_back({-1.0, 3.5, -0.3, 2.6});
    return walls;
}
const std::vector<Pose2> kAround{{.x_m = -1.0, .y_m = -1.0, .theta_rad = 0.0},
                                 {.x_m = -3.0, .y_m = 2.0, .theta_rad = 0.0},
                                 {.x_m = 3.5, .y_m = 2.0, .theta_rad = 0.0},
                                 {.x_m = 4.0, .y_m = -2.0, .theta_rad = 0.0}};

/// Two ways to be as symmetric as can be.
Walls square_with(bool landmark) {
    Walls walls = square_room(3.0);
    if (landmark) {
        add_box(walls, 1.2, 1.6, 2.0, 2.2);
        walls.push_back({-3.0, -1.0, -1.8, -1.0});
    }
    return walls;
}

double distance_m(const Pose2& a, const Pose2& b) {
    return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m);
}
double turn_deg(const Pose2& a, const Pose2& b) {
    return degrees(turn_between(a.theta_rad, b.theta_rad));
}
bool finite(const Relocalization& r) {
    return is_finite(r.P_map_base.x_m) && is_finite(r.P_map_base.y_m) && is_finite(r.P_map_base.theta_rad) &&
           is_finite(r.share) && is_finite(r.runner_up) && is_finite(r.P_map_runner_up.x_m);
}
bool same_bits(const Relocalization& a, const Relocalization& b) {
    return a.verdict == b.verdict && a.P_map_base == b.P_map_base && a.share == b.share &&
           a.P_map_runner_up == b.P_map_runner_up && a.runner_up == b.runner_up && a.hits == b.hits &&
           a.nodes == b.nodes && a.left_out == b.left_out;
}

}  // namespace

TEST_CASE("a robot is found in a room like no other, wherever it was put down") {
    const Walls walls = odd_room();
    const KnownPlace place(walls, kAround);
    Rng rng(3);
    for (int i = 0; i < 12; ++i) {
        const Pose2& near = kAround[static_cast<std::size_t>(i) % kAround.size()];
        const Pose2 truth{.x_m = near.x_m + uniform(rng, -0.5, 0.5),
                          .y_m = near.y_m + uniform(rng, -0.5, 0.5),
                          .theta_rad = kPi * rng.symmetric()};
        CAPTURE(i, truth.x_m, truth.y_m, truth.theta_rad);
        const Relocalization found = place.find(*scan_at(walls, truth));
        CHECK(found.verdict == PlaceVerdict::kFound);
        CHECK(distance_m(found.P_map_base, truth) < 0.1);
        CHECK(turn_deg(found.P_map_base, truth) < 1.5);
        CHECK(found.share > 0.8);
        CHECK(found.runner_up < found.share);
        CHECK(finite(found));
    }
}

TEST_CASE("the pose is told in the map's frame, however the rectangle lies in it") {
    const Walls walls = odd_room();
    KnownPlace place(walls, kAround);
    const auto points = scan_at(walls, kAround[0]);
    const Pose2 before = place.find(*points).P_map_base;
    const Pose2 moved{.x_m = 10.0, .y_m = -20.0, .theta_rad = 1.0};
    place.view.P_map_corner = moved * place.view.P_map_corner;
    REQUIRE(place.relocalizer->load(place.view, place.memory));
    const Pose2 after = place.find(*points).P_map_base;
    CHECK(distance_m(after, moved * before) < 1e-9);
    CHECK(turn_deg(after, moved * before) < 1e-9);
}

TEST_CASE("a robot is found at the very edge of the map, too") {
    const Walls walls = odd_room();
    KnownPlace place(walls, kAround);
    // The rectangle begins a cell below the lidar, which looks up, or ends a cell above it, and it looks down.
    const bool low = GENERATE(true, false);
    const Pose2 truth{.x_m = -1.0, .y_m = -1.0, .theta_rad = low ? kPi / 2.0 : -kPi / 2.0};
    const double lidar_y_m = (truth * kMounting).y_m;
    const std::int32_t row = floor_to_cell((lidar_y_m - place.view.P_map_corner.y_m) / kResolution_m);
    const auto width = static_cast<std::size_t>(place.view.width);
    if (low) {
        place.view.cells = place.view.cells.subspan(static_cast<std::size_t>(row - 1) * width);
        place.view.height -= row - 1;
        place.view.P_map_corner.y_m += (row - 1) * kResolution_m;
    } else {
        place.view.cells = place.view.cells.first(static_cast<std::size_t>(row + 2) * width);
        place.view.height = row + 2;
    }
    REQUIRE(place.relocalizer->load(place.view, place.memory));
    const Relocalization found = place.find(*scan_at(walls, truth));
    CAPTURE(low, found.share, found.runner_up);
    CHECK(found.verdict == PlaceVerdict::kFound);
    CHECK(distance_m(found.P_map_base, truth) < 0.1);
}

TEST_CASE("in a square room the place is ambiguous, and a landmark decides") {
    const Pose2 truth{.x_m = 0.8, .y_m = -0.4, .theta_rad = 0.4};
    const std::vector<Pose2> visited{{.x_m = -1.0, .y_m = 0.2, .theta_rad = 0.0},
                                     {.x_m = 1.0, .y_m = -1.0, .theta_rad = 0.0}};
    const KnownPlace square(square_with(false), visited);
    const Relocalization alike = square.find(*scan_at(square_with(false), truth));
    CHECK(alike.verdict == PlaceVerdict::kAmbiguous);
    CHECK(alike.runner_up > 0.9 * alike.share);
    // The place and its double are two of the four that a quarter turn maps onto each other.
    const auto is_image = [&](const Pose2& P) {
        Pose2 image = truth;
        for (int quarter = 0; quarter < 4; ++quarter) {
            if (distance_m(image, P) < 0.15 && turn_deg(image, P) < 2.0) {
                return true;
            }
            image = Pose2{.x_m = 0.0, .y_m = 0.0, .theta_rad = kPi / 2.0} * image;
        }
        return false;
    };
    CHECK(is_image(alike.P_map_base));
    CHECK(is_image(alike.P_map_runner_up));
    CHECK(distance_m(alike.P_map_base, alike.P_map_runner_up) > 0.5);

    const KnownPlace marked(square_with(true), visited);
    const Relocalization found = marked.find(*scan_at(square_with(true), truth));
    CHECK(found.verdict == PlaceVerdict::kFound);
    CHECK(distance_m(found.P_map_base, truth) < 0.1);
}

TEST_CASE("a scan of another place is not found") {
    const KnownPlace place(odd_room(), kAround);
    Walls narrow;
    for (int i = 0; i < 8; ++i) {
        add_box(narrow, -2.0 + 0.5 * i, 0.7 + 0.2 * (i % 3), -1.8 + 0.5 * i, 0.9 + 0.2 * (i % 3));
        add_box(narrow, -2.1 + 0.5 * i, -0.9 - 0.3 * (i % 2), -1.9 + 0.5 * i, -0.7 - 0.3 * (i % 2));
    }
    add_box(narrow, -12.0, -9.0, 11.0, 14.0);
    const Relocalization result = place.find(*scan_at(narrow, {}));
    CHECK(result.verdict == PlaceVerdict::kNotFound);
    CHECK(result.hits > 30);
    CHECK(result.share < 0.5);
}

TEST_CASE("where there is nothing to find the answer says so") {
    const Walls walls = odd_room();
    const auto points = scan_at(walls, kAround[0]);
    Relocalizer relocalizer({});
    relocalizer.begin(*points);
    CHECK(relocalizer.step(1000));
    CHECK(relocalizer.result().verdict == PlaceVerdict::kNoAnswer);  // no map

    const KnownPlace place(walls, kAround);
    const Relocalization blind = place.find(ScanPoints{});
    CHECK(blind.verdict == PlaceVerdict::kNoAnswer);
    CHECK(blind.hits == 0);
    CHECK(finite(blind));

    // Nothing seen, a single cell, and nothing but walls: nowhere to stand.
    const auto [side, evidence] = GENERATE(std::pair(200, kUnseen), std::pair(1, kUnseen), std::pair(1, kFreeCell),
                                           std::pair(1, kOccupiedCell), std::pair(100, kOccupiedCell));
    const std::vector<Evidence> cells(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), evidence);
    const MapView map{.cells = cells, .width = side, .height = side, .resolution_m = kResolution_m, .P_map_corner = {}};
    std::vector<std::uint8_t> memory(relocalizer.bytes_needed(map));
    REQUIRE(relocalizer.load(map, memory));
    relocalizer.begin(*points);
    while (!relocalizer.step(1000)) {
    }
    CHECK(relocalizer.result().verdict == PlaceVerdict::kNotFound);
    CHECK(relocalizer.result().share == 0.0);
    CHECK(finite(relocalizer.result()));
}

TEST_CASE("what is no map is refused, and a search without one gives no answer") {
    const std::vector<Evidence> cells(100, kFreeCell);
    MapView map{.cells = cells, .width = 10, .height = 10, .resolution_m = kResolution_m, .P_map_corner = {}};
    Relocalizer relocalizer({});
    std::vector<std::uint8_t> memory(relocalizer.bytes_needed(map));
    REQUIRE(relocalizer.load(map, memory));
    CHECK_FALSE(relocalizer.load(map, std::span(memory).first(memory.size() - 1)));
    relocalizer.begin(*scan_at(odd_room(), {}));
    CHECK(relocalizer.result().verdict == PlaceVerdict::kNoAnswer);  // the map before is forgotten
    map.resolution_m =
        GENERATE(0.0, -0.05, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity());
    CHECK_FALSE(relocalizer.load(map, memory));
    CHECK(relocalizer.bytes_needed(map) == 0);
}

TEST_CASE("the work is bounded, can be cut anywhere, and gives the same bits however it is cut") {
    const Walls walls = odd_room();
    const auto points = scan_at(walls, kAround[1]);
    const KnownPlace place(walls, kAround);
    const Relocalization whole = place.find(*points, 1'000'000'000);
    REQUIRE(whole.verdict == PlaceVerdict::kFound);

    const auto& relocalizer = place.relocalizer;
    relocalizer->begin(*points);
    CHECK_FALSE(relocalizer->step(1));
    CHECK(relocalizer->result().verdict == PlaceVerdict::kUnfinished);
    CHECK(relocalizer->result().nodes >= 1);
    CHECK(relocalizer->result().nodes < whole.nodes / 100);
    CHECK(same_bits(place.find(*points, 1), whole));  // after a search that was given up
    CHECK(same_bits(KnownPlace(walls, kAround).find(*points, 777), whole));

    RelocalizationParams few;
    few.nodes_max = whole.nodes / 2;
    const Relocalization stopped = KnownPlace(walls, kAround, few).find(*points);
    CHECK(stopped.verdict == PlaceVerdict::kNoAnswer);
    CHECK(stopped.nodes >= few.nodes_max);
    CHECK(stopped.nodes < few.nodes_max + 1000);
    few.nodes_max = whole.nodes + 1;
    CHECK(KnownPlace(walls, kAround, few).find(*points).verdict == PlaceVerdict::kFound);  // there it was the bound
}
