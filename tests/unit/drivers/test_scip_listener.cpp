#include <catch2/catch.hpp>
#include <memory>

#include "tests/unit/drivers/scip_bench.hpp"

using namespace crspf;
using crspf::test::ScipBench;
using crspf::test::ScipTape;
using crspf::test::urg_04lx;

namespace {

std::vector<std::int64_t> stamps_heard(const std::vector<ScipTape>& tape) {
    const auto listener = std::make_unique<ScipListener>();
    std::vector<std::int64_t> stamps;
    for (const ScipTape& t : tape) {
        switch (t.event) {
            case ScipTape::Event::kOpened: listener->on_open(); break;
            case ScipTape::Event::kSent: listener->on_sent(t.stamp); break;
            case ScipTape::Event::kReceived:
                listener->on_bytes(t.bytes, t.stamp, [&](const ScipReply&, const Scan* scan) {
                    if (scan != nullptr) {
                        stamps.push_back(scan->stamp.ns);
                    }
                });
                break;
        }
    }
    return stamps;
}

}  // namespace

TEST_CASE("scip listener: a recording gives the session's scans, to the bit of their stamps") {
    for (const std::uint32_t baud : {0U, 115'200U}) {
        CAPTURE(baud);
        ScipParams params;
        params.baud = baud;
        const auto b = std::make_unique<ScipBench>(ScipDeviceParams{urg_04lx(), true, 19'200}, params);
        b->taping = true;
        b->drift = 0.001;
        b->jitter_s = 0.002;
        std::vector<std::int64_t> live;
        const auto run = [&](double seconds) {
            b->run(seconds, [&](const Scan& scan) { live.push_back(scan.stamp.ns); });
        };
        run(3.0);
        b->plugged = false;
        run(1.0);
        b->plugged = true;
        b->device.power_on(b->device_time(b->now));
        run(3.0);
        b->mute = true;  // the session gives up and comes back
        run(1.5);
        b->mute = false;
        run(3.0);
        b->device.switch_laser_off();
        run(3.0);
        REQUIRE(live.size() > 60);
        CHECK(b->openings > 2);
        CHECK(stamps_heard(b->tape) == live);

        // The comparison sees what the sending instants are worth.
        std::vector<ScipTape> later = b->tape;
        for (ScipTape& t : later) {
            t.stamp.ns += t.event == ScipTape::Event::kSent ? 100'000 : 0;
        }
        CHECK(stamps_heard(later) != live);
    }
}

TEST_CASE("scip listener: a recording that begins among the scans has none until the sensor told its geometry") {
    const auto b = std::make_unique<ScipBench>(ScipDeviceParams{urg_04lx(), false, 19'200}, ScipParams{});
    b->taping = true;
    b->run(3.0);
    std::vector<ScipTape> rest(b->tape.end() - 5, b->tape.end());
    CHECK(stamps_heard(rest).empty());

    // With the reply to PP the requests in the echoes say the rest.
    const auto is_pp = [](const ScipTape& t) {
        return t.event == ScipTape::Event::kReceived && t.bytes.size() > 2 && t.bytes[0] == 'P' && t.bytes[1] == 'P';
    };
    rest.insert(rest.begin(), *std::find_if(b->tape.begin(), b->tape.end(), is_pp));
    CHECK(stamps_heard(rest).size() == 5);
}
