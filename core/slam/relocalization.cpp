#include "core/slam/relocalization.hpp"

#include <algorithm>

#include "core/base/real.hpp"
#include "core/slam/place_check.hpp"

namespace crspf {
namespace {

constexpr std::int32_t kBlock = SearchGrid::kBlock;
/// Blocks of a row that are summed together.
constexpr std::int32_t kRun = 256;
/// Points whose worths, summed, fit a byte: 16 blocks are added by one instruction of any vector unit.
constexpr std::uint32_t kPointsPerByte = 255 / kWorth;

std::int32_t nearest_cell(float v) {
    return floor_to_cell(static_cast<double>(v) + 0.5);
}

std::int32_t cells_per_side(double cell_m, double resolution_m) {
    constexpr double kMost = 1000.0;
    return static_cast<std::int32_t>(std::clamp(cell_m / resolution_m + 0.5, 1.0, kMost));
}

bool has_size(const MapView& map) {
    return map.resolution_m > 0.0 && is_finite(map.resolution_m);
}

bool near(const Pose2& a, const Pose2& b, double distance_m, double turn_rad) {
    return square(a.x_m - b.x_m) + square(a.y_m - b.y_m) < square(distance_m) &&
           absolute(wrap_angle(a.theta_rad - b.theta_rad)) < turn_rad;
}

}  // namespace

std::size_t Relocalizer::bytes_needed(const MapView& map) const {
    return has_size(map) ? SearchGrid::bytes_needed(map, cells_per_side(params_.cell_m, map.resolution_m)) : 0;
}

bool Relocalizer::load(const MapView& map, std::span<std::uint8_t> memory) {
    cell_m_ = 0.0;
    map_ = map;
    if (!has_size(map)) {
        return false;
    }
    const std::int32_t side = cells_per_side(params_.cell_m, map.resolution_m);
    if (!grid_.build(map, side, memory)) {
        return false;
    }
    cell_m_ = side * map.resolution_m;
    return true;
}

void Relocalizer::begin(const ScanPoints& points) {
    result_ = {};
    places_count_ = 0;
    checked_ = 0;
    P_base_lidar_ = points.P_base_first_lidar;
    scan_.take(points, cell_m_);
    result_.hits = scan_.count;
    if (cell_m_ <= 0.0 || scan_.count < std::max(params_.hits_min, 1U)) {
        result_.verdict = PlaceVerdict::kNoAnswer;
        return;
    }
    lay_out_points();
    // A step turns the points by about a cell.
    const double steps = std::min(2.0 * kPi * scan_.rms_range_m / cell_m_, static_cast<double>(kHeadings));
    constexpr std::int32_t kFewest = 90;
    headings_ = std::max(static_cast<std::int32_t>(steps), kFewest);
    full_ = kWorth * static_cast<std::int32_t>(points_);
    best_sum_ = 0;
    threshold_ = static_cast<std::int32_t>(params_.found_above * full_);
    phase_ = Phase::kBound;
    bounds_ = {};
    row_ = 0;
    turn_to(0);
}

void Relocalizer::lay_out_points() {
    constexpr double kBeforeHit = 3.0;  // [cells] clear of the wall that it is on
    const double scale = 1.0 / cell_m_;
    points_ = scan_.count;
    for (std::uint32_t i = 0; i < scan_.count; ++i) {
        const double x = static_cast<double>(scan_.x_m[i]) * scale;
        const double y = static_cast<double>(scan_.y_m[i]) * scale;
        x_[i] = static_cast<float>(x);
        y_[i] = static_cast<float>(y);
        // The beam has passed the middle of its way, and the land in front of its hit: a wall has a side.
        const double range = square_root(square(x) + square(y));
        if (range > 2.0 * kBeforeHit) {
            for (const double share : {1.0 - kBeforeHit / range, 0.5}) {
                x_[points_] = static_cast<float>(share * x);
                y_[points_] = static_cast<float>(share * y);
                ++points_;
            }
        }
    }
}

double Relocalizer::heading_rad(std::int32_t heading) const {
    return wrap_angle(heading * (2.0 * kPi / headings_));
}

void Relocalizer::turn_to(std::int32_t heading) {
    heading_ = heading;
    const SinCos r = sin_cos(heading_rad(heading));
    const auto c = static_cast<float>(r.cos);
    const auto s = static_cast<float>(r.sin);
    for (std::uint32_t i = 0; i < points_; ++i) {
        dx_[i] = nearest_cell(c * x_[i] - s * y_[i]);
        dy_[i] = nearest_cell(s * x_[i] + c * y_[i]);
    }
}

bool Relocalizer::step(std::uint64_t nodes) {
    const std::uint64_t until = result_.nodes + nodes;
    while (result_.verdict == PlaceVerdict::kUnfinished && result_.nodes < until) {
        if (result_.nodes >= params_.nodes_max) {
            result_.verdict = PlaceVerdict::kNoAnswer;
        } else if (phase_ != Phase::kCheck) {
            sweep_row(row_++);
            if (row_ * kBlock >= grid_.height()) {
                row_ = 0;
                next_heading();
            }
        } else if (checked_ < places_count_) {
            check(places_[checked_++]);
        } else {
            conclude();
        }
    }
    return result_.verdict != PlaceVerdict::kUnfinished;
}

void Relocalizer::next_heading() {
    if (phase_ == Phase::kBound && heading_ + 1 < headings_) {
        turn_to(heading_ + 1);
        return;
    }
    if (phase_ == Phase::kSearch) {
        bounds_[static_cast<std::size_t>(heading_)] = 0;
    }
    phase_ = Phase::kSearch;
    const auto* const best = std::max_element(bounds_.cbegin(), bounds_.cbegin() + headings_);
    if (*best > threshold_) {
        turn_to(static_cast<std::int32_t>(best - bounds_.cbegin()));
    } else {
        phase_ = Phase::kCheck;
    }
}

void Relocalizer::sweep_row(std::int32_t by) {
    const std::int32_t columns = grid_.width() / kBlock;
    const std::uint8_t* const room = grid_.block_row(Layer::kFree, 0, by) + 1;
    ++result_.nodes;  // so that an empty map comes to an end, too
    for (std::int32_t low = 0; low < columns; low += kRun) {
        std::int32_t begin = low;
        std::int32_t end = std::min(low + kRun, columns);
        while (begin < end && room[begin] == 0) {
            ++begin;
        }
        while (begin < end && room[end - 1] == 0) {
            --end;
        }
        std::array<std::uint16_t, kRun> sums{};
        sum_blocks(by, begin, end, sums.data());
        result_.nodes += static_cast<std::uint64_t>(end - begin);
        if (phase_ == Phase::kBound) {
            std::uint16_t& bound = bounds_[static_cast<std::size_t>(heading_)];
            bound = std::max(bound, *std::max_element(sums.begin(), sums.end()));
            continue;
        }
        for (std::int32_t b = begin; b < end; ++b) {
            if (sums[static_cast<std::size_t>(b - begin)] > threshold_) {
                look_into(b, by);
            }
        }
    }
}

void Relocalizer::sum_blocks(std::int32_t by, std::int32_t low, std::int32_t high, std::uint16_t* sums) const {
    const std::int32_t columns = grid_.width() / kBlock;
    const std::int32_t rows = grid_.height() / kBlock;
    for (std::uint32_t first = 0; low < high && first < points_; first += kPointsPerByte) {
        std::array<std::uint8_t, kRun> bytes{};
        for (std::uint32_t i = first; i < std::min(first + kPointsPerByte, points_); ++i) {
            const std::int32_t row = by + (dy_[i] >> SearchGrid::kBlockShift);
            const std::int32_t shift = dx_[i] >> SearchGrid::kBlockShift;
            const std::int32_t begin = std::max(low, -1 - shift);
            const std::int32_t end = std::min(high, columns - shift);
            if (row < -1 || row >= rows || begin >= end) {
                continue;
            }
            const std::int32_t phase = ((dy_[i] & (kBlock - 1)) << SearchGrid::kBlockShift) | (dx_[i] & (kBlock - 1));
            const std::uint8_t* const block = grid_.block_row(layer(i), phase, row) + (1 + shift + begin);
            std::uint8_t* const byte = bytes.data() + (begin - low);
            for (std::int32_t b = 0; b < end - begin; ++b) {
                byte[b] = static_cast<std::uint8_t>(byte[b] + block[b]);
            }
        }
        for (std::int32_t b = 0; b < high - low; ++b) {
            sums[b] = static_cast<std::uint16_t>(sums[b] + bytes[static_cast<std::size_t>(b)]);
        }
    }
}

void Relocalizer::look_into(std::int32_t bx, std::int32_t by) {
    for (std::int32_t y = by * kBlock; y < (by + 1) * kBlock; ++y) {
        for (std::int32_t x = bx * kBlock; x < (bx + 1) * kBlock; ++x) {
            if (!grid_.can_stand(x, y)) {
                continue;
            }
            ++result_.nodes;
            const std::int32_t sum = sum_at(x, y);
            if (sum > threshold_) {
                keep({.heading = heading_,
                      .x = x,
                      .y = y,
                      .sum = sum,
                      .P_corner_lidar = {
                          .x_m = (x + 0.5) * cell_m_, .y_m = (y + 0.5) * cell_m_, .theta_rad = heading_rad(heading_)}});
            }
        }
    }
}

/// Exact above the threshold, 0 where it is known to stay below.
std::int32_t Relocalizer::sum_at(std::int32_t x, std::int32_t y) const {
    std::int32_t missing = full_ - threshold_;
    for (std::uint32_t i = 0; i < points_; ++i) {
        missing -= kWorth - grid_.at(layer(i), x + dx_[i], y + dy_[i]);
        if (missing <= 0) {
            return 0;
        }
    }
    return threshold_ + missing;
}

void Relocalizer::keep(const Place& place) {
    if (place.sum > best_sum_) {
        raise_threshold(place.sum);
    }
    // Of places beside each other the best stays.
    constexpr double kBeside_m = 0.3;
    constexpr double kBeside_rad = radians(5.0);
    for (std::size_t i = 0; i < places_count_; ++i) {
        if (near(places_[i].P_corner_lidar, place.P_corner_lidar, kBeside_m, kBeside_rad)) {
            if (place.sum > places_[i].sum) {
                places_[i] = place;
            }
            return;
        }
    }
    if (places_count_ < kPlaces) {
        places_[places_count_++] = place;
        return;
    }
    ++result_.left_out;
    Place& worst =
        *std::min_element(places_.begin(), places_.end(), [](const Place& a, const Place& b) { return a.sum < b.sum; });
    if (place.sum > worst.sum) {
        worst = place;
    }
}

void Relocalizer::raise_threshold(std::int32_t best_sum) {
    // The sums are coarse: what is behind by more than this does not catch up on the map itself.
    constexpr double kBehind = 0.12;
    best_sum_ = best_sum;
    threshold_ = std::max(threshold_, best_sum - static_cast<std::int32_t>(kBehind * full_));
    const auto* const end =
        std::remove_if(places_.begin(), places_.begin() + static_cast<std::ptrdiff_t>(places_count_),
                       [this](const Place& place) { return place.sum <= threshold_; });
    places_count_ = static_cast<std::size_t>(end - places_.begin());
}

void Relocalizer::check(Place& place) {
    const PlaceCheck on_map(map_, scan_, params_.tolerance_m);
    const auto top = on_map.climb(place.P_corner_lidar, 0.5 * cell_m_, 0.5 * heading_rad(1));
    place.P_corner_lidar = top.P_corner_lidar;
    place.share = on_map.share(top.P_corner_lidar);
    result_.nodes += top.evaluations + 1;
}

void Relocalizer::conclude() {
    const std::span<const Place> places(places_.data(), places_count_);
    const Pose2 P_lidar_base = inverse(P_base_lidar_);
    const auto less = [](const Place& a, const Place& b) { return a.share < b.share; };
    const auto best = std::max_element(places.begin(), places.end(), less);
    if (best == places.end() || best->share < params_.found_above) {
        result_.verdict = PlaceVerdict::kNotFound;
        result_.share = best == places.end() ? 0.0 : best->share;
        return;
    }
    result_.P_map_base = map_.P_map_corner * best->P_corner_lidar * P_lidar_base;
    result_.share = best->share;
    constexpr double kSamePlace_m = 0.5;
    constexpr double kSamePlace_rad = radians(10.0);
    for (const Place& other : places) {
        if (other.share > result_.runner_up &&
            !near(other.P_corner_lidar, best->P_corner_lidar, kSamePlace_m, kSamePlace_rad)) {
            result_.runner_up = other.share;
            result_.P_map_runner_up = map_.P_map_corner * other.P_corner_lidar * P_lidar_base;
        }
    }
    // Hits that are a cell apart are taken for independent trials with the place's share for probability.
    const auto variance = [](double share) { return share * (1.0 - share); };
    const double doubt =
        params_.stddevs * square_root((variance(result_.share) + variance(result_.runner_up)) / scan_.count);
    result_.verdict = result_.share - result_.runner_up > doubt ? PlaceVerdict::kFound : PlaceVerdict::kAmbiguous;
}

}  // namespace crspf
