// The grain of surfaces as a camera sees it: noise that is a property of the place, never finer than the picture shows.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tools/sim/world.hpp"

namespace crspf::sim {

/// A sum of octaves, each smooth between the random values of a lattice. An octave whose cells are nearly as fine as
/// the picture's pixels fades, so that no pattern appears that is not on the surface, and none jumps from pixel to
/// pixel. Its mean is about 0, its standard deviation about 1 where all octaves are seen. A picture is made of lines of
/// pixels: what one has in common is reckoned once.
class Grain {
    static constexpr std::size_t kOctaves = 5;

    struct Octave {
        double cell_m = 0.0;
        double cos_per_m = 0.0;  ///< lattices are turned against each other
        double sin_per_m = 0.0;
        std::int32_t shift = 0;
    };

    /// A lattice coordinate: its cell, and how far into it.
    struct Cell {
        std::int32_t index = 0;
        float into = 0.0F;
    };

 public:
    explicit Grain(std::uint64_t seed);

    /// Along a level line.
    class Level {
     public:
        explicit Level(const Grain& grain) : grain_(&grain) {}
        /// @param step what a metre leads to
        void lead(Point from, Point step);
        /// Many places are asked for, then all are told: the processor reckons several at once.
        void clear();
        /// @param px_per_m [px/m] how large the picture shows it there
        void ask(double way_m, double px_per_m);
        /// In the order in which they were asked for; until the next call.
        [[nodiscard]] std::span<const float> told();

     private:
        /// In lattice coordinates.
        struct Line {
            double u = 0.0;
            double u_per_m = 0.0;
            double v = 0.0;
            double v_per_m = 0.0;
        };
        const Grain* grain_;
        std::array<Line, kOctaves> lines_{};
        std::vector<double> ways_m_;
        std::vector<double> px_per_m_;
        std::vector<float> sums_;
        std::vector<Cell> us_;
        std::vector<Cell> vs_;
        std::vector<float> weights_;
    };

    /// Along an upright line.
    class Upright {
     public:
        explicit Upright(const Grain& grain) : grain_(&grain) {}
        /// @param low_m, high_m bounds of the heights that will be asked for [m]
        void stand_at(Point p, double px_per_m, double low_m, double high_m);
        [[nodiscard]] double at(double height_m) const;

     private:
        struct Octave {
            double per_m = 0.0;
            std::int32_t first = 0;  ///< lattice height of values_[begin], weighed
            std::size_t begin = 0;
        };
        const Grain* grain_;
        std::vector<Octave> octaves_;
        std::vector<float> values_;
    };

 private:
    static constexpr unsigned kSideBits = 6;
    static constexpr std::int32_t kSide = 1 << kSideBits;  ///< of the lattice, which repeats

    [[nodiscard]] float value(std::int32_t column, std::int32_t row) const;
    /// In a layer of the lattice, at lattice coordinates of an octave.
    [[nodiscard]] float between_four(Cell u, Cell v) const;
    [[nodiscard]] static Cell cell_at(double at);

    std::array<Octave, kOctaves> octaves_{};
    std::array<float, std::size_t{kSide} * kSide> lattice_{};  ///< from -1 to 1; small enough for a near cache
};

}  // namespace crspf::sim
