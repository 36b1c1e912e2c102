// The conversations, each against its simulated sensor: scans come, none of it touches the heap, and whoever only
// listens to the same bytes gets the same scans.
#include <array>
#include <catch2/catch.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "drivers/scip/scip_device.hpp"
#include "drivers/sick/lms2xx_device.hpp"
#include "drivers/sick/sick_device.hpp"
#include "platform/service/stream_talk.hpp"
#include "tests/support/heap_guard.hpp"
#include "tests/unit/drivers/ld06_bench.hpp"
#include "tests/unit/drivers/scip_bench.hpp"
#include "tests/unit/drivers/sick_examples.hpp"

using namespace crspf;
using crspf::test::HeapGuard;

namespace {

/// A sensor: takes what is sent to it, and gives what it has to say by then.
struct Sensor {
    std::function<void(std::span<const std::uint8_t>, Stamp)> hear;
    std::function<void(Stamp, std::vector<std::uint8_t>&)> speak;
};

Sensor urg() {
    struct State {
        ScipDevice device{{crspf::test::urg_04lx(), true, 19'200}};
        std::array<std::uint8_t, 16384> bytes{};
        ByteWriter out{bytes};
        std::vector<std::uint32_t> ranges = std::vector<std::uint32_t>(726, 1234);
        std::int64_t turn = 0;
    };
    const auto s = std::make_shared<State>();
    return {[s](auto bytes, Stamp now) { s->device.on_bytes(bytes, now, s->out); },
            [s](Stamp now, std::vector<std::uint8_t>& said) {
                const std::int64_t turn = now.ns / 100'000'000;
                if (turn != std::exchange(s->turn, turn)) {
                    s->device.on_revolution({(turn - 1) * 100'000'000}, s->ranges, {}, s->out);
                }
                said.assign(s->out.written().begin(), s->out.written().end());
                s->out = ByteWriter(s->bytes);
            }};
}

Sensor lms1xx() {
    const auto device = std::make_shared<SickDevice>(SickDeviceParams{}, Stamp{});
    crspf::test::fill_tim(device->measurement());
    device->on_connect();
    return {[device](auto bytes, Stamp now) { device->on_bytes(bytes, now); },
            [device](Stamp now, std::vector<std::uint8_t>& said) {
                device->on_time(now);
                said.assign(device->output().begin(), device->output().end());
                device->clear_output();
            }};
}

Sensor lms200() {
    const auto device = std::make_shared<Lms2xxDevice>(38400);
    device->measurement().values.fill(500);
    return {[device](auto bytes, Stamp now) { device->on_bytes(bytes, now); },
            [device](Stamp now, std::vector<std::uint8_t>& said) {
                device->on_time(now);
                said.assign(device->output().begin(), device->output().end());
                device->clear_output();
            }};
}

Sensor ld06() {
    const auto next = std::make_shared<std::uint64_t>(0);
    return {[](auto /*bytes*/, Stamp /*now*/) {},
            [next](Stamp now, std::vector<std::uint8_t>& said) {
                said.clear();
                for (; crspf::test::ld06_sent(*next) <= now; ++*next) {
                    const auto bytes = crspf::test::ld06_bytes(crspf::test::ld06_packet(*next));
                    said.insert(said.end(), bytes.begin(), bytes.end());
                }
            }};
}

/// Stamps and first ranges of the scans, in memory that is there already.
class Scans final : public SampleSink {
 public:
    Scans() { stamps.reserve(10'000); }
    void on_scan(const Scan& scan) override {
        stamps.push_back(scan.stamp.ns);
        if (leak) {
            planted = std::make_unique<int>(1);
        }
    }
    void on_cloud(const Cloud& /*cloud*/) override {}
    void on_wheel(const DifferentialSample& /*sample*/) override {}
    void on_wheel(const AckermannSample& /*sample*/) override {}
    void on_imu(const ImuSample& /*sample*/) override {}
    void on_motion(const MotionSample& /*sample*/) override {}

    std::vector<std::int64_t> stamps;
    bool leak = false;
    std::unique_ptr<int> planted;  ///< the fault to be found
};

struct Outcome {
    std::size_t scans = 0;
    std::uint64_t heap_calls = 0;
    bool listening_is_the_same = false;
};

Outcome talk(const SourceConfig& source, const Sensor& sensor, bool leak = false) {
    const auto talking = talk_to(source, {});
    const auto listening = listen_to(source, {});
    Scans live;
    Scans heard;
    live.leak = leak;
    std::vector<std::uint8_t> said;
    said.reserve(65536);
    Stamp now{1'000'000'000};
    talking->on_open(now);
    listening->on_open(now);
    const HeapGuard guard;
    for (int i = 0; i < 2000; ++i) {
        now = now + Duration{5'000'000};
        talking->on_time(now);
        for (StreamWish wish = talking->next_wish(now); wish.kind != StreamWish::Kind::kNothing;
             wish = talking->next_wish(now)) {
            if (wish.kind == StreamWish::Kind::kSend) {
                sensor.hear(wish.bytes, now);
                talking->on_sent(now);
                listening->on_sent(now);
            }
        }
        sensor.speak(now, said);
        if (!said.empty()) {
            talking->on_received(said, now, live);
            listening->on_received(said, now, heard);
        }
    }
    const std::uint64_t calls = guard.calls();
    CHECK(talking->streaming());
    CHECK(talking->trouble().empty());
    return {.scans = live.stamps.size(), .heap_calls = calls, .listening_is_the_same = live.stamps == heard.stamps};
}

SourceConfig source_of(const std::string& text) {
    return parse_config("[source.a]\n" + text, "c").sources.at(0);
}

void check(const SourceConfig& source, const std::function<Sensor()>& make, std::size_t scans_least) {
    const Outcome outcome = talk(source, make());
    CHECK(outcome.scans >= scans_least);
    CHECK(outcome.listening_is_the_same);
    CHECK(outcome.heap_calls == 0);
    if (HeapGuard::available()) {
        CHECK(talk(source, make(), true).heap_calls >= scans_least);
    } else {
        WARN("skipped: a sanitizer owns malloc, so heap calls are not seen here");
    }
}

}  // namespace

TEST_CASE("talk: a Hokuyo") {
    check(source_of("driver = \"scip\"\nport = \"/dev/a\""), urg, 80);
}

TEST_CASE("talk: a SICK on TCP") {
    check(source_of("driver = \"sick\"\nport = \"tcp://1.2.3.4:2112\""), lms1xx, 100);
}

TEST_CASE("talk: an LMS2xx on a serial line") {
    check(source_of("driver = \"lms2xx\"\nport = \"/dev/a\"\nbaud = 38400"), lms200, 40);
}

TEST_CASE("talk: an LD06, which does not listen") {
    check(source_of("driver = \"ld06\"\nport = \"/dev/a\""), ld06, 90);
    const auto talk = talk_to(source_of("driver = \"ld06\"\nport = \"/dev/a\""), {});
    talk->on_open(Stamp{});
    CHECK_FALSE(talk->streaming());  // nothing has come
}
