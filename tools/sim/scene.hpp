// Where a simulation takes place.
#pragma once

#include <string>
#include <vector>

#include "core/base/pose.hpp"
#include "platform/files/grid_map.hpp"
#include "tools/sim/world.hpp"

namespace crspf::sim {

/// Of a tree, beside its trunk: nothing that drives below touches it.
struct Crown {
    Circle circle;
    double low_m = 0.0;  ///< above the ground
    double high_m = 0.0;
};

struct Scene {
    World world;
    Pose2 P_world_start;      ///< where the robot stands at first
    std::vector<Point> tour;  ///< places to visit; empty: any place will do
    GridMap truth;            ///< the map that a perfect SLAM would make
    std::vector<Crown> crowns = {};
    std::vector<Point> route = {};  ///< that leads round to its beginning; driven in place of a tour
    bool outdoors = false;          ///< the sky is above, not a ceiling
};

/// One of kSceneNames, or the YAML file of a map_server map. Throws InputError for what is neither.
[[nodiscard]] Scene make_scene(const std::string& name_or_file);

inline constexpr const char* kSceneNames[] = {"office", "corridor", "meeting", "hall",   "lobby",
                                              "arena",  "field",    "campus",  "parking"};

}  // namespace crspf::sim
