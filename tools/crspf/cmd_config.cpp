#include <cerrno>
#include <cstdio>
#include <memory>
#include <string>
#include <system_error>

#include "config/config.hpp"
#include "platform/files/input_error.hpp"
#include "tools/crspf/commands.hpp"

namespace crspf::cli {

namespace {

struct ConfigOptions {
    std::string check;
    std::string print;
    bool reference = false;
    bool capacities = false;
};

void write_out(const std::string& text) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
        throw InputError("standard output: cannot be written: " + std::generic_category().message(errno) +
                         "; free some space or send it elsewhere");
    }
}

}  // namespace

void add_config(CLI::App& app) {
    auto options = std::make_shared<ConfigOptions>();
    CLI::App* command = app.add_subcommand("config", "Check, show and explain configuration files");
    command->footer(
        "Examples:\n"
        "  crspf config --check robot.toml       names every mistake, with line and column\n"
        "  crspf config --print robot.toml       all values in effect, as a configuration file\n"
        "  crspf config --print > robot.toml     a file to start from");
    CLI::Option_group* choice = command->add_option_group("Action", "One of");
    choice->require_option(1);
    choice->add_option("--check", options->check, "Read FILE and name every mistake in it")->type_name("FILE");
    CLI::Option* print =
        choice->add_option("--print", options->print, "All values in effect with FILE, or the defaults");
    print->type_name("[FILE]")->expected(0, 1);
    choice->add_flag("--reference", options->reference, "Every key with meaning, range and default, in Markdown");
    choice->add_flag("--capacities", options->capacities, "The bounds that are fixed when the program is compiled");

    command->callback([options, print] {
        if (options->reference) {
            write_out(config_reference());
        } else if (options->capacities) {
            write_out(list_capacities());
        } else if (*print) {
            write_out(print_config(options->print.empty() ? Config{} : load_config(options->print)));
        } else {
            static_cast<void>(load_config(options->check));
            write_out(options->check + ": valid\n");
        }
    });
}

}  // namespace crspf::cli
