#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "platform/files/input_error.hpp"
#include "tests/support/resident.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tests/unit/view/web_client.hpp"
#include "tools/view/listening_socket.hpp"
#include "tools/view/page_files.hpp"

namespace {

using namespace crspf::view;
using crspf::InputError;
using crspf::test::serve_until;
using crspf::test::WebClient;
using Json = nlohmann::json;

struct Served {
    explicit Served(WebServerOptions options = {})
        : hub(channels, "1", {}),
          server(at_any_port(std::move(options)), hub, [] { return std::string("crspf_up 1\n"); }) {}
    static WebServerOptions at_any_port(WebServerOptions options) {
        options.port = 0;
        return options;
    }
    [[nodiscard]] std::string origin() const { return "http://127.0.0.1:" + std::to_string(server.port()); }
    [[nodiscard]] std::size_t id_of(const std::string& topic) const {
        std::size_t id = 0;
        while (channels.all().at(id).topic != topic) {
            ++id;
        }
        return id;
    }
    [[nodiscard]] std::string subscribe(const std::string& topic) const {
        return Json{{"op", "subscribe"}, {"subscriptions", {{{"id", id_of(topic)}, {"channelId", id_of(topic)}}}}}
            .dump();
    }

    Channels channels;
    Hub hub;
    WebServer server;
};

bool has_status(const std::string& answer, const std::string& code) {
    constexpr std::size_t kVersion = 9;  // "HTTP/1.1 ", or 1.0 where the library itself answers
    return answer.compare(0, 7, "HTTP/1.") == 0 && answer.compare(kVersion, code.size(), code) == 0;
}

bool contains(const std::string& text, std::string_view part) {
    return text.find(part) != std::string::npos;
}

TEST_CASE("The page's files come whole, with their types and a policy that lets nothing else in", "[web]") {
    Served served;
    REQUIRE(page_files().size() > 3);
    for (const PageFile& file : page_files()) {
        CAPTURE(file.path);
        const std::string answer = WebClient(served.server).get(std::string(file.path));
        CHECK(has_status(answer, "200"));
        CHECK(contains(answer, "content-type: " + std::string(file.content_type) + "\r\n"));
        CHECK(contains(answer, "content-security-policy: default-src 'self';"));
        CHECK(contains(answer, "x-content-type-options: nosniff"));
        CHECK(answer.substr(answer.find("\r\n\r\n") + 4) == file.content);
    }
    CHECK(served.server.counters().requests == page_files().size());
}

TEST_CASE("A turn comes back after its time, be that none", "[web]") {
    Served served;
    for (int i = 0; i < 100; ++i) {
        served.server.serve({0});
        served.server.serve({1000});
    }
    CHECK(has_status(WebClient(served.server).get("/"), "200"));
}

TEST_CASE("What there is not, and what nobody may do, is answered so", "[web]") {
    Served served;
    const std::string host = "localhost:" + std::to_string(served.server.port());
    CHECK(has_status(WebClient(served.server).get("/etc/passwd"), "404"));
    CHECK(has_status(WebClient(served.server).get("/../../etc/passwd"), "40"));
    CHECK(has_status(WebClient(served.server).ask("POST /", host, "Content-Length: 0\r\n"), "405"));
    const std::string head = WebClient(served.server).ask("HEAD /view.js", host);
    CHECK(has_status(head, "200"));
    CHECK(head.substr(head.find("\r\n\r\n")) == "\r\n\r\n");
    CHECK(has_status(WebClient(served.server).get("/"), "200"));
}

TEST_CASE("On the loopback only the machine's own names are answered to", "[web]") {
    Served served;
    const auto [host, status] = GENERATE(table<std::string, std::string>({{"127.0.0.1:8765", "200"},
                                                                          {"127.0.0.1", "200"},
                                                                          {"127.1.2.3:1", "200"},
                                                                          {"localhost:8765", "200"},
                                                                          {"[::1]:8765", "200"},
                                                                          {"evil.example", "403"},
                                                                          {"evil.example:8765", "403"},
                                                                          {"127.0.0.1.evil.example", "403"},
                                                                          {"localhost.evil.example", "403"},
                                                                          {"127.evil", "403"},
                                                                          {"192.168.1.5:8765", "403"}}));
    CAPTURE(host);
    CHECK(has_status(WebClient(served.server).ask("GET /", host), status));
    CHECK(has_status(WebClient(served.server).ask("GET /metrics", host), status));
}

TEST_CASE("On the loopback a page of elsewhere gets no WebSocket unless it is allowed to", "[web]") {
    WebServerOptions options;
    options.allowed_origins = {"https://app.example"};
    Served served(options);
    CHECK(has_status(WebClient(served.server).upgrade(), "101"));
    CHECK(has_status(WebClient(served.server).upgrade("/", "Origin: " + served.origin() + "\r\n"), "101"));
    CHECK(has_status(WebClient(served.server).upgrade("/", "Origin: https://app.example\r\n"), "101"));
    CHECK(has_status(WebClient(served.server).upgrade("/", "Origin: https://evil.example\r\n"), "403"));
    CHECK(has_status(WebClient(served.server).upgrade("/", "Origin: null\r\n"), "403"));
    CHECK(has_status(WebClient(served.server).upgrade("/", "Origin: http://127.0.0.1:1\r\n"), "403"));
    CHECK(served.server.counters().refused == 3);
}

TEST_CASE("A token opens the robot's data, in the URL or as a bearer, the page's files are open", "[web]") {
    const std::string token = "0123456789abcdef0123456789abcdef";
    WebServerOptions options;
    options.token = token;
    Served served(options);
    CHECK(has_status(WebClient(served.server).get("/"), "200"));
    CHECK(has_status(WebClient(served.server).get("/metrics"), "401"));
    CHECK(has_status(WebClient(served.server).get("/metrics?token=" + token + "0"), "401"));
    CHECK(has_status(WebClient(served.server).get("/metrics", "Authorization: Basic " + token + "\r\n"), "401"));
    CHECK(has_status(WebClient(served.server).get("/metrics?token=" + token), "200"));
    CHECK(
        contains(WebClient(served.server).get("/metrics", "Authorization: Bearer " + token + "\r\n"), "crspf_up 1\n"));
    CHECK(has_status(WebClient(served.server).upgrade("/"), "401"));
    CHECK(has_status(WebClient(served.server).upgrade("/?token=wrong"), "401"));
    CHECK(has_status(WebClient(served.server).upgrade("/?token=" + token), "101"));
    CHECK(has_status(WebClient(served.server).upgrade("/", "Authorization: Bearer " + token + "\r\n"), "101"));
}

TEST_CASE("Where others can reach it a token is made, another each time", "[web]") {
    WebServerOptions options;
    options.listen = "0.0.0.0";
    Served open(options);
    CHECK(open.server.rules().token.size() == 32);
    CHECK(open.server.rules().token != make_token());
    CHECK_FALSE(open.server.rules().loopback);
    CHECK(Served().server.rules().token.empty());
    // There names do not matter, nor do pages: the token does.
    CHECK(has_status(WebClient(open.server).ask("GET /metrics", "robot.example"), "401"));
    CHECK(has_status(WebClient(open.server).ask("GET /metrics?token=" + open.server.rules().token, "robot.example"),
                     "200"));
}

TEST_CASE("A token's file is one line that fits a URL and that not everybody reads", "[web]") {
    const crspf::test::Scratch scratch;
    const auto token_in = [&](const std::string& content, unsigned mode) {
        const std::string file = scratch.file("token", content).string();
        REQUIRE(::chmod(file.c_str(), mode) == 0);
        return token_of_file(file);
    };
    CHECK(token_in("0123456789abcdef\n", 0600) == "0123456789abcdef");
    CHECK_THROWS_WITH(token_in("0123456789abcdef\n", 0644), Catch::Contains("chmod"));
    CHECK_THROWS_WITH(token_in("short\n", 0600), Catch::Contains("openssl rand"));
    CHECK_THROWS_WITH(token_in("0123456789 abcdef&x\n", 0600), Catch::Contains("not a token"));
    CHECK_THROWS_AS(token_of_file((scratch / "absent").string()), InputError);
}

TEST_CASE("An address that cannot be had is named, with what to do", "[web]") {
    const ListeningSocket taken = listen_at("127.0.0.1", 0);
    const std::string port = std::to_string(taken.port);
    CHECK_THROWS_WITH(listen_at("127.0.0.1", taken.port), Catch::Contains(port) && Catch::Contains("another --port"));
    CHECK_THROWS_WITH(listen_at("203.0.113.77", 0), Catch::Contains("203.0.113.77") && Catch::Contains("ip address"));
    CHECK_THROWS_WITH(listen_at("no such host", 0), Catch::Contains("no such host"));
}

TEST_CASE("A WebSocket of another protocol is not opened", "[web]") {
    Served served;
    const std::string protocol = GENERATE("other", "http", "accept");
    CAPTURE(protocol);
    CHECK_FALSE(has_status(WebClient(served.server).upgrade("/", "", protocol), "101"));
    CHECK(has_status(WebClient(served.server).upgrade(), "101"));
}

TEST_CASE("A viewer is greeted, subscribes and gets messages of any size whole", "[web]") {
    Served served;
    WebClient client(served.server);
    REQUIRE(has_status(client.upgrade(), "101"));
    CHECK(Json::parse(client.next_message().value().payload)["op"] == "serverInfo");
    CHECK(Json::parse(client.next_message().value().payload)["op"] == "advertise");
    client.send_text(served.subscribe("/log"));
    const std::string large(300'000, 'x');
    for (const std::string& text : {std::string("small"), large}) {
        served.channels.take(LogLine{.stamp_ns = 5, .level = LogLine::Level::kInfo, .text = text});
        const auto message = client.next_message();
        REQUIRE(message);
        CHECK(message->opcode == 2);
        CHECK(message->payload[0] == '\x01');
        CHECK(Json::parse(message->payload.substr(13))["message"] == text);
    }
    CHECK(served.server.counters().peers == 1);
}

TEST_CASE("A message in pieces is put together", "[web]") {
    Served served;
    WebClient client(served.server);
    REQUIRE(has_status(client.upgrade(), "101"));
    const std::string text = served.subscribe("/log");
    const std::string first = text.substr(0, 10);
    const std::string rest = text.substr(10);
    client.send(std::string("\x01\x8a\0\0\0\0", 6) + first);
    served.server.serve({1'000'000});
    client.send(std::string("\x80", 1) + static_cast<char>(0x80 | static_cast<int>(rest.size())) +
                std::string(4, '\0') + rest);
    served.channels.take(LogLine{.stamp_ns = 5, .level = LogLine::Level::kInfo, .text = "heard"});
    client.next_message();
    client.next_message();
    CHECK(contains(client.next_message().value().payload, "heard"));
}

TEST_CASE("Who sends nonsense without end is cut off, and nobody else notices", "[web]") {
    Served served;
    WebClient good(served.server);
    REQUIRE(has_status(good.upgrade(), "101"));
    good.send_text(served.subscribe("/log"));
    auto bad = std::make_unique<WebClient>(served.server);
    REQUIRE(has_status(bad->upgrade(), "101"));
    SECTION("what is no JSON") {
        for (int i = 0; i < 30; ++i) {
            bad->send_text("nonsense");
        }
    }
    SECTION("too much at once") {
        bad->send(std::string("\x81\xff\0\0\0\0\0\x10\0\0\0\0\0\0", 14));  // 1 MiB is announced
        bad->send(std::string(100'000, ' '));
    }
    SECTION("what is no UTF-8") {
        bad->send_text("\xff\xfe\xff");
    }
    SECTION("what is no frame") {
        bad->send(std::string(200, '\xff'));
    }
    // A close frame, for what is against the WebSocket's own rules, or the connection's end.
    CHECK(serve_until(served.server, [&] { return !bad->receive() || contains(bad->received, "\x88"); }));
    bad.reset();
    CHECK(serve_until(served.server, [&] { return served.server.counters().peers == 1; }));
    served.channels.take(LogLine{.stamp_ns = 5, .level = LogLine::Level::kInfo, .text = "still here"});
    good.next_message();
    good.next_message();
    CHECK(contains(good.next_message().value().payload, "still here"));
}

TEST_CASE("There are so many viewers at most", "[web]") {
    Served served;
    std::vector<std::unique_ptr<WebClient>> clients;
    for (std::size_t i = 0; i < WebServer::kPeersMax; ++i) {
        clients.push_back(std::make_unique<WebClient>(served.server));
        REQUIRE(has_status(clients.back()->upgrade(), "101"));
    }
    CHECK(has_status(WebClient(served.server).upgrade(), "503"));
    CHECK(served.server.counters().full == 1);
    clients.pop_back();
    REQUIRE(serve_until(served.server, [&] { return served.server.counters().peers < WebServer::kPeersMax; }));
    CHECK(has_status(WebClient(served.server).upgrade(), "101"));
}

/// 100 kB of scan.
ScanEvent large_scan(std::int64_t stamp_ns) {
    ScanEvent scan;
    scan.stamp_ns = stamp_ns;
    scan.points.resize(8000, {.x_m = 1.0F, .y_m = 2.0F, .critical = false});
    return scan;
}

TEST_CASE("Ten viewers that do not read cost no memory and hold nobody up, when they read they get the newest",
          "[web]") {
    constexpr std::int64_t kScans = 200;  // 19 MB for each that keeps up; in 30 s the silent ones are cut off
    constexpr double kGrowth_mib = 16.0;
    constexpr int kReceiveBuffer = 8192;
    Served served;
    std::vector<std::unique_ptr<WebClient>> slow;
    for (int i = 0; i < 10; ++i) {
        slow.push_back(std::make_unique<WebClient>(served.server, kReceiveBuffer));
        REQUIRE(has_status(slow.back()->upgrade(), "101"));
        slow.back()->send_text(served.subscribe("/scan"));
    }
    WebClient quick(served.server);
    REQUIRE(has_status(quick.upgrade(), "101"));
    quick.send_text(served.subscribe("/scan"));
    quick.next_message();
    quick.next_message();
    const auto stamp_of = [](const WebClient::Frame& message) {
        return Json::parse(message.payload.substr(13))["timestamp"]["nsec"].get<std::int64_t>();
    };
    for (std::int64_t i = 1; i <= 20; ++i) {  // buffers fill
        served.channels.take(large_scan(i));
        quick.next_message();
    }
    const double before_mib = crspf::test::resident_mib();
    std::size_t size = 0;
    for (std::int64_t i = 21; i <= kScans; ++i) {
        served.channels.take(large_scan(i));
        const WebClient::Frame message = quick.next_message().value();
        REQUIRE(stamp_of(message) == i);
        size = message.payload.size();
    }
    const double grown_mib = crspf::test::resident_mib() - before_mib;
    CHECK(grown_mib < kGrowth_mib);
    CHECK(served.server.counters().peers == 11);

    slow.front()->next_message();
    slow.front()->next_message();
    std::int64_t stamp = 0;
    int read = 0;
    while (stamp < kScans) {
        stamp = stamp_of(slow.front()->next_message().value());
        ++read;
    }
    CHECK(read < 20);  // what was on its way, and the newest
    std::printf("ten viewers that do not read: %.1f MiB more in %lld scans of %.0f kB; then %d of them to the newest\n",
                grown_mib, static_cast<long long>(kScans - 20), 1e-3 * static_cast<double>(size), read);
}

TEST_CASE("The control of the memory's measure: what is kept is seen", "[web]") {
    const double before_mib = crspf::test::resident_mib();
    const std::vector<std::string> kept(60, std::string(1'000'000, 'x'));
    CHECK(crspf::test::resident_mib() - before_mib > 16.0);
}

}  // namespace
