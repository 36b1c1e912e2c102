#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "core/slam/direct_match.hpp"
#include "core/slam/match_field.hpp"
#include "tests/unit/core/synthetic.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

constexpr double kCellsPerMetre = 50.0;
constexpr std::int32_t kHalf = TileGeometry::kHalf;
constexpr std::int32_t kSide = TileGeometry::kSide;

/// The inner sum of (10) times 3, straight from its definition.
int block_sum(const OccupancyMap& map, Cell c) {
    int sum = 0;
    for (int dy = -2; dy <= 2; ++dy) {
        for (int dx = -2; dx <= 2; ++dx) {
            const int ring = std::max(std::abs(dx), std::abs(dy));
            sum += (3 - ring) * pixel(map.at({.x = c.x + dx, .y = c.y + dy}));
        }
    }
    return sum;
}

/// Any evidence; the values that the rules treat apart come often.
Evidence random_evidence(Rng& rng) {
    const std::uint32_t kind = rng.next() % 6;
    if (kind == 0) {
        return kFreeCell;
    }
    if (kind == 1) {
        return kOccupiedCell;
    }
    return static_cast<Evidence>(whole(rng, 1, 255));
}

/// Points of a scan. [cells]
struct Points {
    std::vector<float> x = std::vector<float>(kPointLanes);  // the kernels may read that far past the last one
    std::vector<float> y = x;

    [[nodiscard]] FieldPoints view() const {
        return {.x = x.data(), .y = y.data(), .count = static_cast<std::uint32_t>(x.size()) - kPointLanes};
    }
    void add(double px, double py) {
        x.insert(x.end() - kPointLanes, static_cast<float>(px));
        y.insert(y.end() - kPointLanes, static_cast<float>(py));
    }
};

Points random_points(Rng& rng, std::int32_t most, double reach) {
    Points points;
    for (std::int32_t n = whole(rng, 0, most); n > 0; --n) {
        const double radius = reach * std::sqrt(uniform(rng, 0.0, 1.0));
        const double angle = uniform(rng, -kPi, kPi);
        points.add(radius * std::cos(angle), radius * std::sin(angle));
    }
    return points;
}

Cell cell_of(const Pose2& P) {
    return {.x = floor_to_cell(P.x_m * kCellsPerMetre), .y = floor_to_cell(P.y_m * kCellsPerMetre)};
}

}  // namespace

TEST_CASE("the field is the block sum of (10) in every cell, through all updates") {
    auto world = make_large<MapAndField>();
    Rng rng(51);
    const std::int32_t reach = 2 * kSide + 10;  // tile borders and the origin in the middle
    for (int round = 0; round < 4; ++round) {
        for (int i = 0; i < 20000; ++i) {
            world->set({.x = whole(rng, -reach, reach), .y = whole(rng, -reach, reach)}, random_evidence(rng));
        }
        long total = 0;
        long wrong = 0;
        for (std::int32_t y = -reach - 3; y <= reach + 3; ++y) {
            for (std::int32_t x = -reach - 3; x <= reach + 3; ++x) {
                const Cell c{.x = x, .y = y};
                wrong += world->field().at(c) != block_sum(world->map(), c) ? 1 : 0;
                wrong += world->field().seen(c) != (world->map().at(c) != kUnseen) ? 1 : 0;
                total += world->field().at(c);
            }
        }
        CAPTURE(round);
        CHECK(wrong == 0);
        CHECK(total > 0);
    }
}

TEST_CASE("a cell that is set to unknown again takes its part of the field back") {
    auto world = make_large<MapAndField>();
    world->set({.x = 0, .y = 0}, 200);
    CHECK(world->field().at({.x = 0, .y = 0}) == 600);
    CHECK(world->field().at({.x = 1, .y = -1}) == 400);
    CHECK(world->field().at({.x = -2, .y = 1}) == 200);
    CHECK(world->field().at({.x = 3, .y = 0}) == 0);
    world->set({.x = 0, .y = 0}, kFreeCell);
    for (std::int32_t d = -3; d <= 3; ++d) {
        CHECK(world->field().at({.x = d, .y = d}) == 0);
    }
}

