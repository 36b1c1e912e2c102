#include "tools/mqtt/broker_address.hpp"

#include <catch2/catch.hpp>

#include "platform/files/input_error.hpp"

using namespace crspf::mqtt;

TEST_CASE("broker address: a host, with or without a port") {
    CHECK(parse_broker("broker.example", false) == BrokerAddress{.host = "broker.example", .port = 1883});
    CHECK(parse_broker("broker.example", true) == BrokerAddress{.host = "broker.example", .port = 8883});
    CHECK(parse_broker("10.0.0.1:65535", true) == BrokerAddress{.host = "10.0.0.1", .port = 65535});
    CHECK(parse_broker("[fd00::1]", false) == BrokerAddress{.host = "fd00::1", .port = 1883});
    CHECK(parse_broker("[fd00::1]:1", false) == BrokerAddress{.host = "fd00::1", .port = 1});
    for (const char* text : {"broker.example:1883", "[fd00::1]:8883"}) {
        CHECK(text_of(parse_broker(text, false)) == text);
    }
}

TEST_CASE("broker address: all else is refused, with what was said and what it should be") {
    for (const char* text : {"", ":1883", "host:", "host:0", "host:65536", "host:-1", "host:1883x", "host:1:2",
                             "fd00::1", "[fd00::1", "[]:1", "[fd00::1]1883", "mqtt://host", "user@host", "two words"}) {
        CAPTURE(text);
        CHECK_THROWS_WITH(parse_broker(text, false),
                          Catch::Contains("--broker " + std::string(text) + ": is no HOST[:PORT]"));
    }
}
