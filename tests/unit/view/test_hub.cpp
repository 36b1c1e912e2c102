#include <algorithm>
#include <catch2/catch.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tools/view/hub.hpp"

namespace {

using namespace crspf::view;
using Json = nlohmann::json;

ScanEvent scan_at(std::int64_t stamp_ns) {
    ScanEvent scan;
    scan.stamp_ns = stamp_ns;
    scan.matched = true;
    return scan;
}

std::uint32_t u32_at(const std::string& bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        value |= std::uint32_t{static_cast<std::uint8_t>(bytes.at(at + i))} << (8 * i);
    }
    return value;
}

std::string little_u32(std::uint32_t value) {
    std::string bytes;
    for (unsigned i = 0; i < 4; ++i) {
        bytes += static_cast<char>(static_cast<std::uint8_t>(value >> (8 * i)));
    }
    return bytes;
}

/// @param length of the encoding's name, as it is told
std::string call_bytes(std::uint32_t action, std::uint32_t number, const std::string& data,
                       const std::string& encoding = "json", std::uint32_t length = 4) {
    std::string bytes(1, '\x02');
    bytes += little_u32(action);
    bytes += little_u32(number);
    bytes += little_u32(length);
    return bytes + encoding + data;
}

/// All that a peer is to be sent now.
std::vector<Outgoing> drain(HubPeer& peer) {
    std::vector<Outgoing> all;
    while (auto message = peer.next()) {
        all.push_back(std::move(*message));
    }
    return all;
}

std::vector<Json> texts(const std::vector<Outgoing>& messages) {
    std::vector<Json> out;
    for (const Outgoing& message : messages) {
        if (!message.binary) {
            out.push_back(Json::parse(message.head));
        }
    }
    return out;
}

/// A hub of no actions, or with one that keeps what it is asked.
struct Bench {
    explicit Bench(std::vector<Action> actions = {}) : hub(channels, "1.2.3", std::move(actions)) {}

    [[nodiscard]] std::size_t id_of(const std::string& topic) const {
        for (std::size_t id = 0; id < channels.all().size(); ++id) {
            if (channels.all()[id].topic == topic) {
                return id;
            }
        }
        FAIL("no channel " << topic);
        return 0;
    }
    void subscribe(HubPeer& peer, std::uint32_t subscription, const std::string& topic) const {
        peer.take_text(
            Json{{"op", "subscribe"}, {"subscriptions", {{{"id", subscription}, {"channelId", id_of(topic)}}}}}.dump());
    }

    Channels channels;
    Hub hub;
};

struct Asked {
    std::vector<Json> requests;
    std::vector<Action::Answer> answers;

    [[nodiscard]] Action action() {
        return {.name = "/set_pose",
                .request_name = "crspf.SetPose",
                .request_schema = R"({"type":"object"})",
                .call = [this](const Json& request, const Action::Answer& answer) {
                    requests.push_back(request);
                    answers.push_back(answer);
                }};
    }
};

TEST_CASE("Everybody is told first who is there and what there is", "[hub]") {
    Bench bench;
    HubPeer peer(bench.hub);
    const std::vector<Json> said = texts(drain(peer));
    REQUIRE(said.size() == 2);
    CHECK(said[0]["op"] == "serverInfo");
    CHECK(said[0]["capabilities"] == Json::array());
    CHECK(said[0]["supportedEncodings"] == Json{"json"});
    CHECK(said[0]["metadata"]["version"] == "1.2.3");
    CHECK(said[1]["op"] == "advertise");
    REQUIRE(said[1]["channels"].size() == bench.channels.all().size());
    for (std::size_t id = 0; id < bench.channels.all().size(); ++id) {
        const Json& channel = said[1]["channels"][id];
        CHECK(channel["id"] == id);
        CHECK(channel["topic"] == bench.channels.all()[id].topic);
        CHECK(channel["encoding"] == "json");
        CHECK(channel["schemaEncoding"] == "jsonschema");
        CHECK(Json::parse(channel["schema"].get<std::string>()).is_object());
    }
}

TEST_CASE("Actions are advertised as services, and only where there are some", "[hub]") {
    Asked asked;
    Bench bench({asked.action()});
    HubPeer peer(bench.hub);
    const std::vector<Json> said = texts(drain(peer));
    REQUIRE(said.size() == 3);
    CHECK(said[0]["capabilities"] == Json{"services"});
    CHECK(said[2]["op"] == "advertiseServices");
    CHECK(said[2]["services"][0]["id"] == 0);
    CHECK(said[2]["services"][0]["name"] == "/set_pose");
    CHECK(said[2]["services"][0]["request"]["encoding"] == "json");
}

