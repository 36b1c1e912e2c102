#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "core/base/trig.hpp"
#include "platform/crspfd/control_client.hpp"
#include "tools/crspf/commands.hpp"

namespace crspf::cli {
namespace {

constexpr Duration kWait{15'000'000'000};

struct Options {
    std::string socket = "/run/crspf/control";
    bool json = false;
    std::vector<double> pose;
    std::string level;
};

using Json = nlohmann::ordered_json;

/// "name  value" lines; what is within another object is indented.
void print(const Json& value, int depth) {
    for (const auto& [key, item] : value.items()) {
        if (item.is_object() || (item.is_array() && !item.empty() && item.front().is_object())) {
            std::printf("%*s%s\n", 2 * depth, "", key.c_str());
            if (item.is_object()) {
                print(item, depth + 1);
                continue;
            }
            for (const Json& element : item) {
                print(element, depth + 1);
                std::puts("");
            }
            continue;
        }
        const std::string text = item.is_string() ? item.get<std::string>() : item.dump();
        std::printf("%*s%-*s %s\n", 2 * depth, "", 24 - 2 * depth, key.c_str(), text.c_str());
    }
}

void tell(const Options& options, const ControlRequest& request) {
    const Json result = ask(options.socket, request, kWait);
    if (options.json) {
        std::puts(result.dump(2).c_str());
    } else if (result.empty()) {
        std::puts("done");
    } else {
        print(result, 0);
    }
}

}  // namespace

void add_ctl(CLI::App& app) {
    auto options = std::make_shared<Options>();
    CLI::App* const ctl = app.add_subcommand("ctl", "Ask and command the running service");
    ctl->footer(
        "Examples:\n"
        "  crspf ctl status\n"
        "  crspf ctl pose --json\n"
        "  crspf ctl save-map\n"
        "  crspf ctl set-pose 12.5 -3.0 90");
    ctl->require_subcommand(1);
    ctl->add_option("--socket", options->socket, "Where the service listens")->capture_default_str();
    ctl->add_flag("--json", options->json, "Print the answer as it came");
    ctl->fallthrough();

    using Command = ControlRequest::Command;
    const auto add = [&](const char* name, const char* what, Command command) {
        CLI::App* const sub = ctl->add_subcommand(name, what);
        sub->callback([options, command] {
            ControlRequest request{.command = command, .P_map_base = {}, .level = options->level};
            if (options->pose.size() == 3) {
                request.P_map_base = {
                    .x_m = options->pose[0], .y_m = options->pose[1], .theta_rad = radians(options->pose[2])};
            }
            tell(*options, request);
        });
        return sub;
    };
    add("status", "How everything is: pose, threads, sources, counters", Command::kStatus);
    add("pose", "Where the robot is", Command::kPose);
    add("save-map", "Save the map and the pose now", Command::kSaveMap);
    add("set-pose", "Tell the service where the robot is", Command::kSetPose)
        ->add_option("pose", options->pose, "x [m], y [m], heading [deg] of base_link in the map frame")
        ->required()
        ->expected(3);
    add("log-level", "How much the service logs", Command::kLogLevel)
        ->add_option("level", options->level, "trace, debug, info, warning or error")
        ->required();
}

}  // namespace crspf::cli
