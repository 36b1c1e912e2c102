// The connection against brokers that do not do as brokers should; tests/checks/mqtt.sh has a real one.
#include "tools/mqtt/broker_link.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <catch2/catch.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "platform/files/unique_fd.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "tests/support/resident.hpp"

using namespace crspf;
using namespace crspf::mqtt;

namespace {

constexpr Duration kTurn{2'000'000};
constexpr std::string_view kGranted("\x20\x02\x00\x00", 4);
constexpr std::string_view kBadPassword("\x20\x02\x00\x04", 4);

/// Listens on the loopback; says what it is told to say, and reads what it is told to read.
class FakeBroker {
 public:
    FakeBroker() : listener_(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof address;
        const int small = 4096;
        REQUIRE(::setsockopt(listener_.get(), SOL_SOCKET, SO_RCVBUF, &small, sizeof small) == 0);
        // NOLINTBEGIN(cppcoreguidelines-pro-type-reinterpret-cast): sockets' addresses
        REQUIRE(::bind(listener_.get(), reinterpret_cast<const sockaddr*>(&address), size) == 0);
        REQUIRE(::listen(listener_.get(), 8) == 0);
        REQUIRE(::getsockname(listener_.get(), reinterpret_cast<sockaddr*>(&address), &size) == 0);
        // NOLINTEND(cppcoreguidelines-pro-type-reinterpret-cast)
        port_ = ntohs(address.sin_port);
    }
    [[nodiscard]] std::uint16_t port() const { return port_; }
    [[nodiscard]] bool accept() {
        peer_ = UniqueFd(::accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
        return peer_.valid();
    }
    std::string read() {
        std::array<char, 65536> buffer{};
        const ssize_t got = ::recv(peer_.get(), buffer.data(), buffer.size(), 0);
        return {buffer.data(), got > 0 ? static_cast<std::size_t>(got) : 0U};
    }
    void say(std::string_view bytes) { ::send(peer_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL); }
    void hang_up() { peer_ = UniqueFd(); }
    void stop_listening() { listener_ = UniqueFd(); }

 private:
    UniqueFd listener_;
    UniqueFd peer_;
    std::uint16_t port_ = 0;
};

struct Bench {
    explicit Bench(const std::string& user = {})
        : link(options(broker.port(), user), [this](const std::string& line) { said.push_back(line); }) {}

    static BrokerOptions options(std::uint16_t port, const std::string& user) {
        BrokerOptions options;
        options.address = {.host = "127.0.0.1", .port = port};
        options.client_id = "robot";
        options.user = user;
        options.password = user.empty() ? "" : "secret-word";
        options.will = {.topic = "r/online", .payload = "false", .acknowledged = true, .retained = true};
        return options;
    }
    template <class Done>
    [[nodiscard]] bool until(const Done& done) {
        for (int i = 0; i < 5000; ++i) {
            link.turn(kTurn);
            if (done()) {
                return true;
            }
        }
        return false;
    }
    void connect() {
        REQUIRE(until([this] { return broker.accept(); }));
        REQUIRE(until([this] { return !(connect_packet += broker.read()).empty(); }));
        broker.say(kGranted);
        const std::uint64_t before = link.connections();
        REQUIRE(until([&] { return link.connections() > before; }));
    }

    FakeBroker broker;
    std::vector<std::string> said;
    std::string connect_packet;
    BrokerLink link;
};

Publication message(bool acknowledged, std::size_t size = 10) {
    return {.topic = "r/x", .payload = std::string(size, 'x'), .acknowledged = acknowledged};
}

}  // namespace

TEST_CASE("broker link: the connection carries name, will and user") {
    Bench bench("forklift");
    CHECK_FALSE(bench.link.takes());
    bench.connect();
    CHECK(bench.link.takes());
    for (const char* part : {"MQTT\x04", "robot", "r/online", "false", "forklift", "secret-word"}) {
        CHECK(bench.connect_packet.find(part) != std::string::npos);
    }
    CHECK(bench.said.back() == "127.0.0.1:" + std::to_string(bench.broker.port()) + ": connected");
}

TEST_CASE("broker link: a refused user is told by name, once, and it is tried again") {
    Bench bench("forklift");
    for (int i = 0; i < 2; ++i) {
        REQUIRE(bench.until([&] { return bench.broker.accept(); }));
        bench.broker.say(kBadPassword);
        REQUIRE(bench.until([&] { return !bench.said.empty(); }));
    }
    CHECK(bench.said.size() == 1);
    CHECK_THAT(bench.said[0], Catch::Contains("refuses the user forklift; check --user, --password-file"));
    CHECK(bench.said[0].find("secret-word") == std::string::npos);
    CHECK(bench.link.connections() == 0);
}

TEST_CASE("broker link: a lost connection is another one later, and nothing of the first comes in the second") {
    Bench bench;
    bench.connect();
    bench.link.publish({.topic = "r/x", .payload = "never-acknowledged", .acknowledged = true});
    REQUIRE(bench.until([&] { return bench.broker.read().find("never-acknowledged") != std::string::npos; }));
    bench.broker.hang_up();
    REQUIRE(bench.until([&] { return !bench.link.takes(); }));
    CHECK_THAT(bench.said.back(), Catch::Contains("the connection is lost; trying again"));
    bench.connect();
    bench.link.publish({.topic = "r/x", .payload = "the-second", .acknowledged = false});
    std::string heard;
    REQUIRE(bench.until([&] { return (heard += bench.broker.read()).find("the-second") != std::string::npos; }));
    CHECK(heard.find("never-acknowledged") == std::string::npos);
}

TEST_CASE("broker link: what is no broker is told of") {
    Bench bench;
    REQUIRE(bench.until([&] { return bench.broker.accept(); }));
    bench.broker.say("HTTP/1.1 400 Bad Request\r\n\r\n" + std::string(200, ' '));
    REQUIRE(bench.until([&] { return !bench.said.empty(); }));
    CHECK_THAT(bench.said[0], Catch::Contains("is that a broker's port"));
    bench.broker.hang_up();
    bench.broker.stop_listening();
    REQUIRE(bench.until([&] { return bench.said.size() > 1; }));
    CHECK_THAT(bench.said[1], Catch::Contains("Connection refused; does the broker run there?"));
}

namespace {

/// Offers messages of 100 kB to a broker that does not read. @return how many were published
int offer(Bench& bench, bool acknowledged, int count, bool asking) {
    constexpr std::size_t kSize = 100'000;
    int published = 0;
    for (int i = 0; i < count; ++i) {
        if (!asking || bench.link.takes()) {
            bench.link.publish(message(acknowledged, kSize));
            ++published;
        }
        bench.link.turn(Duration{});
    }
    return published;
}

}  // namespace

TEST_CASE("broker link: a broker that does not read costs no memory") {
    for (const bool acknowledged : {true, false}) {
        CAPTURE(acknowledged);
        Bench bench;
        bench.connect();
        const int filling = offer(bench, acknowledged, 100, true);  // buffers
        const double before_mib = test::resident_mib();
        CHECK(filling + offer(bench, acknowledged, 600, true) < 200);
        CHECK(test::resident_mib() - before_mib < 4.0);
    }
}

TEST_CASE("broker link: the control: without asking for room it costs memory") {
    Bench bench;
    bench.connect();
    const double before_mib = test::resident_mib();
    CHECK(offer(bench, false, 700, false) == 700);
    CHECK(test::resident_mib() - before_mib > 30.0);
}
