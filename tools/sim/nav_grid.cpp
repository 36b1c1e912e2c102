#include "tools/sim/nav_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <queue>
#include <string>
#include <utility>

#include "platform/files/input_error.hpp"

namespace crspf::sim {
namespace {

constexpr double kCell_m = 0.1;
constexpr double kComfort_m = 0.4;   // room beside the body beyond which more room is no better
constexpr double kDiscomfort = 3.0;  // how much longer a way may be to get that room
constexpr double kSnap_m = 0.5;
constexpr std::uint32_t kStraight = 100;  // cost of a step, in hundredths of a cell
constexpr std::uint32_t kDiagonal = 141;

}  // namespace

NavGrid::NavGrid(const World& world, Point start, double radius_m) : world_(&world), radius_m_(radius_m) {
    columns_ = static_cast<std::uint32_t>(std::ceil((world.upper().x_m - world.lower().x_m) / kCell_m));
    rows_ = static_cast<std::uint32_t>(std::ceil((world.upper().y_m - world.lower().y_m) / kCell_m));
    const std::size_t count = static_cast<std::size_t>(columns_) * rows_;
    clearance_m_.resize(count);
    for (std::uint32_t cell = 0; cell < count; ++cell) {
        clearance_m_[cell] = static_cast<float>(world.clearance(centre(cell), radius_m + kComfort_m));
    }
    reachable_.assign(count, 0);

    std::vector<std::uint32_t> open;
    const auto reach = [&](std::uint32_t cell) {
        if (reachable_[cell] == 0 && static_cast<double>(clearance_m_[cell]) >= radius_m_) {
            reachable_[cell] = 1;
            open.push_back(cell);
        }
    };
    if (const std::uint32_t first = cell_at(start); first != kNone) {
        reach(first);
    }
    while (!open.empty()) {
        const std::uint32_t cell = open.back();
        open.pop_back();
        reachable_cells_.push_back(cell);
        for_each_neighbour(cell, [&](std::uint32_t next, std::uint32_t) { reach(next); });
    }
    if (reachable_cells_.empty()) {
        char text[160];
        std::snprintf(text, sizeof text,
                      "--start %.2f,%.2f: less than %.2f m from a wall, or outside; start the robot in the open",
                      start.x_m, start.y_m, radius_m);
        throw InputError(text);
    }
    std::sort(reachable_cells_.begin(), reachable_cells_.end());
}

Point NavGrid::centre(std::uint32_t cell) const {
    const std::uint32_t column = cell % columns_;
    const std::uint32_t row = cell / columns_;
    return {world_->lower().x_m + (column + 0.5) * kCell_m, world_->lower().y_m + (row + 0.5) * kCell_m};
}

std::uint32_t NavGrid::cell_at(Point p) const {
    const double column = std::floor((p.x_m - world_->lower().x_m) / kCell_m);
    const double row = std::floor((p.y_m - world_->lower().y_m) / kCell_m);
    if (!(column >= 0.0 && row >= 0.0 && column < columns_ && row < rows_)) {
        return kNone;
    }
    return static_cast<std::uint32_t>(row) * columns_ + static_cast<std::uint32_t>(column);
}

template <typename Visit>
void NavGrid::for_each_neighbour(std::uint32_t cell, Visit visit) const {
    // Walls lie at least 1 m inside the grid's edge, so a cell that a body reaches has all its neighbours.
    for (const std::uint32_t up : {cell - columns_, cell, cell + columns_}) {
        for (const std::uint32_t next : {up - 1, up, up + 1}) {
            if (next != cell) {
                const bool straight = up == cell || next == up;
                visit(next, straight ? kStraight : kDiagonal);
            }
        }
    }
}

bool NavGrid::reachable(Point p) const {
    const std::uint32_t cell = cell_at(p);
    return cell != kNone && reachable_[cell] != 0;
}

std::uint32_t NavGrid::nearest_reachable(Point p) const {
    if (reachable(p)) {
        return cell_at(p);
    }
    std::uint32_t best = kNone;
    double best_m = kSnap_m;
    for (const std::uint32_t cell : reachable_cells_) {
        if (const double apart_m = distance(p, centre(cell)); apart_m < best_m) {
            best_m = apart_m;
            best = cell;
        }
    }
    return best;
}

Point NavGrid::random_place(Random& random) const {
    return centre(reachable_cells_[random.index(static_cast<std::uint32_t>(reachable_cells_.size()))]);
}

std::vector<Point> NavGrid::spread_places(std::size_t count, Random& random) const {
    std::vector<Point> places;
    while (places.size() < count) {
        Point best;
        double best_m = -1.0;
        for (int candidate = 0; candidate < 8; ++candidate) {
            const Point p = random_place(random);
            double nearest_m = 1e9;
            for (const Point other : places) {
                nearest_m = std::min(nearest_m, distance(p, other));
            }
            if (nearest_m > best_m) {
                best_m = nearest_m;
                best = p;
            }
        }
        places.push_back(best);
    }
    return places;
}

// A*: the straight way over open floor is the estimate.
std::vector<Point> NavGrid::plan(Point from, Point to) const {
    const std::uint32_t first = nearest_reachable(from);
    const std::uint32_t goal = nearest_reachable(to);
    if (first == kNone || goal == kNone) {
        return {};
    }
    const auto estimate = [&](std::uint32_t cell) {
        const auto apart = [](std::uint32_t a, std::uint32_t b) { return a < b ? b - a : a - b; };
        const std::uint32_t dc = apart(cell % columns_, goal % columns_);
        const std::uint32_t dr = apart(cell / columns_, goal / columns_);
        return kStraight * std::max(dc, dr) + (kDiagonal - kStraight) * std::min(dc, dr);
    };
    std::vector<std::uint32_t> cost(reachable_.size(), UINT32_MAX);
    std::vector<std::uint32_t> parent(reachable_.size(), kNone);
    using Entry = std::pair<std::uint32_t, std::uint32_t>;  // estimated total, cell
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    cost[first] = 0;
    open.emplace(estimate(first), first);
    while (!open.empty()) {
        const std::uint32_t total = open.top().first;
        const std::uint32_t cell = open.top().second;
        open.pop();
        if (cell == goal) {
            break;
        }
        if (total > cost[cell] + estimate(cell)) {
            continue;  // a shorter way to it was found meanwhile
        }
        for_each_neighbour(cell, [&](std::uint32_t next, std::uint32_t step) {
            if (reachable_[next] == 0) {
                return;
            }
            const double room = (static_cast<double>(clearance_m_[next]) - radius_m_) / kComfort_m;
            const double factor = 1.0 + kDiscomfort * std::max(0.0, 1.0 - room);
            const std::uint32_t through = cost[cell] + static_cast<std::uint32_t>(step * factor);
            if (through < cost[next]) {
                cost[next] = through;
                parent[next] = cell;
                open.emplace(through + estimate(next), next);
            }
        });
    }
    std::vector<Point> path;
    for (std::uint32_t cell = goal; cell != kNone; cell = parent[cell]) {
        path.push_back(centre(cell));
    }
    std::reverse(path.begin(), path.end());
    return smooth(std::move(path));
}

// Each point moves to the mean of its neighbourhood unless that brings it too near a wall.
std::vector<Point> NavGrid::smooth(std::vector<Point> path) const {
    constexpr int kPasses = 4;
    constexpr std::size_t kReach = 3;
    for (int pass = 0; pass < kPasses; ++pass) {
        const std::vector<Point> before = path;
        for (std::size_t i = 1; i + 1 < path.size(); ++i) {
            const std::size_t reach = std::min({i, path.size() - 1 - i, kReach});
            Point mean;
            for (std::size_t k = i - reach; k <= i + reach; ++k) {
                mean.x_m += before[k].x_m / static_cast<double>(2 * reach + 1);
                mean.y_m += before[k].y_m / static_cast<double>(2 * reach + 1);
            }
            if (world_->clearance(mean, radius_m_) >= radius_m_) {
                path[i] = mean;
            }
        }
    }
    return path;
}

}  // namespace crspf::sim
