// crspf eval ate.
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "platform/files/input_error.hpp"
#include "platform/files/trajectory.hpp"
#include "tools/crspf/eval_commands.hpp"
#include "tools/crspf/eval_output.hpp"
#include "tools/eval/ate.hpp"

namespace crspf::cli {
namespace {

struct AteCommand {
    std::filesystem::path trajectory;
    std::filesystem::path truth;
    double max_gap_s = eval::AteOptions{}.max_gap_s;
    bool no_align = false;
    std::array<double, 2> along{};
    bool has_along = false;
    bool json = false;

    void run() const {
        eval::AteOptions options{.max_gap_s = max_gap_s,
                                 .alignment = no_align ? eval::Alignment::kFirstPose : eval::Alignment::kBestFit};
        if (has_along) {
            const double length = std::hypot(along[0], along[1]);
            if (!(length > 0.0 && std::isfinite(length))) {
                throw InputError("--along: a direction of no length; give two numbers such as 1,0");
            }
            options.along = {.x = along[0] / length, .y = along[1] / length};
        }
        const std::vector<TimedPose> poses = read_tum(trajectory);
        const auto report = eval::absolute_trajectory_error(poses, read_tum(truth), options);
        if (!report) {
            throw InputError(trajectory.string() + ": no pose has a truth within " + std::to_string(max_gap_s) +
                             " s in " + truth.string() + "; check that both use one clock, or raise --max-gap");
        }
        if (json) {
            print_json(as_json(*report));
        } else {
            print(*report);
        }
    }

    [[nodiscard]] Json as_json(const eval::AteReport& report) const {
        Json end = {{"position_m", report.end.position_m}, {"heading_deg", report.end.heading_deg}};
        if (has_along) {
            end["along_m"] = report.end.along_m;
        }
        return {{"pairs", report.position_m.count},
                {"unmatched", report.unmatched},
                {"aligned_by", no_align ? "first pose" : "best fit"},
                {"alignment", to_json(report.P_truth_map)},
                {"position_m", to_json(report.position_m)},
                {"heading_deg", to_json(report.heading_deg)},
                {"end_aligned_at_first_pose", end}};
    }

    void print(const eval::AteReport& report) const {
        std::printf("%zu pairs, %zu poses without a truth within %g s; aligned by %s\n", report.position_m.count,
                    report.unmatched, max_gap_s, no_align ? "the first pose" : "best fit");
        print_alignment(report.P_truth_map);
        print_heading();
        print_summary("position [m]", report.position_m);
        print_summary("heading [deg]", report.heading_deg);
        std::printf("at the end, aligned at the first pose: position %.4f m, heading %+.4f deg", report.end.position_m,
                    report.end.heading_deg);
        if (has_along) {
            std::printf(", along the axis %+.4f m", report.end.along_m);
        }
        std::printf("\n");
    }
};

}  // namespace

void add_ate(CLI::App& eval) {
    const auto command = std::make_shared<AteCommand>();
    CLI::App* const sub =
        eval.add_subcommand("ate", "Absolute trajectory error after a rigid alignment, and the error at the end");
    sub->add_option("TRAJECTORY", command->trajectory, "trajectory in TUM format")->required();
    sub->add_option("TRUTH", command->truth, "true trajectory in TUM format, same clock")->required();
    sub->add_option("--max-gap", command->max_gap_s, "[s] leave out poses without a truth this near in stamp")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    sub->add_flag("--no-align", command->no_align, "align at the first pose instead of by best fit");
    CLI::Option* const along =
        sub->add_option("--along", command->along, "also the signed end error along this direction of the truth frame")
            ->type_name("X,Y")
            ->delimiter(',');
    sub->add_flag("--json", command->json, "print JSON");
    sub->footer(
        "Examples:\n"
        "  crspf eval ate run.tum truth.tum\n"
        "  crspf eval ate corridor.tum truth.tum --no-align --along 1,0");
    sub->callback([command, along] {
        command->has_along = along->count() > 0;
        command->run();
        check_output();
    });
}

}  // namespace crspf::cli
