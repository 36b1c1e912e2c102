#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "platform/files/input_error.hpp"
#include "tools/crspf/commands.hpp"
#include "tools/experiments/experiment.hpp"

namespace {

int run(int argc, char** argv) {
    CLI::App app{
        "Lidar SLAM that removes the drift of any odometer: critical rays, self-adaptive particle filter.\n"
        "Each sub-command has its own --help with examples."};
    app.name("crspf");
    app.set_version_flag("--version", CRSPF_VERSION);
    app.require_subcommand(1);
    crspf::cli::add_replay(app);
    crspf::cli::add_inspect(app);
    crspf::cli::add_record(app);
    crspf::cli::add_stereo(app);
    crspf::cli::add_sim(app);
    crspf::cli::add_eval(app);
    crspf::cli::add_calibrate(app);
    crspf::cli::add_bench(app);
    crspf::cli::add_config(app);
    crspf::cli::add_ctl(app);
    crspf::cli::add_top(app);
    crspf::cli::add_view(app);
    crspf::cli::add_mqtt(app);
    crspf::cli::add_doctor(app);
    crspf::cli::add_export(app);
    crspf::cli::add_experiments(app, crspf::experiments::experiments());
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        return app.exit(e) == 0 ? 0 : 2;
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const crspf::InputError& e) {
        std::fprintf(stderr, "crspf: error: %s\n", e.what());
        return 1;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "crspf: internal error: %s\nPlease report this with the command line.\n", e.what());
        return 3;
    }
}