TEST_CASE("Who has subscribed is sent what comes, with its own number and the stamp, who has not, nothing", "[hub]") {
    Bench bench;
    HubPeer peer(bench.hub);
    HubPeer other(bench.hub);
    drain(peer);
    drain(other);
    bench.subscribe(peer, 77, "/pose");
    bench.channels.take(scan_at(0x0102030405060708));
    const std::vector<Outgoing> sent = drain(peer);
    REQUIRE(sent.size() == 1);
    CHECK(sent[0].binary);
    const std::string head("\x01\x4d\x00\x00\x00\x08\x07\x06\x05\x04\x03\x02\x01", 13);
    CHECK(sent[0].head == head);
    CHECK(Json::parse(sent[0].body->data)["frame_id"] == "map");
    CHECK(sent[0].size() == head.size() + sent[0].body->data.size());
    CHECK(drain(other).empty());
    CHECK(bench.hub.counters().messages == 1);

    peer.take_text(R"({"op":"unsubscribe","subscriptionIds":[77]})");
    bench.channels.take(scan_at(2));
    CHECK(drain(peer).empty());
}

TEST_CASE("Who comes late is sent the newest, and who was slow has missed what was between", "[hub]") {
    Bench bench;
    HubPeer peer(bench.hub);
    drain(peer);
    bench.channels.take(scan_at(1));
    bench.subscribe(peer, 1, "/pose");
    REQUIRE(drain(peer).size() == 1);
    for (std::int64_t i = 2; i <= 500; ++i) {
        bench.channels.take(scan_at(i));
    }
    const std::vector<Outgoing> sent = drain(peer);
    REQUIRE(sent.size() == 1);
    CHECK(sent[0].body->stamp_ns == 500);
}

TEST_CASE("No subscription waits for another that always has something", "[hub]") {
    Bench bench;
    HubPeer peer(bench.hub);
    drain(peer);
    for (std::int64_t i = 1; i <= 100; ++i) {
        bench.channels.take(scan_at(i));
    }
    bench.subscribe(peer, 1, "/match");  // keeps hundreds
    bench.subscribe(peer, 2, "/pose");
    bool pose_seen = false;
    for (int i = 0; i < 2; ++i) {
        pose_seen = u32_at(peer.next().value().head, 1) == 2 || pose_seen;
    }
    CHECK(pose_seen);
    CHECK(drain(peer).size() == 99);
}

TEST_CASE("An action is called with its request, and its answer goes to who has asked", "[hub]") {
    Asked asked;
    Bench bench({asked.action()});
    HubPeer peer(bench.hub);
    HubPeer other(bench.hub);
    drain(peer);
    drain(other);
    peer.take_binary(call_bytes(0, 9, R"({"x_m":1.5})"));
    REQUIRE(asked.requests.size() == 1);
    CHECK(asked.requests[0]["x_m"] == 1.5);
    CHECK(drain(peer).empty());  // no answer yet
    asked.answers[0]("");
    const std::vector<Outgoing> sent = drain(peer);
    REQUIRE(sent.size() == 1);
    const std::string& bytes = sent[0].head;
    CHECK(sent[0].binary);
    CHECK(bytes[0] == '\x03');
    CHECK(u32_at(bytes, 1) == 0);
    CHECK(u32_at(bytes, 5) == 9);
    CHECK(bytes.substr(13, u32_at(bytes, 9)) == "json");
    CHECK(Json::parse(bytes.substr(17)) == Json{{"ok", true}, {"error", ""}});

    peer.take_binary(call_bytes(0, 10, "{}"));
    asked.answers[1]("the service is away");
    CHECK(Json::parse(drain(peer).at(0).head.substr(17)) == Json{{"ok", false}, {"error", "the service is away"}});
    CHECK(drain(other).empty());
    CHECK(bench.hub.counters().calls == 2);
}

TEST_CASE("An answer for a peer that has gone is nobody's", "[hub]") {
    Asked asked;
    Bench bench({asked.action()});
    {
        HubPeer peer(bench.hub);
        peer.take_binary(call_bytes(0, 1, "{}"));
    }
    REQUIRE(asked.answers.size() == 1);
    CHECK_NOTHROW(asked.answers[0](""));
}

