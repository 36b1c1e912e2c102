#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "platform/files/input_error.hpp"
#include "platform/files/secret_file.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "tools/crspf/commands.hpp"
#include "tools/crspf/stop_signals.hpp"
#include "tools/mqtt/broker_link.hpp"
#include "tools/mqtt/robot_topics.hpp"
#include "tools/view/live_feed.hpp"

namespace crspf::cli {
namespace {

/// Between two looks at the feed: what it says goes out so much later at most.
constexpr Duration kTurn{20'000'000};
constexpr Duration kEnd{2'000'000'000};  ///< for the last message

struct MqttOptions {
    std::string broker;
    mqtt::TopicOptions topics;
    mqtt::BrokerOptions link;
    std::string password_file;
    std::string socket = "/run/crspf/control";
};

std::string host_name() {
    std::array<char, 256> name{};
    return ::gethostname(name.data(), name.size() - 1) == 0 ? std::string(name.data()) : std::string();
}

mqtt::Moment moment() {
    return {.now = monotonic_now(), .utc_ns = clock_now(CLOCK_REALTIME).ns};
}

void say(const std::string& line) {
    std::fprintf(stderr, "%s\n", line.c_str());
}

/// What the feed has to say, to the topics; that the service is away, to the terminal or the journal, too.
void listen(view::LiveFeed& feed, mqtt::RobotTopics& topics) {
    std::vector<view::RunEvent> events;
    feed.turn(events);
    for (const view::RunEvent& event : events) {
        if (const auto* const away = std::get_if<view::AwayEvent>(&event)) {
            say(away->away ? away->why : "crspfd is there");
        }
        topics.take(event, moment());
    }
}

void run(MqttOptions options) {
    options.topics.version = CRSPF_VERSION;
    options.link.address = mqtt::parse_broker(options.broker, options.link.tls);
    options.link.client_id = options.topics.prefix + "-" + options.topics.robot;
    if (!options.password_file.empty()) {
        options.link.password = read_secret(options.password_file);
    }
    view::LiveFeed feed(options.socket);
    mqtt::RobotTopics topics(options.topics, moment());
    options.link.will = topics.online(false);
    static_cast<void>(std::signal(SIGPIPE, SIG_IGN));  // OpenSSL writes to a connection that may be gone
    const std::atomic<bool>& stop = stop_on_signals();
    mqtt::BrokerLink broker(options.link, say);
    std::uint64_t connection = 0;
    while (!stop) {
        listen(feed, topics);
        if (broker.connections() != connection) {
            connection = broker.connections();
            topics.begin();
        }
        while (broker.takes()) {
            const auto publication = topics.next(moment());
            if (!publication) {
                break;
            }
            broker.publish(*publication);
        }
        broker.turn(kTurn);
    }
    broker.end(topics.online(false), kEnd);
}

}  // namespace

void add_mqtt(CLI::App& app) {
    const auto options = std::make_shared<MqttOptions>();
    options->topics.robot = host_name();
    CLI::App* const mqtt = app.add_subcommand(
        "mqtt", "The running service's pose, health and map to an MQTT broker, for fleets of robots");
    mqtt->add_option("--broker", options->broker, "HOST[:PORT] of the broker; port 1883, with --tls 8883")->required();
    mqtt->add_option("--robot", options->topics.robot, "This robot's name in the topics, and one robot's only")
        ->capture_default_str();
    mqtt->add_option("--prefix", options->topics.prefix, "What the topics begin with")->capture_default_str();
    mqtt->add_option("--rate", options->topics.pose_hz, "Poses a second at most [Hz]")
        ->check(CLI::Range(0.01, 50.0))
        ->capture_default_str();
    CLI::Option* const tls = mqtt->add_flag("--tls", options->link.tls, "Encrypted, the broker's certificate verified");
    mqtt->add_option("--ca", options->link.ca, "Who has signed it (PEM); default: whom this machine trusts")
        ->needs(tls);
    CLI::Option* const cert =
        mqtt->add_option("--cert", options->link.cert, "This robot's certificate (PEM)")->needs(tls);
    CLI::Option* const key = mqtt->add_option("--key", options->link.key, "The certificate's key (PEM)")->needs(cert);
    cert->needs(key);
    CLI::Option* const user = mqtt->add_option("--user", options->link.user, "Name at the broker");
    mqtt->add_option("--password-file", options->password_file, "Its password, in a file that not everybody can read")
        ->needs(user);
    mqtt->add_option("--socket", options->socket, "Where the service listens")->capture_default_str();
    mqtt->footer(
        "Topics: crspf/ROBOT/online, pose, health, map, map/COLUMN/ROW, log; docs/mqtt.md tells what is on them. Runs\n"
        "beside crspfd as an ordinary process: crspf-mqtt.service. Waits for broker and service as long as need be.\n"
        "Ends with Ctrl-C.\n\n"
        "Examples:\n"
        "  crspf mqtt --broker broker.example --robot forklift-7\n"
        "  crspf mqtt --broker broker.example --tls --user forklift-7 --password-file /etc/crspf/mqtt.password\n"
        "  crspf mqtt --broker broker.example --tls --ca ca.pem --cert forklift-7.pem --key forklift-7.key --rate 10\n"
        "  mosquitto_sub -h broker.example -v -t 'crspf/+/health'");
    mqtt->callback([options] { run(*options); });
}

}  // namespace crspf::cli
