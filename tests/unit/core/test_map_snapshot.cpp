#include <catch2/catch.hpp>
#include <vector>

#include "core/slam/map_snapshot.hpp"
#include "tests/unit/core/synthetic.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

/// Evidence here and there over five tiles, below and above the origin.
std::unique_ptr<MapAndField> scattered() {
    auto out = make_large<MapAndField>();
    Rng rng(7);
    for (int i = 0; i < 2000; ++i) {
        out->set({.x = whole(rng, -100, 90), .y = whole(rng, -30, 60)}, static_cast<Evidence>(whole(rng, 1, 255)));
    }
    out->set({.x = 200, .y = 140}, kFreeCell);
    return out;
}

}  // namespace

TEST_CASE("the copy holds every cell of the map, whatever the slices") {
    const auto place = scattered();
    const std::size_t slice = GENERATE(1U, 3U, 1000U);
    MapCopier copier;
    REQUIRE_FALSE(copier.begin(place->map(), {}));
    std::vector<Evidence> memory(copier.bytes_needed() + 1, Evidence{77});
    REQUIRE(copier.begin(place->map(), memory));
    std::size_t slices = 1;
    while (!copier.step(place->map(), slice)) {
        ++slices;
    }
    CHECK(slices == (copier.bytes_needed() / TileGeometry::kCells + slice - 1) / slice);
    CHECK(memory.back() == 77);

    constexpr double kResolution_m = 0.05;
    const MapView view = copier.view(kResolution_m);
    REQUIRE(view.cells.size() == copier.bytes_needed());
    const Cell corner{.x = floor_to_cell(view.P_map_corner.x_m / kResolution_m + 0.5),
                      .y = floor_to_cell(view.P_map_corner.y_m / kResolution_m + 0.5)};
    int seen = 0;
    bool same = true;
    for (std::int32_t y = -10; y < view.height + 10; ++y) {
        for (std::int32_t x = -10; x < view.width + 10; ++x) {
            same = same && view.at(x, y) == place->map().at({.x = corner.x + x, .y = corner.y + y});
            seen += view.at(x, y) != kUnseen ? 1 : 0;
        }
    }
    CHECK(same);
    CHECK(seen > 1500);
    CHECK(place->map().at({.x = 200, .y = 140}) == view.at(200 - corner.x, 140 - corner.y));
}

TEST_CASE("a map that does not fit is refused, and says what it needs") {
    const auto place = scattered();
    MapCopier copier;
    std::vector<Evidence> memory(5 * TileGeometry::kCells);
    CHECK_FALSE(copier.begin(place->map(), memory));
    CHECK(copier.bytes_needed() == 6 * 4 * TileGeometry::kCells);
    CHECK(copier.step(place->map(), 100));  // nothing to copy
    CHECK(copier.view(0.05).cells.empty());
}

TEST_CASE("nothing drawn is no map") {
    const auto empty = make_large<MapAndField>();
    MapCopier copier;
    std::vector<Evidence> memory(TileGeometry::kCells);
    CHECK_FALSE(copier.begin(empty->map(), memory));
    CHECK(copier.bytes_needed() == 0);
}
