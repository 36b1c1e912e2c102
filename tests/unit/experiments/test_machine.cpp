#include <catch2/catch.hpp>
#include <string>

#include "tools/experiments/report/machine.hpp"

using crspf::experiments::processor_in;
using crspf::experiments::this_machine;

TEST_CASE("The processor's name is that of /proc/cpuinfo", "[experiments][machine]") {
    CHECK(processor_in("processor\t: 0\nmodel\t\t: 85\nmodel name\t: Some CPU @ 2 GHz\nprocessor\t: 1\n") ==
          "Some CPU @ 2 GHz");
    CHECK(processor_in("processor\t: 0\nHardware\t: BCM2835\nModel\t\t: Raspberry Pi 4\n") == "Raspberry Pi 4");
    CHECK(processor_in("processor\t: 0\nCPU part\t: 0xd08\n").empty());
    CHECK(processor_in("model name").empty());
}

TEST_CASE("This machine has a name", "[experiments][machine]") {
    CHECK(this_machine().find("Linux") != std::string::npos);
}
