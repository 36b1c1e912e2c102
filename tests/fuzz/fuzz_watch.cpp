// Whatever stands at the control socket says to `crspf view`: an event that is taken can be gone through, and is what
// its type promises.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <variant>

#include "tools/view/watch_line.hpp"

namespace {

using crspf::TileImage;
using namespace crspf::view;

void demand(bool holds) {
    if (!holds) {
        std::abort();
    }
}

struct Promises {
    void operator()(const ScanEvent& scan) const {
        demand(std::isfinite(scan.P_map_base.x_m) && std::isfinite(scan.covariance.tt) && std::isfinite(scan.M));
        demand(scan.points.size() <= crspf::capacity::kBeams);
        for (const ScanEvent::Point& point : scan.points) {
            demand(std::isfinite(point.x_m) && std::isfinite(point.y_m));
        }
    }
    void operator()(const TilesEvent& tiles) const {
        demand(tiles.resolution_m > 0.0);
        for (const TileImage& tile : tiles.tiles) {
            demand(crspf::TileGeometry::inside(tile.corner) && crspf::TileGeometry::offset(tile.corner) == 0);
            demand(std::all_of(tile.cells.begin(), tile.cells.end(),
                               [](std::uint8_t cell) { return cell <= 100 || cell == TileImage::kUnseen; }));
        }
    }
    void operator()(const StatusEvent& event) const {
        demand(!event.status.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace).empty());
    }
    void operator()(const LogLine& line) const {
        demand(line.level >= LogLine::Level::kDebug && line.level <= LogLine::Level::kError);
    }
    void operator()(const AwayEvent& /*event*/) const { demand(false); }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes as text
    const std::string_view line(reinterpret_cast<const char*>(data), size);
    const WatchLine parsed = parse_watch_line(line);
    switch (parsed.kind) {
        case WatchLine::Kind::kEvent: std::visit(Promises{}, parsed.event); break;
        case WatchLine::Kind::kBad: demand(!parsed.text.empty()); break;
        case WatchLine::Kind::kWelcome:
        case WatchLine::Kind::kRefusal: break;
    }
    return 0;
}
