#include "platform/capture/recorder.hpp"

#include <sys/resource.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <optional>

#include "platform/files/input_error.hpp"
#include "tests/unit/platform/captures.hpp"
#include "tests/unit/platform/scratch.hpp"

using Catch::Matchers::Contains;
using crspf::CaptureSource;
using crspf::Direction;
using crspf::Duration;
using crspf::LinkKind;
using crspf::Recorder;
using crspf::RecorderParams;
using crspf::Stamp;
using crspf::test::Bytes;
using crspf::test::read_capture;
using crspf::test::ReadCapture;
using crspf::test::Scratch;

namespace {

const std::vector<CaptureSource> kSources{{"lidar", "", LinkKind::kStream}, {"can0", "", LinkKind::kCan}};
constexpr Stamp kStart{50'000'000'000};
constexpr Duration kMillisecond{1'000'000};

RecorderParams params_for(const Scratch& scratch) {
    RecorderParams params;
    params.directory = scratch.directory();
    params.free_bytes_min = 0;
    params.utc_minus_stamp = {1'700'000'000'000'000'000 - kStart.ns};
    return params;
}

Stamp after_ms(int ms) {
    return kStart + Duration{ms * kMillisecond.ns};
}

Bytes payload(int i) {
    Bytes bytes(1000, static_cast<std::uint8_t>(i));
    return bytes;
}

/// How many records the files of the directory hold, all of which have to be whole.
std::size_t records_in(const Scratch& scratch) {
    std::size_t records = 0;
    for (const std::string& name : scratch.names()) {
        const ReadCapture read = read_capture(scratch / name);
        CHECK_FALSE(read.counts.cut_short);
        CHECK(read.comment == "settings");
        CHECK(read.sources == kSources);
        records += read.records.size();
    }
    return records;
}

}  // namespace

TEST_CASE("recorder: what was appended is read back") {
    const Scratch scratch;
    {
        Recorder recorder(params_for(scratch), kSources, "settings");
        CHECK(recorder.file().empty());  // a file begins with its first record
        CHECK(recorder.append(0, Direction::kReceived, after_ms(0), payload(1)));
        CHECK(recorder.append(1, Direction::kSent, after_ms(1), payload(2)));
        CHECK(recorder.file().filename() == "crspf-20231114T221320Z.pcapng");
        CHECK(recorder.flush());
        CHECK(records_in(scratch) == 2);
        CHECK(recorder.append(0, Direction::kReceived, after_ms(2), payload(3)));
        CHECK(recorder.counters().written == 2);
    }
    const ReadCapture read = read_capture(scratch / "crspf-20231114T221320Z.pcapng");
    CHECK(read.comment == "settings");
    CHECK(read.sources == kSources);
    REQUIRE(read.records.size() == 3);
    CHECK(read.records[1].record.direction == Direction::kSent);
    CHECK(read.records[1].record.source == 1);
    CHECK(read.records[1].record.stamp.ns == 1'700'000'000'001'000'000);
    CHECK(read.records[2].bytes == std::string(1000, '\3'));
}

TEST_CASE("recorder: a second of records is all that waits in the buffer") {
    const Scratch scratch;
    Recorder recorder(params_for(scratch), kSources, "settings");
    CHECK(recorder.append(0, Direction::kReceived, after_ms(0), payload(1)));
    CHECK(recorder.append(0, Direction::kReceived, after_ms(999), payload(2)));
    CHECK(recorder.counters().written == 0);
    CHECK(recorder.append(0, Direction::kReceived, after_ms(1000), payload(3)));
    CHECK(recorder.counters().written == 3);
    CHECK(records_in(scratch) == 3);
}

TEST_CASE("recorder: files end at their size and at their time, and no record is lost between them") {
    const Scratch by_size;
    {
        RecorderParams params = params_for(by_size);
        params.file_bytes_max = 10'500;
        Recorder recorder(params, kSources, "settings");
        for (int i = 0; i < 100; ++i) {
            CHECK(recorder.append(0, Direction::kReceived, after_ms(i), payload(i)));
        }
        CHECK(recorder.counters().files == 12);  // nine records of 1048 bytes, and the head
    }
    CHECK(by_size.names().size() == 12);
    CHECK(records_in(by_size) == 100);
    for (const std::string& name : by_size.names()) {
        CHECK(std::filesystem::file_size(by_size / name) <= 10'500);
    }
    const Scratch by_time;
    {
        RecorderParams params = params_for(by_time);
        params.file_time_max = {10'000'000'000};
        Recorder recorder(params, kSources, "settings");
        for (int i = 0; i < 100; ++i) {
            CHECK(recorder.append(0, Direction::kReceived, after_ms(i * 500), payload(i)));
        }
    }
    CHECK(by_time.names() == std::vector<std::string>{"crspf-20231114T221320Z.pcapng", "crspf-20231114T221330Z.pcapng",
                                                      "crspf-20231114T221340Z.pcapng", "crspf-20231114T221350Z.pcapng",
                                                      "crspf-20231114T221400Z.pcapng"});
    CHECK(records_in(by_time) == 100);
}

TEST_CASE("recorder: it stops before the disk is full, and goes on when there is room") {
    const Scratch scratch;
    RecorderParams params = params_for(scratch);
    params.free_bytes_min = 100U << 20U;
    std::uint64_t free_bytes = 101U << 20U;
    std::optional<Recorder> recorder(std::in_place, params, kSources, "settings",
                                     [&](const std::filesystem::path&) { return free_bytes; });
    CHECK(recorder->append(0, Direction::kReceived, after_ms(0), payload(0)));
    CHECK(recorder->flush());
    free_bytes = 99U << 20U;
    CHECK(recorder->append(0, Direction::kReceived, after_ms(1), payload(1)));
    CHECK_FALSE(recorder->flush());
    CHECK_THAT(recorder->problem(),
               Contains(scratch.directory().string() + ": 99 MiB free") && Contains("; free some"));
    CHECK_FALSE(recorder->append(0, Direction::kReceived, after_ms(2), payload(2)));
    CHECK_FALSE(recorder->append(0, Direction::kReceived, after_ms(1500), payload(2)));
    CHECK(recorder->counters().lost == 2);
    free_bytes = 101U << 20U;
    CHECK_FALSE(recorder->append(0, Direction::kReceived, after_ms(1600), payload(3)));  // not asked at each record
    CHECK(recorder->append(0, Direction::kReceived, after_ms(2600), payload(3)));
    CHECK(recorder->problem().empty());
    CHECK(recorder->counters().lost == 3);
    recorder.reset();
    CHECK(records_in(scratch) == 3);
}

TEST_CASE("recorder: a write that fails half-way leaves whole records, is named, and is not the end") {
    const Scratch scratch;
    Recorder recorder(params_for(scratch), kSources, "settings");
    struct rlimit before {};
    REQUIRE(::getrlimit(RLIMIT_FSIZE, &before) == 0);
    auto* const handler = std::signal(SIGXFSZ, SIG_IGN);
    struct rlimit limit = before;
    limit.rlim_cur = 100'001;
    REQUIRE(::setrlimit(RLIMIT_FSIZE, &limit) == 0);
    int i = 0;
    while (i < 1000 && recorder.append(0, Direction::kReceived, after_ms(0), payload(i))) {
        ++i;
    }
    REQUIRE(::setrlimit(RLIMIT_FSIZE, &before) == 0);
    std::signal(SIGXFSZ, handler);
    REQUIRE(i < 1000);
    CHECK_THAT(recorder.problem(), Contains("crspf-20231114T221320Z.pcapng: cannot be written: File too large; "));
    const auto counters = recorder.counters();
    CHECK(counters.written > 0);
    CHECK(counters.lost > 0);
    CHECK(counters.written + counters.lost == static_cast<std::uint64_t>(i) + 1);
    CHECK(records_in(scratch) == counters.written);
    CHECK(recorder.append(0, Direction::kReceived, after_ms(1000), payload(0)));
    CHECK(recorder.flush());
    CHECK(records_in(scratch) == counters.written + 1);
}

TEST_CASE("recorder: records that no file can hold are refused and counted") {
    const Scratch scratch;
    Recorder recorder(params_for(scratch), kSources, "settings");
    CHECK_FALSE(recorder.append(2, Direction::kReceived, after_ms(0), payload(0)));
    CHECK_FALSE(recorder.append(0, Direction::kReceived, {std::int64_t{-1'700'000'000'000'000'000}}, payload(0)));
    CHECK_FALSE(recorder.append(0, Direction::kReceived, after_ms(0), Bytes(crspf::CaptureRecord::kBytesMax + 1)));
    CHECK(recorder.counters().refused == 3);
    CHECK(recorder.append(0, Direction::kReceived, after_ms(0), Bytes(crspf::CaptureRecord::kBytesMax)));
}

TEST_CASE("recorder: where recording is impossible, it says so at the start") {
    const Scratch scratch;
    const auto start = [](const RecorderParams& params, const std::vector<CaptureSource>& sources,
                          const std::string& comment) { const Recorder recorder(params, sources, comment); };
    RecorderParams params = params_for(scratch);
    CHECK_NOTHROW(start(params, kSources, ""));
    CHECK_THROWS_WITH(start(params, kSources, std::string(65536, 'x')), Contains("shorten the configuration"));
    CHECK_THROWS_WITH(start(params, {{"odd", "", LinkKind::kOther}}, ""), Contains("source odd cannot be recorded"));
    params.free_bytes_min = ~std::uint64_t{0};
    CHECK_THROWS_WITH(start(params, kSources, ""), Contains(" free, of which ") && Contains("record elsewhere"));
    params.directory = scratch / "none";
    CHECK_THROWS_WITH(start(params, kSources, ""), Contains("none: cannot be recorded into: No such file"));
}
