#include <unistd.h>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "core/base/trig.hpp"
#include "platform/files/atomic_file.hpp"
#include "tools/crspf/calibrate.hpp"
#include "tools/crspf/calibrate_commands.hpp"
#include "tools/crspf/commands.hpp"

namespace crspf::cli {
namespace {

struct CalibrateOptions {
    std::vector<std::string> inputs;
    std::string config;
    std::string out;
};

void run(const CalibrateOptions& options) {
    CalibrateJob job;
    job.logs.assign(options.inputs.begin(), options.inputs.end());
    if (!options.config.empty()) {
        job.config = load_config(options.config);
    }
    const bool terminal = isatty(STDERR_FILENO) != 0;
    if (terminal) {
        job.progress = [](int round, double share) {
            std::fprintf(stderr, "\rround %d: %3.0f %%", round, 100.0 * share);
        };
    }
    const CalibrateOutcome outcome = run_calibration(job);
    if (terminal) {
        std::fprintf(stderr, "\r\033[K");
    }
    std::printf("%-30s %10s %10s    %s\n", "", "before", "found", "standard deviation");
    for (const Finding& finding : outcome.findings) {
        std::printf("%-30s %10.4f %10.4f +- %.4f %s\n", ("[" + finding.section + "] " + finding.key).c_str(),
                    finding.before, finding.value, finding.stddev, finding.unit.c_str());
        if (!finding.found) {
            std::printf("    not well enough: %s tell it\n", finding.shown_by.c_str());
        }
    }
    if (outcome.pieces > 0) {
        std::printf("by %zu pieces of the drive, each about a metre or a bend; left over in each: %.1f mm, %.2f deg\n",
                    outcome.pieces, 1e3 * outcome.rest_m, degrees(outcome.rest_rad));
        if (!outcome.settled) {
            std::printf("after %d rounds it still moves: more of a drive is needed\n", outcome.rounds);
        }
    }
    const std::string fragment = fragment_of(outcome);
    if (options.out.empty()) {
        std::printf("\n%s", fragment.c_str());
        return;
    }
    AtomicFile file(options.out);
    file.write(fragment);
    file.commit();
    std::printf("written to %s\n", options.out.c_str());
}

}  // namespace

void add_calibrate(CLI::App& app) {
    CLI::App* const command = app.add_subcommand("calibrate", "What a recorded run tells of the vehicle itself");
    const auto options = std::make_shared<CalibrateOptions>();
    command->add_option("INPUT", options->inputs, "As `crspf replay` reads them");
    command->add_option("--config", options->config,
                        "What is known so far (TOML); default: the configuration of the recording");
    command->add_option("--out", options->out, "File for what was found, as TOML; default: it is shown");
    command->footer(
        "Finds how the lidar is mounted (x, y, yaw) and how late its stamps are; and of the odometry: wheel sizes and\n"
        "span, or speed, steering offset and wheel base, or speed and yaw rate bias, and an IMU's yaw. Each with its\n"
        "standard deviation; what the run does not show is said so and left out.\n"
        "Drive for some minutes among walls: straight on, and with turns to both sides, of every radius. An IMU's yaw\n"
        "and the bias of one that stands still are found without a lidar, too.\n"
        "\n"
        "Examples:\n"
        "  crspf calibrate run.pcapng\n"
        "  crspf calibrate exp1.dat --config config/examples/urg04lx.toml --out found.toml");
    add_calibrate_stereo(*command);
    command->callback([options, command] {
        if (!command->get_subcommands().empty()) {
            return;
        }
        if (options->inputs.empty()) {
            throw CLI::RequiredError("INPUT");
        }
        run(*options);
    });
}

}  // namespace crspf::cli
