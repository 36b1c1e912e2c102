// Drives the robot through a list of places: plans a way to each, follows it, keeps off walls, people and cars.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tools/sim/nav_grid.hpp"
#include "tools/sim/robot.hpp"
#include "tools/sim/world.hpp"

namespace crspf::sim {

class Driver {
 public:
    /// Visits `places` in turn, over and over if `repeat`. `world` and `floor` must outlive this.
    Driver(const World& world, const NavGrid& floor, const RobotParams& params, std::vector<Point> places, bool repeat);

    /// Follows `path` (steps of about 0.1 m) once, as it is.
    Driver(const World& world, const NavGrid& floor, const RobotParams& params, std::vector<Point> path);

    /// What to do in the next `seconds`.
    [[nodiscard]] Command command(const Robot& robot, const std::vector<Circle>& people, std::span<const Circle> cars,
                                  double seconds);

    /// All places were visited or given up.
    [[nodiscard]] bool finished() const { return finished_; }
    /// Share of the places, or of the path, that lies behind. [0, 1]
    [[nodiscard]] double progress() const;
    /// Places that could not be reached in reasonable time.
    [[nodiscard]] std::size_t given_up() const { return given_up_; }

 private:
    enum class Manoeuvre : std::uint8_t { kForward, kTurn, kReverse };

    void update_progress(Point robot, double seconds);
    void next_place(Point robot);
    [[nodiscard]] Point lookahead(Point robot) const;
    [[nodiscard]] bool clear_line(Point from, Point to) const;
    [[nodiscard]] bool clear_arc(const Pose2& P_world_base, double length_m, double curvature) const;
    [[nodiscard]] bool person_ahead(const Robot& robot, const std::vector<Circle>& people) const;
    [[nodiscard]] bool car_ahead(const Robot& robot, std::span<const Circle> cars) const;
    [[nodiscard]] Command drive_differential(const Robot& robot, double bearing_rad, double curvature);
    [[nodiscard]] Command drive_ackermann(const Robot& robot, double bearing_rad, double curvature, double seconds);
    [[nodiscard]] double stopping_m(double speed_mps) const;
    void change_to(Manoeuvre manoeuvre);

    const World* world_;
    const NavGrid* floor_;
    RobotParams params_;
    std::vector<Point> places_;
    bool repeat_ = false;
    std::size_t place_ = 0;    ///< index of the next in places_
    std::vector<Point> path_;  ///< to the present one
    std::size_t passed_ = 0;   ///< index into path_ of the point beside the robot
    double stuck_s_ = 0.0;     ///< since passed_ last grew
    std::size_t given_up_ = 0;
    std::size_t given_up_in_a_row_ = 0;
    Manoeuvre manoeuvre_ = Manoeuvre::kForward;
    double manoeuvre_m_ = 1.0;  ///< driven in this manoeuvre
    bool finished_ = false;
};

}  // namespace crspf::sim