TEST_CASE("What cannot be understood or granted is answered and counted, and changes nothing", "[hub]") {
    Asked asked;
    Bench bench({asked.action()});
    HubPeer peer(bench.hub);
    drain(peer);
    const auto [text, binary] = GENERATE(table<std::string, bool>({
        {"", false},
        {"{", false},
        {"[]", false},
        {R"({"op":7})", false},
        {R"({"op":"advertise","channels":[]})", false},
        {R"({"op":"subscribe"})", false},
        {R"({"op":"subscribe","subscriptions":[7]})", false},
        {R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":0}]})", false},
        {R"({"op":"subscribe","subscriptions":[{"id":1.5,"channelId":0}]})", false},
        {R"({"op":"subscribe","subscriptions":[{"id":4294967296,"channelId":0}]})", false},
        {R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":99}]})", false},
        {R"({"op":"unsubscribe","subscriptionIds":[5]})", false},
        {"\xff\xfe", false},
        {"", true},
        {"\x07", true},
        {"\x02short", true},
        {call_bytes(0, 1, "no json"), true},
        {call_bytes(0, 1, "[]"), true},
        {call_bytes(1, 1, "{}"), true},
        {call_bytes(0, 1, "{}", "json", 0xFFFFFFFF), true},
        {call_bytes(0, 1, "{}", "cdr!"), true},
    }));
    CAPTURE(text, binary);
    binary ? peer.take_binary(text) : peer.take_text(text);
    bench.channels.take(scan_at(1));
    const std::vector<Json> said = texts(drain(peer));
    REQUIRE(!said.empty());
    CHECK(said[0]["op"] == "status");
    CHECK(said[0]["level"] == 2);
    CHECK(!said[0]["message"].get<std::string>().empty());
    CHECK(bench.hub.counters().mistakes == 1);
    CHECK(asked.requests.empty());
    CHECK_FALSE(peer.cut_off());
}

TEST_CASE("A call that fails is told to its caller as the protocol has it", "[hub]") {
    Bench bench;
    HubPeer peer(bench.hub);
    drain(peer);
    peer.take_binary(call_bytes(3, 8, "{}"));
    const std::vector<Json> said = texts(drain(peer));
    REQUIRE(said.size() == 2);
    CHECK(said[1]["op"] == "serviceCallFailure");
    CHECK(said[1]["serviceId"] == 3);
    CHECK(said[1]["callId"] == 8);
}

TEST_CASE("A subscription's number is used once", "[hub]") {
    Bench bench;
    HubPeer peer(bench.hub);
    drain(peer);
    bench.subscribe(peer, 1, "/pose");
    bench.subscribe(peer, 1, "/match");
    bench.channels.take(scan_at(1));
    const std::vector<Outgoing> sent = drain(peer);
    CHECK(texts(sent).size() == 1);
    CHECK(sent.size() == 2);  // the complaint and the pose
}

TEST_CASE("Who goes on with nonsense, sends too much or asks and does not read is cut off", "[hub]") {
    Asked asked;
    Bench bench({asked.action()});
    HubPeer peer(bench.hub);
    SECTION("nonsense") {
        for (int i = 0; i < 100; ++i) {
            peer.take_text("nonsense");
        }
    }
    SECTION("a list of nonsense") {
        Json wishes = Json::array();
        wishes.insert(wishes.end(), 10'000, Json(7));
        peer.take_text(Json{{"op", "subscribe"}, {"subscriptions", wishes}}.dump());
    }
    SECTION("too much") {
        peer.take_text(std::string(Hub::kIncomingMax + 1, ' '));
    }
    SECTION("too much in binary") {
        peer.take_binary(std::string(Hub::kIncomingMax + 1, '\x02'));
    }
    SECTION("asks and does not read") {
        for (std::uint32_t i = 0; i < 1000; ++i) {
            peer.take_binary(call_bytes(0, i, "{}"));
        }
        CHECK(asked.requests.size() < 100);
    }
    CHECK(peer.cut_off());
    CHECK(bench.hub.counters().cut_off == 1);
    CHECK(drain(peer).size() < 100);
}

TEST_CASE("Subscriptions have a bound", "[hub]") {
    Bench bench;
    HubPeer peer(bench.hub);
    drain(peer);
    Json wishes = Json::array();
    for (std::uint32_t i = 0; i < 70; ++i) {
        wishes.push_back({{"id", i}, {"channelId", bench.id_of("/pose")}});
    }
    peer.take_text(Json{{"op", "subscribe"}, {"subscriptions", wishes}}.dump());
    bench.channels.take(scan_at(1));
    const std::vector<Outgoing> sent = drain(peer);
    CHECK(std::count_if(sent.begin(), sent.end(), [](const Outgoing& each) { return each.binary; }) == 64);
}

}  // namespace
