// The service begun anew within its process.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <string>

#include "platform/crspfd/service_host.hpp"
#include "platform/files/input_error.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "tests/support/live_robot.hpp"
#include "tests/unit/platform/scratch.hpp"

using namespace crspf;
using crspf::test::Scratch;

namespace {

/// Hears nothing, in time.
class Quiet final : public LiveSource {
 public:
    void step(Duration wait, SampleSink& /*samples*/, TrafficSink& /*traffic*/) override {
        sleep_until(monotonic_now() + wait);
    }
    [[nodiscard]] LiveReport report() const override { return {}; }
};

ServiceOptions quiet() {
    ServiceOptions options;
    options.allow_degraded = true;
    options.open_source = [](const SourceConfig&, const LidarParams&) { return std::make_unique<Quiet>(); };
    return options;
}

std::string config_of(const Scratch& scratch, const std::string& more = {}) {
    return "[service]\nstate_directory = \"" + (scratch / "state").string() + "\"\n" + more +
           crspf::test::live_robot_toml("/dev/nowhere", "can0");
}

/// A map with `cells` occupied ones in a row.
GridMap row_map(int cells) {
    GridMap map;
    map.width = cells;
    map.height = 1;
    map.resolution_m = 0.02;
    map.cells.assign(static_cast<std::size_t>(cells), GridCell::kOccupied);
    return map;
}

int known_cells(const std::filesystem::path& yaml) {
    const GridMap map = read_grid_map(yaml);
    return static_cast<int>(
        std::count_if(map.cells.begin(), map.cells.end(), [](GridCell cell) { return cell != GridCell::kUnknown; }));
}

class Hosted {
 public:
    Hosted() : host(scratch.file("robot.toml", config_of(scratch)), quiet()) { host.start(); }

    [[nodiscard]] std::filesystem::path write_map(const char* name, int cells) const {
        write_grid_map(row_map(cells), scratch / name);
        return scratch / (std::string(name) + ".yaml");
    }

    Scratch scratch;
    ServiceHost host;
};

}  // namespace

TEST_CASE("host: another map is loaded, and an empty one begun") {
    Hosted h;
    h.host.load_map(h.write_map("office", 100));
    CHECK(h.host.alive());
    CHECK(known_cells(h.host.service().save_map()) == 100);
    // Where the robot is on it nobody knows.
    CHECK_FALSE(MapStore(h.scratch / "state").load()->P_map_base);

    h.host.reset();
    CHECK(h.host.alive());
    CHECK(known_cells(h.host.service().save_map()) == 0);
    h.host.stop();
}

TEST_CASE("host: what cannot be used leaves the service as it was") {
    Hosted h;
    h.host.load_map(h.write_map("office", 100));
    CHECK_THROWS_WITH(h.host.load_map(h.scratch / "nowhere.yaml"), Catch::Contains("nowhere.yaml"));
    GridMap unknown = row_map(3);
    unknown.cells.assign(3, GridCell::kUnknown);
    write_grid_map(unknown, h.scratch / "unknown");
    CHECK_THROWS_WITH(h.host.load_map(h.scratch / "unknown.yaml"), Catch::Contains("nothing in it is known"));
    GridMap far = row_map(3);
    far.P_map_origin.x_m = 1e6;
    write_grid_map(far, h.scratch / "far");
    CHECK_THROWS_WITH(h.host.load_map(h.scratch / "far.yaml"), Catch::Contains("from the origin"));

    static_cast<void>(h.scratch.file("robot.toml", config_of(h.scratch, "save_every_s = \"soon\"\n")));
    CHECK_THROWS_WITH(h.host.reload(), Catch::Contains("save_every_s"));
    static_cast<void>(h.scratch.file("robot.toml", config_of(h.scratch, "control_socket = \"/tmp/other\"\n")));
    CHECK_THROWS_WITH(h.host.reload(), Catch::Contains("restart the service"));
    // Only the new service itself finds that it has no map to localise on: the old one comes back.
    static_cast<void>(h.scratch.file("robot.toml", "[service]\nlocalize_only = true\nstate_directory = \"" +
                                                       (h.scratch / "empty").string() + "\"\n" +
                                                       crspf::test::live_robot_toml("/dev/nowhere", "can0")));
    CHECK_THROWS_WITH(h.host.reload(),
                      Catch::Contains("no map is saved there") && Catch::Contains("the service goes on as it was"));
    CHECK(h.host.alive());
    // And only its start, that a thread cannot be had.
    static_cast<void>(h.scratch.file("robot.toml", config_of(h.scratch, "[threads]\nfilter_cpus = [1023]\n")));
    CHECK_THROWS_WITH(h.host.reload(),
                      Catch::Contains("thread filter") && Catch::Contains("the service goes on as it was"));
    CHECK(h.host.alive());
    CHECK(known_cells(h.host.service().save_map()) == 100);
    h.host.stop();
}

TEST_CASE("host: the configuration is read again, and the map stays") {
    Hosted h;
    h.host.load_map(h.write_map("office", 100));
    static_cast<void>(h.scratch.file("robot.toml", config_of(h.scratch, "localize_only = true\n")));
    h.host.reload();
    CHECK(h.host.alive());
    CHECK(h.host.config().service.localize_only);
    CHECK(known_cells(h.host.service().save_map()) == 100);
    CHECK_THROWS_WITH(h.host.reset(), Catch::Contains("localize_only"));
    h.host.stop();
}

TEST_CASE("host: a run is recorded from the command on, and then not") {
    Hosted h;
    CHECK_THROWS_WITH(h.host.stop_recording(), Catch::Contains("nothing is being recorded"));
    for (int i = 0; i < 2; ++i) {
        const std::filesystem::path directory = h.host.start_recording();
        CHECK(std::filesystem::is_directory(directory));
        CHECK_THROWS_WITH(h.host.start_recording(), Catch::Contains("already"));
        CHECK(h.host.service().status().contains("recording"));
        h.host.stop_recording();
        CHECK_FALSE(h.host.service().status().contains("recording"));
    }
    h.host.stop();
}
