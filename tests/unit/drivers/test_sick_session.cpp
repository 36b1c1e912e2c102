#include <catch2/catch.hpp>
#include <memory>
#include <string>

#include "drivers/sick/sick_device.hpp"
#include "drivers/sick/sick_session.hpp"
#include "tests/unit/drivers/sick_examples.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

constexpr Duration kStep{5'000'000};

constexpr Stamp seconds(double s) {
    return Stamp{} + Duration::from_seconds(s);
}

// A session and a sensor on a cable that can be pulled. Time goes in steps of 5 ms.
struct Cable {
    explicit Cable(const SickParams& params, const SickDeviceParams& device_params = {})
        : session(std::make_unique<SickSession>(params)),
          device(std::make_unique<SickDevice>(device_params, Stamp{})),
          now(Stamp{}) {
        fill_tim(device->measurement());
        connect();
    }

    void connect() const {
        if (plugged) {
            device->on_connect();
            session->on_open(now);
        } else {
            session->on_closed(now);
        }
    }

    void run_until(double until_s) {
        while (now < seconds(until_s)) {
            now = now + kStep;
            session->on_time(now);
            for (;;) {
                const SickOutput output = session->next_output(now);
                if (output.kind == SickOutput::Kind::kNothing) {
                    break;
                }
                if (output.kind == SickOutput::Kind::kReopen) {
                    ++reopened;
                    connect();
                } else {
                    ++commands;
                    if (plugged) {
                        device->on_bytes(output.bytes, now);
                    }
                }
            }
            device->on_time(now);
            const Bytes bytes(device->output().begin(), device->output().end());
            device->clear_output();
            if (plugged && !muted) {
                session->on_bytes(bytes, now, [&](const LmdScandata& data, const SickTiming& timing) {
                    ++scans;
                    last = timing;
                    same = same && data.channel[0] == device->measurement().channel[0];
                });
            }
        }
    }

    std::unique_ptr<SickSession> session;
    std::unique_ptr<SickDevice> device;
    Stamp now;
    bool plugged = true;
    bool muted = false;
    bool same = true;
    int scans = 0;
    int reopened = 0;
    int commands = 0;
    SickTiming last;
};

SickParams configured() {
    SickParams params;
    params.scan = SickScanConfig{1500, 3333, -450000, 2250000};
    return params;
}

}  // namespace

TEST_CASE("sick session: from the first byte to scans, in the order of the manual") {
    Cable cable(configured());
    cable.run_until(2.0);
    CHECK(cable.session->state() == SickState::kStreaming);
    CHECK(cable.scans > 20);
    CHECK(cable.same);
    CHECK(cable.reopened == 0);
    CHECK(cable.commands == 7);
    CHECK(cable.device->scan_config() == *configured().scan);
    CHECK(cable.session->counters().refused == 0);
    CHECK(cable.session->counters().repeated == 0);
    CHECK(cable.session->listener().parser_counters().bytes_skipped == 0);
    CHECK(cable.device->output_dropped() == 0);
}

TEST_CASE("sick session: a sensor that speaks text is understood as it is") {
    SickDeviceParams device;
    device.dialect = ColaDialect::kAscii;
    Cable cable(configured(), device);
    cable.run_until(3.0);
    CHECK(cable.session->state() == SickState::kStreaming);
    CHECK(cable.session->dialect() == ColaDialect::kAscii);
    CHECK(cable.session->counters().repeated == 1);
    CHECK(cable.scans > 20);
}

TEST_CASE("sick session: the dialect is switched where it is asked for") {
    for (const ColaDialect found : {ColaDialect::kAscii, ColaDialect::kBinary}) {
        SickDeviceParams device;
        device.dialect = found;
        SickParams params;
        params.dialect = found == ColaDialect::kAscii ? SickDialect::kBinary : SickDialect::kAscii;
        Cable cable(params, device);
        cable.run_until(4.0);
        CHECK(cable.session->state() == SickState::kStreaming);
        CHECK(cable.session->dialect() != found);
        CHECK(cable.reopened == 1);
        CHECK(cable.scans > 20);
    }
}

TEST_CASE("sick session: 30 s of silence after power-on are waited for, without a reconnection") {
    SickDeviceParams device;
    device.silence = Duration::from_seconds(30.0);
    device.until_ready = Duration::from_seconds(40.0);
    Cable cable(configured(), device);
    cable.run_until(39.0);
    CHECK(cable.session->state() == SickState::kWaitReady);
    CHECK(cable.reopened == 0);
    cable.run_until(43.0);
    CHECK(cable.session->state() == SickState::kStreaming);
    CHECK(cable.scans > 20);
}

