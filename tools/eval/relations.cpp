#include "tools/eval/relations.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "platform/capture/line_source.hpp"
#include "platform/files/fields.hpp"
#include "platform/files/input_error.hpp"
#include "tools/eval/stamp_index.hpp"

namespace crspf::eval {
namespace {

/// False where the line is not 8 finite numbers.
bool parse_line(std::string_view line, std::array<double, 8>& numbers) {
    Fields fields(line);
    return std::all_of(numbers.begin(), numbers.end(),
                       [&fields](double& n) { return fields.number(n) && std::isfinite(n); }) &&
           fields.at_end();
}

}  // namespace

std::vector<Relation> read_relations(const std::filesystem::path& file) {
    std::vector<Relation> relations;
    LineSource source(file);
    LineSource::Line line;
    while (source.next(line)) {
        if (!line.too_long && (line.text.starts_with('#') || Fields(line.text).at_end())) {
            continue;
        }
        const std::string where = source.name() + ":" + std::to_string(source.line_number()) + ": ";
        std::array<double, 8> n{};
        if (!parse_line(line.text, n)) {
            throw InputError(where + "not a relation; a line holds 8 numbers: t1 t2 dx dy dz roll pitch yaw");
        }
        constexpr double kFlat = 1e-6;  // [m] or [rad]
        if (std::abs(n[4]) > kFlat || std::abs(n[5]) > kFlat || std::abs(n[6]) > kFlat) {
            throw InputError(
                where +
                "dz, roll or pitch is not 0; a line holds t1 t2 dx dy dz roll pitch yaw of a motion in the plane");
        }
        relations.push_back(
            {.stamp1_s = n[0], .stamp2_s = n[1], .P_1_2 = {.x_m = n[2], .y_m = n[3], .theta_rad = wrap_angle(n[7])}});
    }
    if (relations.empty()) {
        throw InputError(source.name() + ": no relations in it; a line holds t1 t2 dx dy dz roll pitch yaw");
    }
    return relations;
}

RelationErrors relation_errors(const std::vector<TimedPose>& trajectory, const std::vector<Relation>& relations,
                               double max_gap_s) {
    const StampIndex index(trajectory);
    RelationErrors errors;
    std::vector<double> translation_m;
    std::vector<double> translation_squared_m2;
    std::vector<double> rotation_deg;
    std::vector<double> rotation_squared_deg2;
    for (const Relation& relation : relations) {
        const auto first = index.nearest(relation.stamp1_s, max_gap_s);
        const auto second = index.nearest(relation.stamp2_s, max_gap_s);
        if (!first || !second) {
            ++errors.skipped;
            continue;
        }
        const Pose2 P_1_2 = inverse(trajectory[*first].P_map_base) * trajectory[*second].P_map_base;
        const Pose2 error = inverse(relation.P_1_2) * P_1_2;
        const double length_m = std::hypot(error.x_m, error.y_m);
        const double turn_deg = std::abs(degrees(error.theta_rad));
        translation_m.push_back(length_m);
        translation_squared_m2.push_back(length_m * length_m);
        rotation_deg.push_back(turn_deg);
        rotation_squared_deg2.push_back(turn_deg * turn_deg);
    }
    errors.translation_m = summarise(std::move(translation_m));
    errors.translation_squared_m2 = summarise(std::move(translation_squared_m2));
    errors.rotation_deg = summarise(std::move(rotation_deg));
    errors.rotation_squared_deg2 = summarise(std::move(rotation_squared_deg2));
    return errors;
}

}  // namespace crspf::eval
