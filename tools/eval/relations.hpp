// Error by relations between poses, the metric of the SLAM benchmark: R. Kuemmerle et al., "On measuring the accuracy
// of SLAM algorithms", Autonomous Robots 27 (2009). It needs no common frame and no alignment.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "core/base/pose.hpp"
#include "platform/files/trajectory.hpp"
#include "tools/eval/summary.hpp"

namespace crspf::eval {

/// The true pose at stamp 2, seen from the true pose at stamp 1.
struct Relation {
    double stamp1_s = 0.0;  ///< [s]
    double stamp2_s = 0.0;  ///< [s] may be before stamp 1
    Pose2 P_1_2;
};

/// Reads `t1 t2 dx dy dz roll pitch yaw` a line [s, m, rad], `#` comments; plain, .gz or .xz. Throws InputError with
/// file and line on anything else, on a relation that leaves the plane, and on a file without relations.
[[nodiscard]] std::vector<Relation> read_relations(const std::filesystem::path& file);

/// error = P_1_2(true)^-1 * P_1_2(trajectory); lengths and turns without sign.
struct RelationErrors {
    Summary translation_m;
    Summary translation_squared_m2;
    Summary rotation_deg;
    Summary rotation_squared_deg2;
    std::size_t skipped = 0;  ///< relations without a pose within max_gap_s of either stamp
};

/// Each stamp takes the pose nearest to it.
[[nodiscard]] RelationErrors relation_errors(const std::vector<TimedPose>& trajectory,
                                             const std::vector<Relation>& relations, double max_gap_s = 0.5);

}  // namespace crspf::eval
