#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>

#include "platform/crspfd/map_store.hpp"
#include "platform/files/input_error.hpp"
#include "platform/files/unique_fd.hpp"
#include "tests/unit/platform/scratch.hpp"

using namespace crspf;
using crspf::test::Scratch;

namespace {

/// Each number's map is another one.
GridMap map_of(int number) {
    GridMap map;
    map.width = 40 + number % 7;
    map.height = 30;
    map.resolution_m = 0.05;
    map.cells.assign(static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height), GridCell::kFree);
    map.cells[static_cast<std::size_t>(number % 1000)] = GridCell::kOccupied;
    return map;
}

void spoil(const std::filesystem::path& file) {
    std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
    stream.seekp(-1, std::ios::end);
    stream.put('x');
}

}  // namespace

TEST_CASE("map store: what was saved is there after a restart") {
    const Scratch scratch;
    const std::filesystem::path directory = scratch / "state";
    {
        MapStore store(directory);
        CHECK_FALSE(store.load());
        store.save_pose({});  // of no map: nothing happens
        CHECK(store.save(map_of(1), Pose2{.x_m = 1.0, .y_m = 2.0, .theta_rad = 0.1}) == directory / "map-1.yaml");
    }
    {
        MapStore store(directory);
        const auto saved = store.load();
        REQUIRE(saved);
        CHECK(saved->map.cells == map_of(1).cells);
        CHECK(saved->P_map_base == Pose2{.x_m = 1.0, .y_m = 2.0, .theta_rad = 0.1});
        CHECK(saved->warning.empty());
        store.save_pose({.x_m = 7.0, .y_m = 2.0, .theta_rad = 0.1});
    }
    MapStore store(directory);
    CHECK(store.load()->P_map_base->x_m == 7.0);
    store.save(map_of(2), std::nullopt);
    store.save(map_of(3), std::nullopt);
    CHECK(store.load()->map.cells == map_of(3).cells);
    CHECK_FALSE(store.load()->P_map_base);
    // Two are kept.
    CHECK_FALSE(std::filesystem::exists(directory / "map-1.pgm"));
    CHECK(std::filesystem::exists(directory / "map-2.pgm"));
}

TEST_CASE("map store: a damaged map is not used") {
    const Scratch scratch;
    MapStore store(scratch / "state");
    store.save(map_of(1), Pose2{});
    store.save(map_of(2), std::nullopt);
    spoil(scratch / "state/map-2.pgm");
    const auto saved = store.load();
    REQUIRE(saved);
    CHECK(saved->map.cells == map_of(1).cells);
    CHECK(saved->warning.find("map-2.pgm: is not what was saved") != std::string::npos);
    SECTION("nor one that is missing") {
        std::filesystem::remove(scratch / "state/map-1.yaml");
        CHECK_THROWS_AS(store.load(), InputError);
        CHECK_THROWS_WITH(store.load(), Catch::Contains("map-1.yaml") && Catch::Contains("state.json to begin a new"));
    }
}

TEST_CASE("map store: a state that cannot be read is told of, with the remedy") {
    const Scratch scratch;
    std::filesystem::create_directory(scratch / "state");
    for (const auto& [text, reason] :
         {std::pair{R"({"version": 2, "maps": []})", "is of version 2, not 1"},
          std::pair{R"({"version": 1, "maps": [{}]})", "is damaged"}, std::pair{R"({"version": 1, "ma)", "is damaged"},
          std::pair{"[]", "is damaged"}}) {
        static_cast<void>(scratch.file("state/state.json", text));
        CHECK_THROWS_WITH(MapStore(scratch / "state"),
                          Catch::Contains(reason) && Catch::Contains("remove it to begin a new map"));
    }
    CHECK_THROWS_AS(MapStore("/proc/nowhere"), InputError);
}

TEST_CASE("map store: killed while saving, 200 times, it always has a whole map") {
    const Scratch scratch;
    const std::filesystem::path directory = scratch / "state";
    MapStore(directory).save(map_of(0), Pose2{});
    int newest = 0;
    int saved_before_kills = 0;
    for (int round = 0; round < 200; ++round) {
        std::array<int, 2> begun{};  // the child says when it begins to save
        REQUIRE(::pipe(begun.data()) == 0);
        const UniqueFd hears(begun[0]);
        UniqueFd says(begun[1]);
        const pid_t child = fork();
        REQUIRE(child >= 0);
        if (child == 0) {
            MapStore store(directory);
            for (int number = newest + 1; ::write(says.get(), "b", 1) == 1; ++number) {
                static_cast<void>(store.save(map_of(number), Pose2{.x_m = static_cast<double>(number)}));
            }
            ::_exit(1);
        }
        says = UniqueFd();
        const int begins = 1 + round % 3;
        for (int i = 0; i < begins; ++i) {
            char letter = 0;
            REQUIRE(::read(hears.get(), &letter, 1) == 1);
        }
        saved_before_kills += begins - 1;
        std::this_thread::sleep_for(std::chrono::microseconds(20 * round));  // somewhere in the saving
        ::kill(child, SIGKILL);
        ::waitpid(child, nullptr, 0);
        const auto saved = MapStore(directory).load();
        REQUIRE(saved);
        REQUIRE(saved->warning.empty());
        REQUIRE(saved->P_map_base);
        const int number = static_cast<int>(saved->P_map_base->x_m);
        REQUIRE(number >= newest);
        REQUIRE(saved->map.cells == map_of(number).cells);
        newest = number;
    }
    CHECK(newest >= saved_before_kills);
}
