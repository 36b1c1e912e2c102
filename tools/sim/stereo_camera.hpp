// A stereo camera on the simulated robot: what its two pictures show, without errors of lenses.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/pose.hpp"
#include "drivers/stereo/stereo_calibration.hpp"
#include "drivers/stereo/stereo_params.hpp"
#include "tools/sim/grain.hpp"
#include "tools/sim/random.hpp"
#include "tools/sim/scene.hpp"
#include "tools/sim/stereo_pictures.hpp"
#include "tools/sim/upright_view.hpp"
#include "tools/sim/world.hpp"

namespace crspf::sim {

/// Why a camera sees nothing that is of use.
/// kDark: no light; kBlur: moved far to the side while exposed; kBare: one plain surface before it.
enum class Blindness : std::uint8_t { kDark, kBlur, kBare };

struct StereoCameraParams {
    RectifiedCamera camera;
    CameraMounting mounting;
    bool grain = true;   ///< of the surfaces; without it edges are all there is to see
    double noise = 1.5;  ///< [grey levels] standard deviation, of each pixel by itself
};

/// The pair without an opening angle given: 640 x 360 or as told, 90 degrees wide, 12 cm apart.
[[nodiscard]] RectifiedCamera usual_camera(int width_px, int height_px);

/// All pixels of both pictures are exposed at one instant. The camera stands upright on level ground, so a column of
/// pixels looks along one upright plane.
class StereoCamera {
 public:
    /// `scene` must outlive it. Throws InputError for a camera that does not stand upright between ground and wall
    /// tops.
    StereoCamera(const Scene& scene, const StereoCameraParams& params, std::uint64_t seed);
    StereoCamera(const StereoCamera&) = delete;
    StereoCamera& operator=(const StereoCamera&) = delete;
    ~StereoCamera() = default;

    [[nodiscard]] StereoPictures shoot(const Pose2& P_world_base, const Movers& movers,
                                       std::optional<Blindness> blind = std::nullopt);

    /// The left camera, seen from base_link.
    [[nodiscard]] Pose2 P_base_camera() const {
        return {.x_m = params_.mounting.x_m, .y_m = params_.mounting.y_m, .theta_rad = params_.mounting.yaw_rad};
    }

 private:
    /// Upright, through the eye.
    struct Plane {
        Point eye;
        SinCos direction{.sin = 0.0, .cos = 1.0};
        double slant = 1.0;  ///< way over the ground for each metre ahead
    };
    struct Column {
        int number = 0;
        Plane plane;
        double weight = 1.0;  ///< of the plane in the pixels' width
    };

    void draw(const Pose2& P_world_eye, const Movers& movers);
    /// A column through which edges run.
    void draw_edge(const Pose2& P_world_eye, int x, const Movers& movers);
    [[nodiscard]] Plane plane_at(const Pose2& P_world_eye, double at_px) const;
    void paint(const Column& column, std::span<const Sight> sights, const Movers& movers);
    void paint(const Column& column, const Sight& sight, const Movers& movers);
    [[nodiscard]] GrayImage exposed(std::optional<Blindness> blind);

    const Scene* scene_;
    StereoCameraParams params_;
    Grain grain_;
    Grain::Level level_grain_;
    Grain::Upright upright_grain_;
    UprightView view_;
    Random random_;
    std::vector<float> light_;              ///< of the picture in the making [grey levels]
    std::vector<Sight> sights_;             ///< of all columns, one after the other ...
    std::vector<std::size_t> sight_begin_;  ///< ... from here, one more than there are columns
    std::vector<Sight> edge_sights_;
    std::vector<double> lights_;  ///< of a column's pixels
};

}  // namespace crspf::sim