TEST_CASE("a full block is the largest value, and it does not touch the seen flag") {
    auto world = make_large<MapAndField>();
    for (std::int32_t y = -2; y <= 2; ++y) {
        for (std::int32_t x = -2; x <= 2; ++x) {
            world->set({.x = x, .y = y}, kOccupiedCell);
        }
    }
    CHECK(world->field().at({.x = 0, .y = 0}) == kFieldMax);
    CHECK(kMatchMax == Approx(2975.0));
    CHECK(world->field().seen({.x = 0, .y = 0}));
    CHECK(world->field().at({.x = 3, .y = 0}) > 0);
    CHECK_FALSE(world->field().seen({.x = 3, .y = 0}));
}

TEST_CASE("at the map's edge the field keeps what lies inside") {
    auto world = make_large<MapAndField>();
    for (const std::int32_t x : {-kHalf, kHalf - 1}) {
        for (const std::int32_t y : {-kHalf, kHalf - 1}) {
            world->set({.x = x, .y = y}, 100);
        }
    }
    for (const std::int32_t edge_x : {-kHalf, kHalf - 4}) {
        for (const std::int32_t edge_y : {-kHalf, kHalf - 4}) {
            for (std::int32_t d = 0; d < 16; ++d) {
                const Cell c{.x = edge_x + d % 4, .y = edge_y + d / 4};
                CHECK(world->field().at(c) == block_sum(world->map(), c));
            }
        }
    }
    CHECK(world->field().tiles().refused() > 0);
    world->set({.x = -kHalf, .y = -kHalf}, kFreeCell);
    CHECK(world->field().at({.x = -kHalf + 1, .y = -kHalf + 1}) == 0);
}

TEST_CASE("m by the field is (10) evaluated directly, bit for bit") {
    auto world = make_large<MapAndField>();
    Rng rng(52);
    double largest = 0.0;
    for (int round = 0; round < 40; ++round) {
        // Each round's updates lie somewhere else, most of them over a corner of tiles.
        const Cell middle{.x = whole(rng, -40, 40) * kSide, .y = whole(rng, -40, 40) * kSide};
        for (int i = 0; i < 8000; ++i) {
            world->set({.x = middle.x + whole(rng, -70, 70), .y = middle.y + whole(rng, -70, 70)},
                       random_evidence(rng));
        }
        for (int k = 0; k < 100; ++k) {
            const Pose2 P{.x_m = (middle.x + uniform(rng, -70.0, 70.0)) / kCellsPerMetre,
                          .y_m = (middle.y + uniform(rng, -70.0, 70.0)) / kCellsPerMetre,
                          .theta_rad = uniform(rng, -kPi, kPi)};
            const Points critical = random_points(rng, 9, 60.0);
            const Points ordinary = random_points(rng, 50, 90.0);
            const double weight = uniform(rng, 1.0, 10.0);
            const double weight_sum = weight * critical.view().count + ordinary.view().count;
            if (!(weight_sum > 0.0)) {
                continue;
            }
            const double direct =
                direct_match(world->map(), critical.view(), ordinary.view(), weight, P, kCellsPerMetre);
            FieldView view;
            REQUIRE(world->field().view_around(cell_of(P), view));
            const FieldPose pose = view.place(P, kCellsPerMetre);
            for (const Kernel kernel : {Kernel::kPortable, Kernel::kFastest}) {
                const FieldSum sum = field_sum_kernel(kernel);
                const double m =
                    (weight * sum(view, critical.view(), pose) + sum(view, ordinary.view(), pose)) / (3.0 * weight_sum);
                CAPTURE(round, k, P.x_m, P.y_m, P.theta_rad);
                REQUIRE(m == direct);
            }
            largest = std::max(largest, direct);
        }
    }
    CHECK(largest > 100.0);  // the poses did see something
}

