#include <atomic>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "config/config.hpp"
#include "platform/files/input_error.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "tools/crspf/commands.hpp"
#include "tools/crspf/stop_signals.hpp"
#include "tools/view/access.hpp"
#include "tools/view/channels.hpp"
#include "tools/view/control_calls.hpp"
#include "tools/view/hub.hpp"
#include "tools/view/live_feed.hpp"
#include "tools/view/metrics.hpp"
#include "tools/view/replay_feed.hpp"
#include "tools/view/replay_player.hpp"
#include "tools/view/web_server.hpp"

namespace crspf::cli {
namespace {

/// Between two looks at the feed: a pose is seen so much later at most.
constexpr Duration kTurn{20'000'000};

struct ViewOptions {
    std::vector<std::string> recordings;
    std::string config;
    double speed = 1.0;
    std::string socket = "/run/crspf/control";
    bool control = false;
    view::WebServerOptions web;
    std::string token_file;
};

/// What has been heard of the run so far.
struct Heard {
    view::Channels channels;
    bool up = false;
    nlohmann::ordered_json status;

    void take(const view::RunEvent& event) {
        if (const auto* const news = std::get_if<view::StatusEvent>(&event)) {
            up = true;
            status = news->status;
        } else if (const auto* const away = std::get_if<view::AwayEvent>(&event)) {
            up = !away->away && up;
        }
        channels.take(event);
    }
};

void print_address(const ViewOptions& options, const view::WebServer& server) {
    const bool v6 = options.web.listen.find(':') != std::string::npos;
    const std::string host = v6 ? "[" + options.web.listen + "]" : options.web.listen;
    const bool everywhere = host == "0.0.0.0" || host == "[::]";
    const std::string at = (everywhere ? "ADDRESS" : host) + ":" + std::to_string(server.port());
    const std::string token = server.rules().token.empty() ? "" : "/?token=" + server.rules().token;
    std::printf("page      http://%s%s\nfoxglove  ws://%s%s\n", at.c_str(), token.c_str(), at.c_str(), token.c_str());
    if (everywhere) {
        std::puts("ADDRESS: any of this machine's, see `ip address`");
    }
    std::fflush(stdout);
}

/// @param turn looks at the feed; each time before the server is given its time
void serve(const ViewOptions& options, Heard& heard, std::vector<view::Action> actions,
           const std::function<void()>& turn) {
    view::Hub hub(heard.channels, CRSPF_VERSION, std::move(actions));
    view::WebServer* asked = nullptr;
    view::WebServer server(options.web, hub, [&] {
        return view::metrics_text(
            {.up = heard.up, .status = heard.status, .hub = hub.counters(), .web = asked->counters()});
    });
    asked = &server;
    const std::atomic<bool>& stop = stop_on_signals();
    print_address(options, server);
    while (!stop) {
        turn();
        server.serve(kTurn);
    }
}

void view_live(const ViewOptions& options) {
    Heard heard;
    view::LiveFeed feed(options.socket);
    std::unique_ptr<view::ControlCalls> calls;
    std::vector<view::Action> actions;
    if (options.control) {
        calls = std::make_unique<view::ControlCalls>(options.socket);
        actions.push_back({.name = "/set_pose",
                           .request_name = "crspf.SetPose",
                           .request_schema = R"({"type":"object","properties":{"x_m":{"type":"number"},)"
                                             R"("y_m":{"type":"number"},"heading_deg":{"type":"number"}},)"
                                             R"("required":["x_m","y_m","heading_deg"]})",
                           .call = [&calls](const nlohmann::json& request, const view::Action::Answer& answer) {
                               try {
                                   calls->ask(view::set_pose_request(request), answer);
                               } catch (const InputError& e) {
                                   answer(e.what());
                               }
                           }});
        actions.push_back({.name = "/relocalize",
                           .request_name = "crspf.Relocalize",
                           .request_schema = R"({"type":"object"})",
                           .call = [&calls](const nlohmann::json& /*request*/, const view::Action::Answer& answer) {
                               ControlRequest request;
                               request.command = ControlRequest::Command::kRelocalize;
                               calls->ask(request, answer);
                           }});
    }
    std::vector<view::RunEvent> events;
    serve(options, heard, std::move(actions), [&] {
        feed.turn(events);
        for (const view::RunEvent& event : events) {
            heard.take(event);
        }
        events.clear();
        if (calls) {
            calls->turn();
        }
    });
}

void view_replay(const ViewOptions& options) {
    constexpr Duration kWork{50'000'000};  // a viewer's pause or position is heard within so long
    ReplayJob job;
    job.logs.assign(options.recordings.begin(), options.recordings.end());
    if (!options.config.empty()) {
        job.config = load_config(options.config);
    }
    Heard heard;
    const auto take = [&heard](const view::RunEvent& event) { heard.take(event); };
    view::ReplayFeed feed(std::move(job));
    view::ReplayPlayer player(feed, options.speed, take);
    std::vector<view::Action> actions;
    actions.push_back({.name = "/playback",
                       .request_name = "crspf.Playback",
                       .request_schema = R"({"type":"object","properties":{"paused":{"type":"boolean"},)"
                                         R"("speed":{"type":"number"},"position_s":{"type":"number"}}})",
                       .call = [&player](const nlohmann::json& request, const view::Action::Answer& answer) {
                           answer(player.ask(request));
                       }});
    serve(options, heard, std::move(actions), [&] { player.turn(monotonic_now(), kWork, take); });
}

void run(ViewOptions options) {
    if (!options.token_file.empty()) {
        options.web.token = view::token_of_file(options.token_file);
    }
    if (!options.recordings.empty() && options.control) {
        throw InputError("--control commands the running service; a recording has none: leave it out");
    }
    if (options.recordings.empty() && !options.config.empty()) {
        throw InputError("--config says how to play a recording; none is given: leave it out, or name one");
    }
    if (options.recordings.empty()) {
        view_live(options);
    } else {
        view_replay(options);
    }
}

}  // namespace

void add_view(CLI::App& app) {
    const auto options = std::make_shared<ViewOptions>();
    CLI::App* const view = app.add_subcommand(
        "view", "Live page in a browser, for Foxglove and for Prometheus: of the service or a recording");
    view->add_option("RECORDING", options->recordings, "To be played, as by crspf replay; none: the running service");
    view->add_option("--socket", options->socket, "Where the service listens")->capture_default_str();
    view->add_flag("--control", options->control, "Viewers may tell the pose and have the robot looked for");
    view->add_option("--config", options->config, "Configuration (TOML) for a recording; default: as crspf replay");
    view->add_option("--speed", options->speed, "Pace of a recording at the start: 1 as it was recorded")
        ->check(CLI::Range(view::ReplayPlayer::kSpeedMin, view::ReplayPlayer::kSpeedMax))
        ->capture_default_str();
    view->add_option("--listen", options->web.listen,
                     "Address to listen at; where others can reach it, they need a token")
        ->capture_default_str();
    view->add_option("--port", options->web.port, "TCP port; 0: any that is free")->capture_default_str();
    view->add_option("--token-file", options->token_file, "The token; default: one is made and shown at the start");
    view->add_option("--allow-origin", options->web.allowed_origins,
                     "Page of another server that may connect, as https://app.foxglove.dev; may be repeated")
        ->allow_extra_args(false);
    view->footer(
        "The page is at http://127.0.0.1:8765, /metrics there is for Prometheus; Foxglove and Lichtblick connect to\n"
        "ws://127.0.0.1:8765. docs/view.md tells more. Ends with Ctrl-C.\n\n"
        "Examples:\n"
        "  crspf view\n"
        "  crspf view --control --listen 0.0.0.0 --token-file /etc/crspf/view.token\n"
        "  crspf view --allow-origin https://app.foxglove.dev\n"
        "  crspf view run.pcapng --speed 4\n"
        "  ssh -t -L 8765:127.0.0.1:8765 robot crspf view");
    view->callback([options] { run(*options); });
}

}  // namespace crspf::cli
