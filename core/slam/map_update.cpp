#include "core/slam/map_update.hpp"

#include <algorithm>

#include "core/base/real.hpp"

namespace crspf {
namespace {

constexpr int kBlockShift = OccupancyTile::kBlockShift;
constexpr std::int32_t kCoarseSide = 1 << kBlockShift;

}  // namespace

void MapUpdate::draw(const ScanPoints& points, const Pose2& P_map_base, bool key_frame, ChangeList& changes) {
    ++counters_.drawn;
    const bool clean = key_frame && params_.remove_errors;
    if (clean) {
        ++counters_.cleaned;
        mark_passable(points);
    }
    const double scale = 1.0 / params_.resolution_m;
    const SinCos r = sin_cos(P_map_base.theta_rad);
    const Pose2& first = points.P_base_first_lidar;
    const Pose2& last = points.P_base_last_lidar;
    const double per_beam = points.beams > 0 ? 1.0 / static_cast<double>(points.beams) : 0.0;
    const auto ray_to = [&](double u, double x_m, double y_m, double cleared) {
        const double from_x_m = first.x_m + u * (last.x_m - first.x_m);
        const double from_y_m = first.y_m + u * (last.y_m - first.y_m);
        return Ray{.from_x = (P_map_base.x_m + (r.cos * from_x_m - r.sin * from_y_m)) * scale,
                   .from_y = (P_map_base.y_m + (r.sin * from_x_m + r.cos * from_y_m)) * scale,
                   .to_x = (P_map_base.x_m + (r.cos * x_m - r.sin * y_m)) * scale,
                   .to_y = (P_map_base.y_m + (r.sin * x_m + r.cos * y_m)) * scale,
                   .cleared = cleared};
    };
    // Near the lidar many rays cross the same cells. Every second ray begins where the others are a cell apart, every
    // second of those at half that range, and so on: a scan crosses a cell about once, however dense it is.
    const double apart_m =
        points.angle_increment_rad > 0.0 ? 0.5 * params_.resolution_m / points.angle_increment_rad : 0.0;
    Cell previous_hit;
    for (std::uint32_t i = 0; i < points.count; ++i) {
        const auto range_m = static_cast<double>(points.range_m[i]);
        const double cleared = clean ? static_cast<double>(passable_m_[i]) / range_m : 0.0;
        Ray ray = ray_to(static_cast<double>(points.beam[i]) * per_beam, static_cast<double>(points.x_m[i]),
                         static_cast<double>(points.y_m[i]), cleared);
        const Cell hit{.x = floor_to_cell(ray.to_x), .y = floor_to_cell(ray.to_y)};
        if (i == 0 || hit != previous_hit) {
            mark_hit(ray, hit, params_.resolution_m / range_m, changes);
            previous_hit = hit;
        }
        const double skipped = apart_m / (static_cast<double>(i & (~i + 1U)) * range_m);
        if (i > 0 && skipped < 1.0) {
            ray.from_x += skipped * (ray.to_x - ray.from_x);
            ray.from_y += skipped * (ray.to_y - ray.from_y);
            ray.cleared = std::max(cleared - skipped, 0.0) / (1.0 - skipped);
        }
        if (i == 0 || skipped < 1.0) {
            trace_free(ray, changes);
        }
    }
    for (std::uint32_t i = 0; i < points.clear_count; ++i) {
        const auto known_m = static_cast<double>(points.clear_m[i]);
        const double clear_m = known_m > 0.0 ? known_m : params_.no_return_clear_m;
        if (clear_m > 0.0) {
            const double u = static_cast<double>(points.clear_beam[i]) * per_beam;
            const double from_x_m = first.x_m + u * (last.x_m - first.x_m);
            const double from_y_m = first.y_m + u * (last.y_m - first.y_m);
            trace_free(ray_to(u, from_x_m + clear_m * (static_cast<double>(points.clear_x_m[i]) - from_x_m),
                              from_y_m + clear_m * (static_cast<double>(points.clear_y_m[i]) - from_y_m), 0.0),
                       changes);
        }
    }
}

void MapUpdate::set(Cell cell, Evidence evidence, ChangeList& changes) {
    if (auto* tile = map_.touch(cell)) {
        write(*tile, cell, evidence, changes);
    }
}

void MapUpdate::restore(Cell corner, const TileCells& cells, ChangeList& changes) {
    OccupancyTile* const tile = map_.touch(corner);
    if (tile == nullptr) {
        return;  // counted by the map
    }
    TileChange& change = changes.add_tile();
    change.corner = corner;
    change.gone = false;
    for (std::int32_t y = 0; y < TileGeometry::kSide; ++y) {
        for (std::int32_t x = 0; x < TileGeometry::kSide; ++x) {
            const Cell cell{.x = corner.x + x, .y = corner.y + y};
            const std::size_t at = TileGeometry::offset(cell);
            const bool gains = tile->cells[at] == kUnseen && cells[at] != kUnseen;
            change.cells[at] = gains ? cells[at] : kUnseen;
            if (gains) {
                tile->cells[at] = cells[at];
                std::uint16_t& free = tile->free_cells[OccupancyTile::block(cell)];
                free = static_cast<std::uint16_t>(free + (cells[at] == kFreeCell ? 1 : 0));
            }
        }
    }
}

void MapUpdate::forget(Cell corner, ChangeList& changes) {
    if (const OccupancyTile* const tile = map_.find(corner)) {
        TileChange& change = changes.add_tile();
        change.corner = corner;
        change.gone = true;
        change.cells = tile->cells;
        map_.release(corner);
    }
}

void MapUpdate::mark_passable(const ScanPoints& points) {
    const std::uint32_t n = points.count;
    const double margin_m = params_.erosion_m + 3.0 * range_noise_m_;
    for (std::uint32_t i = 0; i < n; ++i) {
        const auto own_m = static_cast<double>(points.range_m[i]);
        passable_m_[i] = 0.0F;
        if (own_m > params_.stable_range_m) {
            continue;
        }
        // Erosion sideways: the nearest obstacle among the beams that pass within the erosion's distance of this ray.
        constexpr double kWidest = 16.0;
        const double reach = params_.erosion_m / (own_m * points.angle_increment_rad + 1e-9);
        const auto width = static_cast<std::uint32_t>(std::min(reach, kWidest)) + 1;
        float nearest = points.range_m[i];
        for (std::uint32_t j = i > width ? i - width : 0; j < std::min(i + width + 1, n); ++j) {
            nearest = std::min(nearest, points.range_m[j]);
        }
        passable_m_[i] = static_cast<float>(std::max(static_cast<double>(nearest) - margin_m, 0.0));
    }
}

void MapUpdate::write(OccupancyTile& tile, Cell cell, Evidence after, ChangeList& changes) {
    Evidence& value = tile.cells[TileGeometry::offset(cell)];
    if (value == after || !changes.add({.cell = cell, .before = value, .after = after})) {
        return;
    }
    std::uint16_t& free = tile.free_cells[OccupancyTile::block(cell)];
    free = static_cast<std::uint16_t>(free + (after == kFreeCell ? 1 : 0) - (value == kFreeCell ? 1 : 0));
    value = after;
}

void MapUpdate::trace_free(const Ray& ray, ChangeList& changes) {
    const double dx = ray.to_x - ray.from_x;
    const double dy = ray.to_y - ray.from_y;
    if (absolute(dy) > absolute(dx)) {
        trace_line<true>({.from_major = ray.from_y, .from_minor = ray.from_x, .major = dy, .minor = dx}, ray.cleared,
                         changes);
    } else {
        trace_line<false>({.from_major = ray.from_x, .from_minor = ray.from_y, .major = dx, .minor = dy}, ray.cleared,
                          changes);
    }
}

template <bool Steep>
void MapUpdate::trace_line(const Line& line, double cleared_share, ChangeList& changes) {
    const std::int32_t first = floor_to_cell(line.from_major);
    const std::int32_t last = floor_to_cell(line.from_major + line.major);
    const std::int32_t step = last >= first ? 1 : -1;
    const std::int32_t steps = (last - first) * step;  // the hit's own cell is not crossed
    if (steps == 0) {
        return;
    }
    // The minor coordinate, in 2^-16 of a cell, in the middle of each cell along the major one.
    constexpr int kFraction = 16;
    constexpr double kFixed = 1 << kFraction;
    const double slope = line.minor / line.major;
    const double start = line.from_minor + (static_cast<double>(first) + 0.5 - line.from_major) * slope;
    auto at = static_cast<std::int64_t>(start * kFixed);
    const auto increment = static_cast<std::int64_t>(slope * static_cast<double>(step) * kFixed);
    const auto cleared = static_cast<std::int32_t>(static_cast<double>(steps) * cleared_share);
    const auto cell_at = [](std::int32_t a, std::int64_t fixed) {
        const auto across = static_cast<std::int32_t>(fixed >> kFraction);
        return Steep ? Cell{.x = across, .y = a} : Cell{.x = a, .y = across};
    };
    std::int32_t along = first;
    std::int32_t k = 0;
    while (k < steps) {
        // A run: the rest of the way through a block along the major coordinate. The minor one moves by less than a
        // block meanwhile, so a run touches two blocks and two tiles at most.
        const std::int32_t within = along & (kCoarseSide - 1);
        const std::int32_t run = std::min(step > 0 ? kCoarseSide - within : within + 1, steps - k);
        const Cell begin = cell_at(along, at);
        const Cell end = cell_at(along + (run - 1) * step, at + (run - 1) * increment);
        OccupancyTile* tile = map_.touch(begin);
        const bool one_tile = ((begin.x ^ end.x) | (begin.y ^ end.y)) >> TileGeometry::kShift == 0;
        OccupancyTile* end_tile = one_tile ? tile : map_.touch(end);
        if (tile == nullptr || end_tile == nullptr) {
            return;  // counted by the map
        }
        const bool all_free = tile->free_cells[OccupancyTile::block(begin)] == OccupancyTile::kBlockCells &&
                              end_tile->free_cells[OccupancyTile::block(end)] == OccupancyTile::kBlockCells;
        if (all_free) {
            k += run;
            along += run * step;
            at += run * increment;
            continue;
        }
        for (const std::int32_t run_end = k + run; k < run_end; ++k, along += step, at += increment) {
            const Cell cell = cell_at(along, at);
            OccupancyTile* home = tile;
            if (!one_tile && ((cell.x ^ begin.x) | (cell.y ^ begin.y)) >> TileGeometry::kShift != 0) {
                home = end_tile;
            }
            const Evidence before = home->cells[TileGeometry::offset(cell)];
            if (before != kFreeCell) {
                lower(*home, cell, before, k < cleared, changes);
            }
        }
    }
}

[[gnu::noinline]] void MapUpdate::lower(OccupancyTile& tile, Cell cell, Evidence before, bool outright,
                                        ChangeList& changes) {
    if (outright && before != kUnseen) {
        ++counters_.cells_erased;
    }
    const bool to_free = outright || before == kUnseen;
    const int lowered = to_free ? int{kFreeCell} : std::max<int>(before - params_.pass, kFreeCell);
    write(tile, cell, static_cast<Evidence>(lowered), changes);
}

void MapUpdate::mark_hit(const Ray& ray, Cell hit, double per_cell, ChangeList& changes) {
    auto* tile = map_.touch(hit);
    if (tile == nullptr) {
        return;  // counted by the map
    }
    const double x = (ray.to_x - ray.from_x) * per_cell;
    const double y = (ray.to_y - ray.from_y) * per_cell;
    for (int cells = 1; cells <= params_.behind_cells; ++cells) {
        const Cell behind{.x = floor_to_cell(ray.to_x + x * cells), .y = floor_to_cell(ray.to_y + y * cells)};
        if (behind == hit) {
            continue;
        }
        const bool same_tile = ((behind.x ^ hit.x) | (behind.y ^ hit.y)) >> TileGeometry::kShift == 0;
        const Evidence before = same_tile ? tile->cells[TileGeometry::offset(behind)] : map_.at(behind);
        if (before > kFreeCell) {
            if (OccupancyTile* const home = same_tile ? tile : map_.touch(behind)) {
                lower(*home, behind, before, false, changes);
            }
        }
    }
    const int raised = std::min<int>(tile->cells[TileGeometry::offset(hit)] + params_.hit, kOccupiedCell);
    write(*tile, hit, static_cast<Evidence>(raised), changes);
}

}  // namespace crspf