TEST_CASE("(10) on a map that can be reckoned by hand") {
    auto world = make_large<MapAndField>();
    world->set({.x = 10, .y = 20}, 255);
    Points critical;
    Points ordinary;
    critical.add(10.5, 0.5);  // hits the cell itself: 255
    ordinary.add(12.5, 0.5);  // two cells beside it: 255 / 3
    ordinary.add(30.5, 0.5);  // nothing
    const Pose2 P{.y_m = 20.0 / kCellsPerMetre};
    const double expected = (5.0 * 255.0 + 255.0 / 3.0 + 0.0) / (5.0 + 1.0 + 1.0);
    CHECK(direct_match(world->map(), critical.view(), ordinary.view(), 5.0, P, kCellsPerMetre) == Approx(expected));
    CHECK(direct_match(world->map(), {}, {}, 5.0, P, kCellsPerMetre) == 0.0);
}

TEST_CASE("the vector kernel gives the portable kernel's sums") {
    const FieldSum vector_sum = field_sum_kernel(Kernel::kFastest);
    if (vector_sum == &field_sum_portable) {
        WARN("skipped: there is no vector kernel for this processor");
        return;
    }
    auto world = make_large<MapAndField>();
    Rng rng(53);
    // Obstacles around the robot and at the window's very edge; more would use up the tiles.
    for (int i = 0; i < 120000; ++i) {
        const double radius = i % 2 == 0 ? MatchField::kReach * uniform(rng, 0.98, 1.0) : uniform(rng, 0.0, 150.0);
        const double angle = uniform(rng, -kPi, kPi);
        world->set({.x = static_cast<std::int32_t>(radius * std::cos(angle)),
                    .y = static_cast<std::int32_t>(radius * std::sin(angle))},
                   random_evidence(rng));
    }
    REQUIRE(world->field().tiles().refused() == 0);
    std::uint64_t total = 0;
    SECTION("any count of points") {
        for (std::int32_t count = 0; count <= 67; ++count) {
            for (int k = 0; k < 20; ++k) {
                Points points;
                for (std::int32_t i = 0; i < count; ++i) {
                    points.add(uniform(rng, -100.0, 100.0), uniform(rng, -100.0, 100.0));
                }
                const Pose2 P{.x_m = rng.symmetric(), .y_m = rng.symmetric(), .theta_rad = uniform(rng, -kPi, kPi)};
                FieldView view;
                REQUIRE(world->field().view_around(cell_of(P), view));
                const FieldPose pose = view.place(P, kCellsPerMetre);
                const std::uint32_t expected = field_sum_portable(view, points.view(), pose);
                CAPTURE(count, k);
                REQUIRE(vector_sum(view, points.view(), pose) == expected);
                total += expected;
            }
        }
        CHECK(total > 0);
    }
    SECTION("points at the limit of the window, and a full scan of them") {
        for (int k = 0; k < 50; ++k) {
            Points points;
            for (std::size_t i = 0; i < capacity::kBeams - 3; ++i) {
                const double angle = uniform(rng, -kPi, kPi);
                const double radius = MatchField::kReach * uniform(rng, 0.995, 0.99999);
                points.add(radius * std::cos(angle), radius * std::sin(angle));
            }
            const Pose2 P{
                .x_m = 0.6 * rng.symmetric(), .y_m = 0.6 * rng.symmetric(), .theta_rad = uniform(rng, -kPi, kPi)};
            FieldView view;
            REQUIRE(world->field().view_around(cell_of(P), view));
            const FieldPose pose = view.place(P, kCellsPerMetre);
            const std::uint32_t expected = field_sum_portable(view, points.view(), pose);
            REQUIRE(vector_sum(view, points.view(), pose) == expected);
            REQUIRE(direct_match(world->map(), {}, points.view(), 1.0, P, kCellsPerMetre) ==
                    static_cast<double>(expected) / (3.0 * static_cast<double>(points.view().count)));
            total += expected;
        }
        CHECK(total > 0);
    }
    SECTION("points on the borders of cells") {
        for (int k = 0; k < 200; ++k) {
            Points points;
            for (int i = 0; i < 61; ++i) {
                points.add(whole(rng, -90, 90), whole(rng, -90, 90));
            }
            const double quarter = whole(rng, 0, 3) * 0.5 * kPi;
            const Pose2 P{
                .x_m = 0.02 * whole(rng, -70, 70), .y_m = 0.02 * whole(rng, -70, 70), .theta_rad = wrap_angle(quarter)};
            FieldView view;
            REQUIRE(world->field().view_around(cell_of(P), view));
            const FieldPose pose = view.place(P, kCellsPerMetre);
            REQUIRE(vector_sum(view, points.view(), pose) == field_sum_portable(view, points.view(), pose));
        }
    }
    SECTION("numbers that are too small for some processors' vectors, beside others") {
        // 32-bit ARM's take what is below 2^-126 for zero: coordinates, sines or only their products.
        constexpr double kSmall[] = {0.0, 1e-45, 3e-42, 1e-38, 2e-38, 1e-36, 1e-31, 1e-30, 1e-19, 1e-8, 0.5, 90.0};
        for (const double pose_sin : kSmall) {
            Points points;
            for (const double px : kSmall) {
                for (const double py : kSmall) {
                    points.add(px, py);
                    points.add(-px, py);
                    points.add(px, -py);
                }
            }
            FieldView view;
            REQUIRE(world->field().view_around({}, view));
            for (const double sign : {-1.0, 1.0}) {
                FieldPose pose = view.place({}, kCellsPerMetre);
                pose.sin = static_cast<float>(sign * std::min(pose_sin, 1.0));
                CAPTURE(pose.sin);
                REQUIRE(vector_sum(view, points.view(), pose) == field_sum_portable(view, points.view(), pose));
                std::swap(pose.cos, pose.sin);
                REQUIRE(vector_sum(view, points.view(), pose) == field_sum_portable(view, points.view(), pose));
                total += vector_sum(view, points.view(), pose);
            }
        }
        CHECK(total > 0);
    }
}

