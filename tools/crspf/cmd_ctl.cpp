#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/base/trig.hpp"
#include "platform/crspfd/control_client.hpp"
#include "platform/files/input_error.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "tools/crspf/commands.hpp"

namespace crspf::cli {
namespace {

constexpr Duration kCtlWait{15'000'000'000};

struct CtlOptions {
    std::string socket = "/run/crspf/control";
    bool json = false;
    std::vector<double> pose;
    std::string text;
};

using Json = nlohmann::ordered_json;

/// "name  value" lines; what is within another object is indented.
// NOLINTNEXTLINE(misc-no-recursion): as deep as the service's answer
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

void tell(const CtlOptions& options, const ControlRequest& request) {
    const Json result = ask(options.socket, request, kCtlWait);
    if (options.json) {
        std::puts(result.dump(2).c_str());
    } else if (result.empty()) {
        std::puts("done");
    } else {
        print(result, 0);
    }
}

Json ask_for(const CtlOptions& options, ControlRequest::Command command) {
    ControlRequest request;
    request.command = command;
    return ask(options.socket, request, kCtlWait);
}

/// Waits for the answer of the search; the exit status tells whether the robot was found.
void relocalize(const CtlOptions& options) {
    constexpr Duration kPatience{30'000'000'000};
    constexpr Duration kPoll{100'000'000};
    const auto number = ask_for(options, ControlRequest::Command::kRelocalize).at("search").get<std::uint64_t>();
    const Stamp end = monotonic_now() + kPatience;
    while (monotonic_now() < end) {
        const Json search = ask_for(options, ControlRequest::Command::kStatus).at("relocalization");
        if (search.at("searches").get<std::uint64_t>() >= number) {
            const auto words = search.at("last").get<std::string>();
            std::puts(options.json ? search.dump(2).c_str() : words.c_str());
            if (search.at("verdict") != "found") {
                throw InputError("the robot was not found");
            }
            return;
        }
        sleep_until(monotonic_now() + kPoll);
    }
    throw InputError("no answer in time; is the machine overloaded? See crspf ctl status");
}

}  // namespace

void add_ctl(CLI::App& app) {
    auto options = std::make_shared<CtlOptions>();
    CLI::App* const ctl = app.add_subcommand("ctl", "Ask and command the running service");
    ctl->footer(
        "Examples:\n"
        "  crspf ctl status\n"
        "  crspf ctl pose --json\n"
        "  crspf ctl save-map\n"
        "  crspf ctl set-pose 12.5 -3.0 90\n"
        "  crspf ctl relocalize\n"
        "  crspf ctl load-map /srv/maps/office.yaml\n"
        "  crspf ctl record start");
    ctl->require_subcommand(1);
    ctl->add_option("--socket", options->socket, "Where the service listens")->capture_default_str();
    ctl->add_flag("--json", options->json, "Print the answer as it came");
    ctl->fallthrough();

    using Command = ControlRequest::Command;
    const auto add_to = [options](CLI::App* parent, const char* name, const char* what, Command command) {
        CLI::App* const sub = parent->add_subcommand(name, what);
        sub->callback([options, command] {
            ControlRequest request{.command = command, .P_map_base = {}, .text = options->text};
            if (options->pose.size() == 3) {
                request.P_map_base = {
                    .x_m = options->pose[0], .y_m = options->pose[1], .theta_rad = radians(options->pose[2])};
            }
            tell(*options, request);
        });
        return sub;
    };
    const auto add = [&](const char* name, const char* what, Command command) {
        return add_to(ctl, name, what, command);
    };
    add("status", "How everything is: pose, threads, sources, counters", Command::kStatus);
    add("pose", "Where the robot is", Command::kPose);
    add("save-map", "Save the map and the pose now", Command::kSaveMap);
    add("set-pose", "Tell the service where the robot is", Command::kSetPose)
        ->add_option("pose", options->pose, "x [m], y [m], heading [deg] of base_link in the map frame")
        ->required()
        ->expected(3);
    add("load-map", "Go on with another map; the robot is looked for on it", Command::kLoadMap)
        ->add_option("map", options->text, "YAML file in map_server's format, readable by the service")
        ->required()
        ->check(CLI::ExistingFile)
        ->transform([](const std::string& path) { return std::filesystem::absolute(path).string(); });
    add("reset", "Begin an empty map, with the robot at its origin", Command::kReset);
    add("reload", "Read the configuration again; the map stays", Command::kReload);
    CLI::App* const record = ctl->add_subcommand("record", "Record what the sensors say");
    record->require_subcommand(1);
    record->fallthrough();
    add_to(record, "start", "Into the recordings of the service's state directory", Command::kRecordStart);
    add_to(record, "stop", "Ends it and names the file", Command::kRecordStop);
    ctl->add_subcommand("relocalize", "Look for the robot in the whole map; waits for the answer")->callback([options] {
        relocalize(*options);
    });
    add("log-level", "How much the service logs", Command::kLogLevel)
        ->add_option("level", options->text, "trace, debug, info, warning or error")
        ->required();
}

}  // namespace crspf::cli
