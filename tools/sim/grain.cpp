#include "tools/sim/grain.hpp"

#include <cmath>

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
constexpr double kPerOctave = 1.0 / (0.36 * 2.24);
// Makes lattice coordinates positive, for which a cast rounds down.
constexpr double kAhead = 0x1p24;

template <typename Real>
Real smooth(Real u) {
    return u * u * (Real{3} - Real{2} * u);
}

float blend(float a, float b, float u) {
    return a + (b - a) * u;
}

double weight_of(double cell_m, double px_per_m) {
    const double seen = (cell_m * px_per_m - kHidden_px) * (1.0 / (kSeen_px - kHidden_px));
    return seen <= 0.0 ? 0.0 : kPerOctave * (seen >= 1.0 ? 1.0 : smooth(seen));
}

/// A lattice coordinate: its cell, and how far into it.
struct Cell {
    std::int32_t index;
    float into;

    explicit Cell(double at)
        : index(static_cast<std::int32_t>(at + kAhead)), into(smooth(static_cast<float>(at + kAhead - index))) {}
};

}  // namespace

Grain::Grain(std::uint64_t seed) : octaves_{}, lattice_{} {
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

float Grain::between_four(double u, double v, std::int32_t column, std::int32_t row) const {
    const Cell across(u);
    const Cell along(v);
    const std::int32_t c = across.index + column;
    const std::int32_t r = along.index + row;
    return blend(blend(value(c, r), value(c + 1, r), across.into),
                 blend(value(c, r + 1), value(c + 1, r + 1), across.into), along.into);
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

double Grain::Level::at(double way_m, double px_per_m) const {
    double sum = 0.0;
    for (std::size_t i = kOctaves; i-- > 0;) {
        const double weight = weight_of(grain_->octaves_[i].cell_m, px_per_m);
        if (weight <= 0.0) {
            break;  // those that follow are finer
        }
        const Line& line = lines_[i];
        const float value = grain_->between_four(line.u + line.u_per_m * way_m, line.v + line.v_per_m * way_m, 0, 0);
        sum += weight * static_cast<double>(value);
    }
    return sum;
}

void Grain::Upright::stand_at(Point p, double px_per_m, double low_m, double high_m) {
    octaves_.clear();
    values_.clear();
    for (std::size_t i = kOctaves; i-- > 0;) {
        const Grain::Octave& octave = grain_->octaves_[i];
        const double weight = weight_of(octave.cell_m, px_per_m);
        if (weight <= 0.0) {
            break;
        }
        const double per_m = 1.0 / octave.cell_m;
        const std::int32_t first = Cell(low_m * per_m).index;
        const std::int32_t last = Cell(high_m * per_m).index + 1;
        const double u = octave.cos_per_m * p.x_m + octave.sin_per_m * p.y_m;
        const double v = octave.cos_per_m * p.y_m - octave.sin_per_m * p.x_m;
        octaves_.push_back({.per_m = per_m, .weight = weight, .first = first, .begin = values_.size()});
        for (std::int32_t height = first; height <= last; ++height) {
            // A layer is the plane's lattice, moved, by steps that lead through all of it before one comes again.
            values_.push_back(grain_->between_four(u, v, 37 * height + octave.shift, 101 * height));
        }
    }
}

double Grain::Upright::at(double height_m) const {
    double sum = 0.0;
    for (const Octave& octave : octaves_) {
        const Cell cell(height_m * octave.per_m);
        const std::size_t i = octave.begin + static_cast<std::size_t>(cell.index - octave.first);
        sum += octave.weight * static_cast<double>(blend(values_[i], values_[i + 1], cell.into));
    }
    return sum;
}

}  // namespace crspf::sim
