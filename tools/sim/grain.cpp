#include "tools/sim/grain.hpp"

#include <algorithm>

#include "core/base/trig.hpp"
#include "tools/sim/random.hpp"

namespace crspf::sim {
namespace {

constexpr double kFinest_m = 0.012;
constexpr double kCoarser = 3.0;  // an octave's cells than those of the one before
constexpr double kTurn_rad = 1.1;
constexpr double kHidden_px = 1.5;  // cells of so many pixels are not seen, ...
constexpr double kSeen_px = 3.0;    // ... and those of so many wholly
// A uniform value, blended with its neighbours, deviates by 0.36 of its bound in the plane; five add up.
constexpr float kPerOctave = 1.0F / (0.36F * 2.24F);
// Makes lattice coordinates positive, for which a cast rounds down.
constexpr double kAhead = 0x1p24;

float smooth(float u) {
    return u * u * (3.0F - 2.0F * u);
}

float blend(float a, float b, float u) {
    return a + (b - a) * u;
}

float weight_of(double cell_m, double px_per_m) {
    const double seen = (cell_m * px_per_m - kHidden_px) * (1.0 / (kSeen_px - kHidden_px));
    return kPerOctave * smooth(static_cast<float>(std::clamp(seen, 0.0, 1.0)));
}

}  // namespace

Grain::Grain(std::uint64_t seed) {
    Random random(seed, RandomStream::kGrain);
    for (float& value : lattice_) {
        value = static_cast<float>(random.uniform(-1.0, 1.0));
    }
    double cell_m = kFinest_m;
    double turn_rad = 0.0;
    for (Octave& octave : octaves_) {
        const SinCos turn = sin_cos(turn_rad);
        octave = {.cell_m = cell_m,
                  .cos_per_m = turn.cos / cell_m,
                  .sin_per_m = turn.sin / cell_m,
                  .shift = static_cast<std::int32_t>(random.index(kSide))};
        cell_m *= kCoarser;
        turn_rad += kTurn_rad;
    }
}

float Grain::value(std::int32_t column, std::int32_t row) const {
    const auto x = static_cast<std::uint32_t>(column) & (kSide - 1U);
    const auto y = static_cast<std::uint32_t>(row) & (kSide - 1U);
    return lattice_[(y << kSideBits) | x];
}

Grain::Cell Grain::cell_at(double at) {
    const auto index = static_cast<std::int32_t>(at + kAhead);
    return {index, smooth(static_cast<float>(at + kAhead - index))};
}

float Grain::between_four(Cell u, Cell v) const {
    return blend(blend(value(u.index, v.index), value(u.index + 1, v.index), u.into),
                 blend(value(u.index, v.index + 1), value(u.index + 1, v.index + 1), u.into), v.into);
}

void Grain::Level::lead(Point from, Point step) {
    for (std::size_t i = 0; i < kOctaves; ++i) {
        const Grain::Octave& octave = grain_->octaves_[i];
        lines_[i] = {.u = octave.cos_per_m * from.x_m + octave.sin_per_m * from.y_m + octave.shift,
                     .u_per_m = octave.cos_per_m * step.x_m + octave.sin_per_m * step.y_m,
                     .v = octave.cos_per_m * from.y_m - octave.sin_per_m * from.x_m,
                     .v_per_m = octave.cos_per_m * step.y_m - octave.sin_per_m * step.x_m};
    }
}

void Grain::Level::clear() {
    ways_m_.clear();
    px_per_m_.clear();
}

void Grain::Level::ask(double way_m, double px_per_m) {
    ways_m_.push_back(way_m);
    px_per_m_.push_back(px_per_m);
}

std::span<const float> Grain::Level::told() {
    const std::size_t count = ways_m_.size();
    sums_.assign(count, 0.0F);
    us_.resize(count);
    vs_.resize(count);
    weights_.resize(count);
    for (std::size_t i = 0; i < kOctaves; ++i) {
        const Line& line = lines_[i];
        const double cell_m = grain_->octaves_[i].cell_m;
        for (std::size_t k = 0; k < count; ++k) {
            weights_[k] = weight_of(cell_m, px_per_m_[k]);
            us_[k] = cell_at(line.u + line.u_per_m * ways_m_[k]);
            vs_[k] = cell_at(line.v + line.v_per_m * ways_m_[k]);
        }
        for (std::size_t k = 0; k < count; ++k) {
            if (weights_[k] > 0.0F) {
                sums_[k] += weights_[k] * grain_->between_four(us_[k], vs_[k]);
            }
        }
    }
    return sums_;
}

void Grain::Upright::stand_at(Point p, double px_per_m, double low_m, double high_m) {
    octaves_.clear();
    values_.clear();
    for (const Grain::Octave& octave : grain_->octaves_) {
        const float weight = weight_of(octave.cell_m, px_per_m);
        if (weight <= 0.0F) {
            continue;
        }
        const double per_m = 1.0 / octave.cell_m;
        const std::int32_t first = cell_at(low_m * per_m).index;
        const std::int32_t last = cell_at(high_m * per_m).index + 1;
        const Cell u = cell_at(octave.cos_per_m * p.x_m + octave.sin_per_m * p.y_m + octave.shift);
        const Cell v = cell_at(octave.cos_per_m * p.y_m - octave.sin_per_m * p.x_m);
        octaves_.push_back({.per_m = per_m, .first = first, .begin = values_.size()});
        for (std::int32_t height = first; height <= last; ++height) {
            // A layer is the plane's lattice, moved, by steps that lead through all of it before one comes again.
            values_.push_back(weight *
                              grain_->between_four({u.index + 37 * height, u.into}, {v.index + 101 * height, v.into}));
        }
    }
}

double Grain::Upright::at(double height_m) const {
    float sum = 0.0F;
    for (const Octave& octave : octaves_) {
        const Cell cell = cell_at(height_m * octave.per_m);
        const std::size_t i = octave.begin + static_cast<std::size_t>(cell.index - octave.first);
        sum += blend(values_[i], values_[i + 1], cell.into);
    }
    return static_cast<double>(sum);
}

}  // namespace crspf::sim
