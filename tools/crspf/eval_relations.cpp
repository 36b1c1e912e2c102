// crspf eval relations.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

#include "platform/files/input_error.hpp"
#include "platform/files/trajectory.hpp"
#include "tools/crspf/eval_commands.hpp"
#include "tools/crspf/eval_output.hpp"
#include "tools/eval/relations.hpp"

namespace crspf::cli {
namespace {

struct RelationsCommand {
    std::filesystem::path trajectory;
    std::filesystem::path relations;
    bool json = false;

    void run() const {
        const std::vector<TimedPose> poses = read_tum(trajectory);
        const eval::RelationErrors errors = eval::relation_errors(poses, eval::read_relations(relations));
        const std::size_t used = errors.translation_m.count;
        if (used == 0) {
            throw InputError(trajectory.string() + ": no relation has poses within 0.5 s of both its stamps; is " +
                             relations.string() + " the truth of the same recording?");
        }
        if (json) {
            print_json({{"relations", used},
                        {"skipped", errors.skipped},
                        {"translation_m", to_json(errors.translation_m)},
                        {"translation_squared_m2", to_json(errors.translation_squared_m2)},
                        {"rotation_deg", to_json(errors.rotation_deg)},
                        {"rotation_squared_deg2", to_json(errors.rotation_squared_deg2)}});
            return;
        }
        std::printf("%zu relations, %zu skipped (no pose within 0.5 s)\n", used, errors.skipped);
        print_heading();
        print_summary("translation [m]", errors.translation_m);
        print_summary("translation squared [m^2]", errors.translation_squared_m2);
        print_summary("rotation [deg]", errors.rotation_deg);
        print_summary("rotation squared [deg^2]", errors.rotation_squared_deg2);
    }
};

}  // namespace

void add_relations(CLI::App& eval) {
    const auto command = std::make_shared<RelationsCommand>();
    CLI::App* const sub = eval.add_subcommand(
        "relations", "Error by relations between poses (SLAM benchmark, Kuemmerle et al. 2009): no alignment needed");
    sub->add_option("TRAJECTORY", command->trajectory, "trajectory in TUM format")->required();
    sub->add_option("RELATIONS", command->relations, "lines t1 t2 dx dy dz roll pitch yaw; plain, .gz or .xz")
        ->required();
    sub->add_flag("--json", command->json, "print JSON");
    sub->footer("Example:\n  crspf eval relations intel.tum intel.relations.xz");
    sub->callback([command] {
        command->run();
        check_output();
    });
}

}  // namespace crspf::cli