TEST_CASE("sick session: what answers nothing at all is reopened") {
    SickDeviceParams device;
    device.silence = Duration::from_seconds(100.0);
    Cable cable(configured(), device);
    cable.run_until(34.0);
    CHECK(cable.reopened == 0);
    cable.run_until(36.0);
    CHECK(cable.reopened == 1);
    cable.run_until(106.0);
    CHECK(cable.session->state() == SickState::kStreaming);
}

TEST_CASE("sick session: refused commands are told and do not end it") {
    SickDeviceParams tim;
    tim.knows_status = false;
    tim.knows_scan_config = false;
    Cable cable(configured(), tim);
    cable.run_until(2.0);
    CHECK(cable.session->state() == SickState::kStreaming);
    CHECK(cable.session->counters().refused == 2);
    CHECK(cable.session->last_refusal().command == SickCommand::kReadStatus);
    CHECK(cable.session->last_refusal().number == 3);
    CHECK(std::string(cable.session->last_refusal().text) == "variable: not known to this sensor");

    SickDeviceParams locked;
    locked.takes_password = false;
    Cable other(configured(), locked);
    other.run_until(2.0);
    CHECK(other.session->state() == SickState::kStreaming);
    CHECK(other.session->counters().refused == 4);
    CHECK(other.session->last_refusal().number == 1);
}

TEST_CASE("sick session: a pulled cable is noticed within 3 scans, tried without hurry, and comes back") {
    Cable cable(configured());
    cable.run_until(2.0);
    REQUIRE(cable.session->state() == SickState::kStreaming);
    cable.plugged = false;
    cable.run_until(2.0 + 4 * 0.0667 + 0.02);  // at most a scan was on its way
    CHECK(cable.session->state() == SickState::kClosed);
    CHECK(cable.session->counters().silences == 1);
    cable.run_until(62.0);
    CHECK(cable.reopened >= 10);
    CHECK(cable.reopened <= 20);  // 0.1 s, doubled up to 5 s
    cable.plugged = true;
    const int before = cable.scans;
    cable.run_until(69.0);
    CHECK(cable.session->state() == SickState::kStreaming);
    CHECK(cable.scans > before + 20);
    CHECK(cable.last.clock_epoch == 2);
    // The next time it begins with the short wait again.
    cable.plugged = false;
    const int reopened = cable.reopened;
    cable.run_until(70.0);
    CHECK(cable.reopened >= reopened + 2);
}

TEST_CASE("sick session: a stream that stops on a live connection is reopened") {
    Cable cable(configured());
    cable.run_until(2.0);
    cable.muted = true;
    cable.run_until(2.6);
    CHECK(cable.session->counters().silences == 1);
    cable.muted = false;
    const int before = cable.scans;
    cable.run_until(6.0);
    CHECK(cable.session->state() == SickState::kStreaming);
    CHECK(cable.scans > before + 10);
}

TEST_CASE("sick session: stop ends the stream") {
    Cable cable(configured());
    cable.run_until(2.0);
    REQUIRE(cable.device->streams());
    cable.session->stop();
    cable.run_until(2.1);
    CHECK_FALSE(cable.device->streams());
    const int commands = cable.commands;
    cable.run_until(60.0);
    CHECK(cable.commands == commands);
    CHECK(cable.reopened == 0);
}

TEST_CASE("sick session: the unwrapped clock follows the sensor's across the wrap") {
    SickDeviceParams device;
    device.clock_start_us = 0xFFFFFFFF - 3'000'000;
    Cable cable(configured(), device);
    cable.run_until(5.0);
    CHECK(cable.last.clock_epoch == 1);
    // The scan began one period before it was sent.
    const double ago_us = static_cast<double>(device.clock_start_us) + 5.0e6 - static_cast<double>(cable.last.start_us);
    CHECK(ago_us > 66000.0);
    CHECK(ago_us < 2.2 * 66667.0);
    CHECK(cable.last.start_us > 0xFFFFFFFFULL);
}

TEST_CASE("sick session: bytes before anything is open do no harm") {
    SickSession session(configured());
    const Bytes bytes = ascii("\x02sSN LMDscandata 1\x03");
    int scans = 0;
    session.on_bytes(bytes, Stamp{}, [&](const LmdScandata&, const SickTiming&) { ++scans; });
    session.on_time(seconds(100.0));
    CHECK(scans == 0);
    CHECK(session.listener().undecodable() == 1);
    CHECK(session.next_output(seconds(100.0)).kind == SickOutput::Kind::kNothing);
}
