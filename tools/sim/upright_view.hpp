// What of a world is seen in one upright plane: an upright camera's column of pixels.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tools/sim/scene.hpp"
#include "tools/sim/world.hpp"

namespace crspf::sim {

/// What a surface is of.
enum class Matter : std::uint8_t { kSky, kFloor, kCeiling, kWall, kPerson, kCar, kCrown };

/// A surface's cut with the plane: a line up, or a level one.
struct Face {
    Matter matter = Matter::kSky;
    std::uint32_t index = 0;  ///< of the wall, or the leg, car or crown
    bool upright = true;
    double at_m = kInfinity;  ///< upright: the way there; level: how far above the eye
    Point normal{};           ///< upright: of length 1, towards the eye

    /// [m] The way to it along a line of sight that rises by so much a metre.
    [[nodiscard]] double way_m(double rise) const { return upright ? at_m : at_m / rise; }
    [[nodiscard]] bool same_surface(const Face& other) const {
        return matter == other.matter && index == other.index && upright == other.upright;
    }
    /// The same surface, and without an edge in between.
    [[nodiscard]] bool continues(const Face& other) const {
        constexpr double kEdge = 0.9;  // cosine
        const double cosine = normal.x_m * other.normal.x_m + normal.y_m * other.normal.y_m;
        return same_surface(other) && (!upright || at_m == kInfinity || cosine > kEdge);
    }
};

/// The lines of sight that end on one face: by their rise a metre, from `low` to `high`.
struct Sight {
    Face face;
    double low = 0.0;
    double high = 0.0;
};

class UprightView {
 public:
    /// Rises beyond this are not looked at.
    static constexpr double kSteepest = 1e3;

    /// The scene, which must outlive this, on level ground, its walls `wall_height_m` high; in the open air there is
    /// sky above them, else a ceiling on them.
    UprightView(const Scene& scene, double wall_height_m) : scene_(&scene), wall_height_m_(wall_height_m) {}

    /// From the lowest to the highest, without gaps; until the next call.
    /// @param eye_m its height above the ground, less than that of the walls
    std::span<const Sight> look(Point eye, double eye_m, SinCos direction, const Movers& movers);

 private:
    void add(const Face& face, double low, double high);
    void add_upright(Matter matter, std::uint32_t index, double way_m, double bottom_m, double top_m, Point normal);
    void add_level(Matter matter, std::uint32_t index, double above_m, const Part& part);
    void add_leg(std::uint32_t index, const Circle& leg);
    void add_car(std::uint32_t index, const Box& car);
    void add_crown(std::uint32_t index, const Crown& crown);
    void add_crossings();
    [[nodiscard]] const Face& nearest(double rise) const;

    const Scene* scene_;
    double wall_height_m_;
    // Of the present plane.
    Point eye_;
    double eye_m_ = 0.0;
    SinCos direction_{.sin = 0.0, .cos = 1.0};
    std::vector<Sight> candidates_;  ///< as if nothing stood before them
    std::vector<double> borders_;
    std::vector<Sight> seen_;
};

}  // namespace crspf::sim
