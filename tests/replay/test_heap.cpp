// No call of the core goes to the heap, over whole drives.
#include <catch2/catch.hpp>
#include <cstdlib>

#include "config/config.hpp"
#include "tests/replay/replay.hpp"
#include "tests/replay/simulated_log.hpp"
#include "tests/support/heap_guard.hpp"
#include "tests/unit/eval/recordings.hpp"
#include "tests/unit/platform/scratch.hpp"

using crspf::test::HeapGuard;
using crspf::test::LogFormat;
using crspf::test::Replay;
using crspf::test::Scratch;

namespace {

constexpr double kDrive_s = 60.0;

bool guard_missing() {
    if (HeapGuard::available()) {
        return false;
    }
    WARN("skipped: a sanitizer owns malloc in this build, heap calls cannot be counted");
    return true;
}

}  // namespace

TEST_CASE("heap: none in the core over a simulated drive", "[replay]") {
    if (guard_missing()) {
        return;
    }
    const LogFormat format = GENERATE(LogFormat::kCarmen, LogFormat::kUrgDat);  // on_motion() and on_wheel()
    const Scratch scratch;
    const auto run = crspf::test::simulate_office(format, kDrive_s);
    const Replay replay = crspf::test::replay(scratch.file("log", run.log), run.config);
    CHECK(replay.heap_calls == 0);
    CHECK(replay.pipeline.to_draw > 100);
    CHECK(replay.core_calls > replay.pipeline.scans);
}

TEST_CASE("heap: none in the core over the intel recording", "[replay]") {
    const auto file = crspf::test::recording("carmen/intel.clf.xz");
    CRSPF_NEED_RECORDING(file);
    if (guard_missing()) {
        return;
    }
    const Replay replay = crspf::test::replay(file, crspf::load_config(CRSPF_SOURCE_DIR "/config/examples/intel.toml"));
    CHECK(replay.heap_calls == 0);
    CHECK(replay.pipeline.scans == 13631);
}

TEST_CASE("heap: control, one planted allocation is counted", "[replay]") {
    if (guard_missing()) {
        return;
    }
    const Scratch scratch;
    const auto run = crspf::test::simulate_office(LogFormat::kCarmen, 2.0);
    bool planted = false;
    const auto plant_once = [&planted] {
        if (!planted) {
            planted = true;
            // NOLINTBEGIN(cppcoreguidelines-no-malloc,cppcoreguidelines-owning-memory): the call is the point
            void* block = std::malloc(1);
            asm volatile("" : : "g"(&block) : "memory");  // or the compiler would drop both calls
            std::free(block);
            // NOLINTEND(cppcoreguidelines-no-malloc,cppcoreguidelines-owning-memory)
        }
    };
    const Replay replay = crspf::test::replay(scratch.file("log", run.log), run.config, {.beside_scan = plant_once});
    CHECK(replay.heap_calls == 2);
}
