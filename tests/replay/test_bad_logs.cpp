// What no log should be: told or counted, and the poses stay numbers.
#include <catch2/catch.hpp>
#include <cstdint>
#include <string>

#include "core/base/rng.hpp"
#include "platform/files/input_error.hpp"
#include "tests/replay/replay.hpp"
#include "tests/replay/simulated_log.hpp"
#include "tests/unit/platform/scratch.hpp"

using Catch::Matchers::Contains;
using crspf::test::compressed;
using crspf::test::LogFormat;
using crspf::test::Replay;
using crspf::test::Scratch;

namespace {

/// 30 lines of a standing robot in a round room, each with `beams` beams that read `range`.
class StandingRobot {
 public:
    StandingRobot& scans(int count, int beams, const std::string& range) {
        for (int i = 0; i < count; ++i) {
            log_ += "FLASER " + std::to_string(beams);
            for (int beam = 0; beam < beams; ++beam) {
                log_ += " " + range;
            }
            const std::string pose = std::to_string(x_m_) + " 0 0 ";
            const std::string stamp = std::to_string(stamp_s_);
            log_.append(" ").append(pose).append(pose).append(stamp).append(" host ").append(stamp).append("\n");
            stamp_s_ += 0.1;
            x_m_ += step_m_;
        }
        return *this;
    }
    StandingRobot& jump_in_time(double seconds) {
        stamp_s_ += seconds;
        return *this;
    }
    StandingRobot& drive(double step_m) {
        step_m_ = step_m;
        return *this;
    }
    StandingRobot& text(const std::string& text) {
        log_ += text;
        return *this;
    }
    [[nodiscard]] Replay replay() const {
        const Scratch scratch;
        return crspf::test::replay(scratch.file("log.clf", log_), {});
    }

 private:
    std::string log_;
    double stamp_s_ = 1000.0;
    double x_m_ = 0.0;
    double step_m_ = 0.0;
};

std::string noise(std::size_t bytes) {
    crspf::Rng rng(7);
    std::string text;
    while (text.size() < bytes) {
        text += static_cast<char>(rng.next() & 0xFFU);
    }
    return text;
}

}  // namespace

TEST_CASE("bad logs: what is no log is named", "[replay]") {
    const Scratch scratch;
    CHECK_THROWS_WITH(crspf::test::replay(scratch.file("empty", ""), {}), Contains("empty"));
    CHECK_THROWS_AS(crspf::test::replay(scratch.file("noise", noise(100000)), {}), crspf::InputError);
    CHECK_THROWS_AS(crspf::test::replay(scratch / "absent", {}), crspf::InputError);
    CHECK_THROWS_AS(crspf::test::replay(scratch.directory(), {}), crspf::InputError);
}

TEST_CASE("bad logs: cut off anywhere, the poses up to there are the same", "[replay]") {
    const Scratch scratch;
    const auto run = crspf::test::simulate_office(LogFormat::kCarmen, 5.0);
    const Replay whole = crspf::test::replay(scratch.file("whole", run.log), run.config);
    REQUIRE(whole.trajectory.size() > 40);
    for (const std::size_t of_ten : {3U, 5U, 8U}) {
        const std::string half = run.log.substr(0, run.log.size() * of_ten / 10);
        const Replay replay = crspf::test::replay(scratch.file("half", half), run.config);
        CHECK(replay.finite);
        REQUIRE(replay.trajectory.size() + 1 >= whole.trajectory.size() * of_ten / 10 - 5);
        REQUIRE(replay.trajectory.size() < whole.trajectory.size());
        for (std::size_t i = 0; i < replay.trajectory.size(); ++i) {
            REQUIRE(replay.trajectory[i].P_map_base == whole.trajectory[i].P_map_base);
        }
    }
}

TEST_CASE("bad logs: a compressed log that is cut off or damaged ends with an error", "[replay]") {
    const Scratch scratch;
    const auto run = crspf::test::simulate_office(LogFormat::kUrgDat, 5.0);
    for (const char* const filter : {"xz", "gzip"}) {
        const std::string packed = compressed(run.log, filter);
        const std::string cut = packed.substr(0, packed.size() / 2);
        const Replay replay = crspf::test::replay(scratch.file("cut", cut), run.config);
        CHECK_THAT(replay.error, Contains("cut"));
        CHECK(replay.finite);
    }
}

TEST_CASE("bad logs: noise between the lines is counted and harms nothing", "[replay]") {
    const Replay clean = StandingRobot().scans(40, 180, "2.0").replay();
    const Replay noisy = StandingRobot().scans(20, 180, "2.0").text(noise(20000) + "\n").scans(20, 180, "2.0").replay();
    CHECK(noisy.log.damaged_lines + noisy.log.ignored_lines > 0);
    CHECK(noisy.digest == clean.digest);
}

TEST_CASE("bad logs: ranges that are no numbers are invalid beams, and the odometry stands", "[replay]") {
    for (const char* const range : {"nan", "-nan", "-1.0", "0", "-inf"}) {
        INFO(range);
        const Replay replay = StandingRobot().scans(5, 180, range).replay();
        CHECK(replay.trajectory.size() + replay.log.damaged_lines == 5);
        CHECK(replay.pipeline.too_few_rays == replay.trajectory.size());
        CHECK(replay.log.invalid_beams == 180 * replay.trajectory.size());
        CHECK(replay.finite);
    }
}

TEST_CASE("bad logs: lines without beams are damage", "[replay]") {
    const Replay replay = StandingRobot().scans(3, 180, "2.0").scans(4, 0, "").scans(3, 180, "2.0").replay();
    CHECK(replay.log.damaged_lines == 4);
    CHECK(replay.pipeline.scans == 6);
    CHECK(replay.finite);
}

TEST_CASE("bad logs: the number of beams may change", "[replay]") {
    StandingRobot robot;
    for (const int beams : {180, 1, 360, 2, 181, 2048}) {
        robot.scans(5, beams, "2.0");
    }
    const Replay replay = robot.replay();
    CHECK(replay.pipeline.scans == 30);
    CHECK(replay.finite);
    const Replay too_many = StandingRobot().scans(2, 180, "2.0").scans(1, 2049, "2.0").replay();
    CHECK(too_many.log.damaged_lines == 1);
    CHECK(too_many.pipeline.scans == 2);
}

TEST_CASE("bad logs: stamps that jump are counted", "[replay]") {
    const Replay replay = StandingRobot()
                              .scans(10, 180, "2.0")
                              .jump_in_time(-500.0)
                              .scans(10, 180, "2.0")
                              .jump_in_time(1e6)
                              .scans(10, 180, "2.0")
                              .replay();
    CHECK(replay.log.stamp_jumps == 2);
    CHECK(replay.pipeline.scans == 30);
    CHECK(replay.finite);
}

TEST_CASE("bad logs: a robot that leaves the map's extent goes on by its odometry", "[replay]") {
    const Replay replay = StandingRobot().drive(9.0).scans(300, 180, "2.0").replay();
    CHECK(replay.pipeline.scans == 300);
    CHECK(replay.pipeline.outside_map > 0);
    CHECK(replay.finite);
    CHECK(replay.trajectory.back().P_map_base.x_m > 1000.0);
}
