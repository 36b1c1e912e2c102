#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "platform/files/input_error.hpp"
#include "platform/service/preflight_needs.hpp"
#include "tools/crspf/commands.hpp"
#include "tools/crspf/eval_output.hpp"

namespace crspf::cli {
namespace {

struct DoctorOptions {
    std::string config;
    bool json = false;
};

void print(const std::vector<PreflightCheck>& checks) {
    std::size_t width = 0;
    for (const PreflightCheck& check : checks) {
        width = std::max(width, check.name.size());
    }
    for (const PreflightCheck& check : checks) {
        std::printf("%-8s %-*s %s\n", name_of(check.verdict), static_cast<int>(width), check.name.c_str(),
                    check.found.c_str());
        if (!check.remedy.empty()) {
            std::printf("%-8s %-*s -> %s\n", "", static_cast<int>(width), "", check.remedy.c_str());
        }
    }
}

void print_as_json(const std::vector<PreflightCheck>& checks) {
    Json all = Json::array();
    for (const PreflightCheck& check : checks) {
        all.push_back({{"name", check.name},
                       {"verdict", name_of(check.verdict)},
                       {"found", check.found},
                       {"remedy", check.remedy}});
    }
    print_json({{"checks", all}});
}

void run(const DoctorOptions& options) {
    const Config config = options.config.empty() ? Config{} : load_config(options.config);
    const std::vector<PreflightCheck> checks = run_preflight(needs_of(config), this_machine());
    if (options.json) {
        print_as_json(checks);
    } else {
        print(checks);
    }
    check_output();
    const auto failures = std::count_if(checks.begin(), checks.end(),
                                        [](const PreflightCheck& c) { return c.verdict == Verdict::kFailure; });
    if (failures > 0) {
        throw InputError("this machine: " + std::to_string(failures) + " of " + std::to_string(checks.size()) +
                         " checks failed; each says what to do");
    }
}

}  // namespace

void add_doctor(CLI::App& app) {
    const auto options = std::make_shared<DoctorOptions>();
    CLI::App* const sub =
        app.add_subcommand("doctor", "Say whether this machine can run the service, and what it lacks");
    sub->add_option("--config", options->config, "Configuration (TOML): also look at the ports of its sources");
    sub->add_flag("--json", options->json, "print JSON");
    sub->footer(
        "Looks and changes nothing; sensors notice nothing. A warning costs precision or convenience, a failure keeps\n"
        "the service from running in real time. Exit status: 0 without a failure, 1 with one, 2 for a wrong command.\n"
        "\n"
        "Examples:\n"
        "  crspf doctor\n"
        "  crspf doctor --config /etc/crspf/crspfd.toml\n"
        "  crspf doctor --json | jq -r '.checks[] | select(.verdict != \"ok\") | .name + \": \" + .remedy'");
    sub->callback([options] { run(*options); });
}

}  // namespace crspf::cli