TEST_CASE("where a processor may have a vector kernel it is taken") {
#if defined(__x86_64__)
    const bool avx2 = static_cast<bool>(__builtin_cpu_supports("avx2"));
    CHECK((field_sum_kernel(Kernel::kFastest) == &field_sum_avx2) == avx2);
#elif defined(__ARM_NEON)
    CHECK(field_sum_kernel(Kernel::kFastest) == &field_sum_neon);
#else
    CHECK(field_sum_kernel(Kernel::kFastest) == &field_sum_portable);
#endif
}

TEST_CASE("the portable kernel can be asked for") {
    CHECK(field_sum_kernel(Kernel::kPortable) == &field_sum_portable);
}

TEST_CASE("a view is given exactly where its window fits the map's extent") {
    auto field = make_large<MatchField>();
    FieldView view;
    constexpr std::int32_t kHalfWindow = FieldView::kTiles / 2 * kSide;
    CHECK(field->view_around({.x = 0, .y = 0}, view));
    CHECK(field->view_around({.x = -kHalf + kHalfWindow, .y = 0}, view));
    CHECK_FALSE(field->view_around({.x = -kHalf + kHalfWindow - 1, .y = 0}, view));
    CHECK(field->view_around({.x = 0, .y = kHalf - kHalfWindow}, view));
    CHECK_FALSE(field->view_around({.x = 0, .y = kHalf - kHalfWindow + kSide}, view));
    CHECK_FALSE(field->view_around({.x = kHalf - 1, .y = 0}, view));
    CHECK_FALSE(field->view_around({.x = 0, .y = -kHalf}, view));

    SECTION("and reads the cells that the field has there") {
        auto world = make_large<MapAndField>();
        Rng rng(54);
        const Cell robot{.x = -kHalf + kHalfWindow, .y = kHalf - kHalfWindow};
        for (int i = 0; i < 3000; ++i) {
            world->set({.x = robot.x + whole(rng, -150, 150), .y = robot.y + whole(rng, -150, 150)},
                       random_evidence(rng));
        }
        REQUIRE(world->field().view_around(robot, view));
        for (std::int32_t d = 0; d < 300 * 300; ++d) {
            const Cell c{.x = robot.x - 150 + d % 300, .y = robot.y - 150 + d / 300};
            REQUIRE(view.value(c.x - view.corner.x, c.y - view.corner.y) == world->field().at(c));
        }
    }
}
