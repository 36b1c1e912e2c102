// crspf eval loops.
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

#include "config/config.hpp"
#include "platform/files/trajectory.hpp"
#include "tools/crspf/eval_commands.hpp"
#include "tools/crspf/eval_output.hpp"
#include "tools/eval/logged_scans.hpp"
#include "tools/eval/loops.hpp"

namespace crspf::cli {
namespace {

struct VerdictText {
    eval::AlignmentVerdict verdict;
    const char* key;
    const char* text;
};
constexpr std::array<VerdictText, 5> kLeftOut = {{
    {.verdict = eval::AlignmentVerdict::kTooFewPoints, .key = "too_few_points", .text = "too few hits"},
    {.verdict = eval::AlignmentVerdict::kNoFit, .key = "no_fit", .text = "scans do not fit"},
    {.verdict = eval::AlignmentVerdict::kAmbiguous, .key = "ambiguous", .text = "fit at two places"},
    {.verdict = eval::AlignmentVerdict::kDegenerate, .key = "degenerate", .text = "a direction not observed"},
    {.verdict = eval::AlignmentVerdict::kAtWindowEdge, .key = "at_window_edge", .text = "at the edge of the search"},
}};

std::size_t count_of(const eval::LoopErrors& errors, eval::AlignmentVerdict verdict) {
    return errors.verdicts.at(static_cast<std::size_t>(verdict));
}

struct LoopsCommand {
    std::filesystem::path trajectory;
    std::vector<std::filesystem::path> logs;
    std::filesystem::path config;
    bool json = false;

    void run() const {
        const std::vector<TimedPose> poses = read_tum(trajectory);
        const std::vector<eval::LoggedScan> scans =
            eval::read_scans(logs, config.empty() ? Config{} : load_config(config));
        eval::require_pose_per_scan(scans, poses, trajectory);
        const eval::LoopErrors errors = eval::loop_errors(scans, poses);
        if (json) {
            print_json(as_json(errors));
        } else {
            print(errors);
        }
    }

    static Json as_json(const eval::LoopErrors& errors) {
        Json left_out;
        for (const VerdictText& v : kLeftOut) {
            left_out[v.key] = count_of(errors, v.verdict);
        }
        left_out["unconfirmed"] = errors.unconfirmed;
        Json ends = Json::array();
        for (const eval::LoopEnd& end : errors.ends) {
            Json one = {{"earlier_stamp_s", end.earlier_stamp_s},
                        {"later_stamp_s", end.later_stamp_s},
                        {"pose", to_json(end.P_map_later)},
                        {"length_m", end.length_m},
                        {"revisits", end.revisits},
                        {"measured", end.measured}};
            if (end.measured > 0) {
                one["late_m"] = end.late_m;
                one["position_m"] = end.position_m;
                one["heading_deg"] = end.heading_deg;
            }
            ends.push_back(one);
        }
        return {{"revisits", errors.revisits},
                {"measured", errors.position_m.count},
                {"left_out", left_out},
                {"ends", ends},
                {"position_m", to_json(errors.position_m)},
                {"heading_deg", to_json(errors.heading_deg)}};
    }

    static void print(const eval::LoopErrors& errors) {
        std::printf("%zu revisits, %zu measured; left out:", errors.revisits, errors.position_m.count);
        for (const VerdictText& v : kLeftOut) {
            std::printf(" %zu %s,", count_of(errors, v.verdict), v.text);
        }
        std::printf(" %zu not confirmed by a second view\n", errors.unconfirmed);
        if (!errors.ends.empty()) {
            std::printf("%18s %18s %9s %9s %9s %9s %8s %10s %10s\n", "end of loop [s]", "its start [s]", "x [m]",
                        "y [m]", "loop [m]", "measured", "late [m]", "error [m]", "[deg]");
        }
        for (const eval::LoopEnd& end : errors.ends) {
            std::printf("%18.3f %18.3f %9.2f %9.2f %9.1f %4zu/%-4zu", end.later_stamp_s, end.earlier_stamp_s,
                        end.P_map_later.x_m, end.P_map_later.y_m, end.length_m, end.measured, end.revisits);
            if (end.measured > 0) {
                std::printf(" %8.1f %10.4f %10.4f\n", end.late_m, end.position_m, end.heading_deg);
            } else {
                std::printf(" %8s %10s %10s\n", "-", "-", "-");
            }
        }
        print_heading();
        print_summary("position [m]", errors.position_m);
        print_summary("heading [deg]", errors.heading_deg);
    }
};

}  // namespace

void add_loops(CLI::App& eval) {
    const auto command = std::make_shared<LoopsCommand>();
    CLI::App* const sub = eval.add_subcommand(
        "loops", "How well a trajectory agrees with itself where the robot comes back to a place: needs no truth");
    sub->add_option("TRAJECTORY", command->trajectory, "trajectory in TUM format, one pose a scan of the logs")
        ->required();
    sub->add_option("LOG", command->logs, "the logs it was made from, in order; plain or compressed")->required();
    sub->add_option("--config", command->config, "configuration (TOML) of the replay: mounting and range of the lidar");
    sub->add_flag("--json", command->json, "print JSON");
    sub->footer(
        "Scans of a second visit (after 20 m or more, within 1.5 m and 45 deg) are laid on scans of the first. A "
        "loop's\n"
        "end is the first 2 m that could be measured on known ground: its error is the largest there. \"late\" is the\n"
        "path on known ground before. Where the two scans leave a doubt the revisit is left out, and counted. The "
        "search\n"
        "reaches 2.5 m and 20 deg: larger errors are not found, they show as ends without a measure.\n\n"
        "Example:\n  crspf eval loops out/aces/trajectory.tum aces.clf.xz");
    sub->callback([command] {
        command->run();
        check_output();
    });
}

}  // namespace crspf::cli
