#include <catch2/catch.hpp>

#include "tests/unit/experiments/fakes.hpp"
#include "tools/experiments/report/markdown.hpp"
#include "tools/experiments/report/markup.hpp"

using crspf::experiments::claims_of;
using crspf::experiments::headlines_of;
using crspf::experiments::markdown_cell;
using crspf::test::sample_report;

TEST_CASE("The headlines are a table below the command that made it", "[experiments][markdown]") {
    CHECK(headlines_of(sample_report()) ==
          "Made by `crspf experiments --out 'a<b'`: version 1.2.3, 13, A&B processor, 2024-05-06T07:08:09Z.\n\n"
          "| run | result |\n|---|---|\n| the run | 3 seeds |\n");
}

TEST_CASE("The claims are a table with a row for each", "[experiments][markdown]") {
    const std::string text = claims_of(sample_report());
    CHECK(text.find("2 claims: 1 holds, 0 partly, 1 does not hold, 0 not measured.\n\n| experiment |") !=
          std::string::npos);
    CHECK(text.find("| found | It is &lt; 1 m | 0.5 m \\| 0.6 m | holds |  |\n") != std::string::npos);
    CHECK(text.find("| found | It never fails | once | does not hold | not found yet |\n") != std::string::npos);
}

TEST_CASE("A cell stays one cell", "[experiments][markdown]") {
    CHECK(markdown_cell("a|b\nc*d`e<f\\") == "a\\|b c\\*d\\`e&lt;f\\\\");
}
