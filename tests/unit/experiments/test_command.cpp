#include <CLI/CLI.hpp>
#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <set>

#include "tests/unit/experiments/fakes.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tools/crspf/commands.hpp"

using crspf::InputError;
using crspf::test::content_of;
using crspf::test::kFakes;
using crspf::test::Scratch;

namespace {

void crspf_experiments(std::vector<std::string> arguments) {
    CLI::App app;
    crspf::cli::add_experiments(app, kFakes);
    std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them from the end
    arguments.emplace_back("experiments");
    app.parse(arguments);
}

std::set<std::string> names_in(const std::filesystem::path& directory) {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(directory)) {
        names.insert(entry.path().filename().string());
    }
    return names;
}

}  // namespace

TEST_CASE("crspf experiments writes the report and the figures that name a file", "[experiments][command]") {
    const Scratch folder;
    const std::filesystem::path out = folder / "a" / "report";
    crspf_experiments({"found", "absent", "--out", out.string(), "--seeds", "2"});
    CHECK(names_in(out) ==
          std::set<std::string>{"report.html", "report.json", "headlines.md", "claims.md", "line.svg", "map.png"});
    const auto json = nlohmann::json::parse(content_of(out / "report.json"));
    CHECK(json["command"] == "crspf experiments found absent --out " + out.string() + " --seeds 2");
    CHECK(json["experiments"][0]["command"] == "crspf experiments found --out " + out.string() + " --seeds 2");
    CHECK(json["experiments"][0]["seeds"] == "1 to 2");
    CHECK(json["experiments"].size() == 2);
    pugi::xml_document svg;
    CHECK(svg.load_file((out / "line.svg").c_str()));
    CHECK(content_of(out / "map.png").substr(1, 3) == "PNG");
    CHECK(content_of(out / "report.html").find("<!DOCTYPE html>") == 0);
}

TEST_CASE("A failed experiment leaves a report, and an exit status", "[experiments][command]") {
    const Scratch folder;
    CHECK_THROWS_AS(crspf_experiments({"found", "failing", "--out", folder.directory().string()}), InputError);
    const auto json = nlohmann::json::parse(content_of(folder / "report.json"));
    CHECK(json["experiments"][0]["failure"].is_null());
    CHECK(json["experiments"][1]["failure"] == "map.yaml:3: wrong; mend it");
    CHECK_THROWS_WITH(crspf_experiments({"--out", folder.directory().string()}),
                      Catch::Contains("report.html says which"));
    CHECK(nlohmann::json::parse(content_of(folder / "report.json"))["experiments"].size() == 4);
}

TEST_CASE("Wrong arguments are refused before the work", "[experiments][command]") {
    const Scratch folder;
    const std::string out = (folder / "out").string();
    CHECK_THROWS_AS(crspf_experiments({"found"}), CLI::RequiredError);
    CHECK_THROWS_WITH(crspf_experiments({"fuond", "--out", out}), Catch::Contains("there are found absent failing"));
    CHECK_THROWS_AS(crspf_experiments({"found", "--out", out, "--seeds", "0"}), CLI::ValidationError);
    CHECK_THROWS_AS(crspf_experiments({"found", "--out", out, "--seeds", "1001"}), CLI::ValidationError);
    CHECK_THROWS_AS(crspf_experiments({"found", "--out", out, "--data", out + "/none"}), InputError);
    CHECK_THROWS_AS(crspf_experiments({"found", "--out", out, "--maps", out + "/none"}), InputError);
    CHECK_FALSE(std::filesystem::exists(out));
    std::ofstream(folder / "file") << "no directory";
    CHECK_THROWS_AS(crspf_experiments({"found", "--out", (folder / "file").string()}), InputError);
}
