#include "platform/service/preflight_needs.hpp"

#include <catch2/catch.hpp>

#include "core/slam/pipeline.hpp"

using crspf::needs_of;
using crspf::parse_config;
using crspf::PreflightDevice;
using crspf::PreflightNeeds;

TEST_CASE("preflight needs: each source's port, as configured") {
    const PreflightNeeds needs = needs_of(parse_config(R"(
[source.a]
driver = "scip"
port = "/dev/ttyACM0"
[source.b]
driver = "sick"
port = "tcp://192.168.0.1:2112"
record_only = true
[source.c]
driver = "velodyne"
port = "udp://:2368"
record_only = true
[source.d]
driver = "can"
port = "can0"
record_only = true
)",
                                                       "robot.toml"));
    REQUIRE(needs.devices.size() == 4);
    CHECK(needs.devices[0].name == "a");
    CHECK(needs.devices[0].kind == PreflightDevice::Kind::kSerial);
    CHECK(needs.devices[0].device == "/dev/ttyACM0");
    CHECK(needs.devices[1].kind == PreflightDevice::Kind::kTcp);
    CHECK(needs.devices[1].address == 0xC0A80001);
    CHECK(needs.devices[1].port == 2112);
    CHECK(needs.devices[2].kind == PreflightDevice::Kind::kUdp);
    CHECK(needs.devices[2].port == 2368);
    CHECK(needs.devices[3].kind == PreflightDevice::Kind::kCan);
    CHECK(needs.devices[3].device == "can0");
    CHECK(needs.memory_bytes > sizeof(crspf::Pipeline));
    CHECK(needs.directory == "/var/lib/crspf");
    CHECK(needs.priority == 75);
    CHECK(needs.cpus.empty());
}

TEST_CASE("preflight needs: the threads' priorities and processors, the directory") {
    const PreflightNeeds needs =
        needs_of(parse_config("[threads]\nfilter_priority = 90\nfilter_cpus = [1]\nmap_cpus = [0, "
                              "2]\n[service]\nstate_directory = \"/srv/x\"\n",
                              "robot.toml"));
    CHECK(needs.priority == 90);
    CHECK(needs.cpus == std::vector<int>{1, 0, 2});
    CHECK(needs.directory == "/srv/x");
}
