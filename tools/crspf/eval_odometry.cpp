// crspf eval odometry.
#include <Eigen/Geometry>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "platform/files/input_error.hpp"
#include "platform/files/kitti_poses.hpp"
#include "platform/files/trajectory.hpp"
#include "tools/crspf/eval_commands.hpp"
#include "tools/crspf/eval_output.hpp"
#include "tools/eval/drift.hpp"
#include "tools/eval/stamp_index.hpp"

namespace crspf::cli {
namespace {

using Path = std::vector<Eigen::Isometry3d>;

struct Pairs {
    Path estimate;
    Path truth;
};

Eigen::Isometry3d isometry(const KittiPose& pose) {
    Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
    const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> rows(pose.data());
    // As printed with few digits it is not quite a rotation.
    out.linear() = Eigen::Quaterniond(Eigen::Matrix3d(rows.leftCols<3>())).normalized().toRotationMatrix();
    out.translation() = rows.col(3);
    return out;
}

Eigen::Isometry3d isometry(const Pose2& pose) {
    Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
    out.linear() = Eigen::AngleAxisd(pose.theta_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    out.translation() = Eigen::Vector3d(pose.x_m, pose.y_m, 0.0);
    return out;
}

Path kitti_path(const std::filesystem::path& file) {
    Path path;
    for (const KittiPose& pose : read_kitti_poses(file)) {
        path.push_back(isometry(pose));
    }
    return path;
}

struct OdometryCommand {
    std::filesystem::path trajectory;
    std::filesystem::path truth;
    std::vector<double> lengths_m;
    std::size_t from = 0;
    double max_gap_s = 0.02;
    bool json = false;

    [[nodiscard]] Pairs kitti_pairs() const {
        Pairs pairs{.estimate = kitti_path(trajectory), .truth = kitti_path(truth)};
        if (pairs.estimate.size() != pairs.truth.size()) {
            throw InputError(trajectory.string() + ": has " + std::to_string(pairs.estimate.size()) + " poses, " +
                             truth.string() + " has " + std::to_string(pairs.truth.size()) +
                             "; files in KITTI's format have no stamps: give two of the same pictures");
        }
        return pairs;
    }

    [[nodiscard]] Pairs tum_pairs() const {
        const std::vector<TimedPose> true_poses = read_tum(truth);
        const eval::StampIndex index(true_poses);
        Pairs pairs;
        for (const TimedPose& pose : read_tum(trajectory)) {
            if (const auto place = index.nearest(pose.stamp_s, max_gap_s)) {
                pairs.estimate.push_back(isometry(pose.P_map_base));
                pairs.truth.push_back(isometry(true_poses[*place].P_map_base));
            }
        }
        return pairs;
    }

    void run() const {
        const bool kitti = looks_like_kitti_poses(trajectory);
        if (kitti != looks_like_kitti_poses(truth)) {
            throw InputError(truth.string() + ": is of another format than " + trajectory.string() +
                             "; give both in KITTI's (twelve numbers a line) or both in TUM format");
        }
        const Pairs pairs = kitti ? kitti_pairs() : tum_pairs();
        if (pairs.truth.size() < from + 2) {
            throw InputError(trajectory.string() + ": " + std::to_string(pairs.truth.size()) +
                             " poses have a truth in " + truth.string() +
                             ", too few; check that both use one clock, or lower --from");
        }
        const std::span estimate = std::span(pairs.estimate).subspan(from);
        const std::span true_path = std::span(pairs.truth).subspan(from);
        const double path_m = eval::path_length_m(true_path);
        const eval::Drift drift =
            eval::drift(estimate, true_path, lengths_m.empty() ? eval::kitti_lengths_m(path_m) : lengths_m,
                        eval::kitti_step(path_m));
        if (json) {
            print_json(as_json(drift));
        } else {
            print(drift, true_path.size());
        }
    }

    [[nodiscard]] static Json as_json(const eval::Drift& drift) {
        Json lengths = Json::array();
        for (const eval::DriftAtLength& at : drift.lengths) {
            lengths.push_back({{"length_m", at.length_m},
                               {"stretches", at.stretches},
                               {"translation_percent", 100.0 * at.translation},
                               {"rotation_deg_per_m", at.rotation_deg_per_m}});
        }
        return {{"path_m", drift.path_m},
                {"lengths", lengths},
                {"mean",
                 {{"stretches", drift.stretches},
                  {"translation_percent", 100.0 * drift.translation},
                  {"rotation_deg_per_m", drift.rotation_deg_per_m}}},
                {"end",
                 {{"translation_percent", 100.0 * drift.end_translation},
                  {"rotation_deg_per_m", drift.end_rotation_deg_per_m}}}};
    }

    static void print(const eval::Drift& drift, std::size_t poses) {
        std::printf("%zu poses, %.1f m\n%-12s %10s %16s %18s\n", poses, drift.path_m, "length [m]", "stretches",
                    "translation [%]", "rotation [deg/m]");
        for (const eval::DriftAtLength& at : drift.lengths) {
            std::printf("%-12g %10zu %16.3f %18.5f\n", at.length_m, at.stretches, 100.0 * at.translation,
                        at.rotation_deg_per_m);
        }
        std::printf("%-12s %10zu %16.3f %18.5f\n", "all", drift.stretches, 100.0 * drift.translation,
                    drift.rotation_deg_per_m);
        std::printf("%-12s %10s %16.3f %18.5f\n", "whole path", "1", 100.0 * drift.end_translation,
                    drift.end_rotation_deg_per_m);
    }
};

}  // namespace

void add_odometry(CLI::App& eval) {
    const auto command = std::make_shared<OdometryCommand>();
    CLI::App* const sub =
        eval.add_subcommand("odometry", "Drift by the length of the way: the measure of KITTI's odometry benchmark");
    sub->add_option("TRAJECTORY", command->trajectory, "trajectory in KITTI's format, or in TUM format")->required();
    sub->add_option("TRUTH", command->truth, "true trajectory in the same format")->required();
    sub->add_option(
           "--lengths", command->lengths_m,
           "[m] of the stretches; default: 100,200 ... 800 as KITTI has them, from every tenth pose; on a path "
           "shorter than 100 m 10,20 ... 80, from every pose")
        ->delimiter(',')
        ->check(CLI::PositiveNumber);
    sub->add_option("--from", command->from, "leave out so many poses at the beginning")->capture_default_str();
    sub->add_option("--max-gap", command->max_gap_s, "[s] TUM: leave out poses without a truth this near in stamp")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    sub->add_flag("--json", command->json, "print JSON");
    sub->footer(
        "Of each stretch of the true way, the position at its end by the estimate against the truth, by its length;\n"
        "and the heading (in space: all of the rotation) likewise. Their means say how an odometer drifts.\n"
        "\n"
        "Examples:\n"
        "  crspf replay kitti/ --odometry-only --out out && crspf eval odometry out/poses.txt kitti/poses.txt\n"
        "  crspf eval odometry out/trajectory.tum truth.tum --lengths 5,10,20");
    sub->callback([command] {
        command->run();
        check_output();
    });
}

}  // namespace crspf::cli
