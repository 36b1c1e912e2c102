#include <catch2/catch.hpp>
#include <memory>

#include "drivers/sick/lms2xx_device.hpp"
#include "drivers/sick/lms2xx_session.hpp"
#include "tests/unit/drivers/sick_examples.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

constexpr Stamp seconds(double s) {
    return Stamp{} + Duration::from_seconds(s);
}

// A session and a sensor on a serial line; at different speeds each hears junk. Time goes in steps of 5 ms.
struct Line {
    Line(const Lms2xxParams& params, std::uint32_t device_baud)
        : session(std::make_unique<Lms2xxSession>(params)), device(std::make_unique<Lms2xxDevice>(device_baud)) {
        device->measurement().values.fill(500);
        session->on_open(now);
    }

    void run_until(double until_s) {
        while (now < seconds(until_s)) {
            now = now + Duration{5'000'000};
            session->on_time(now);
            for (;;) {
                const Lms2xxOutput output = session->next_output(now);
                if (output.kind == Lms2xxOutput::Kind::kNothing) {
                    break;
                }
                if (output.kind == Lms2xxOutput::Kind::kReopen) {
                    ++reopened;
                    plugged ? session->on_open(now) : session->on_closed(now);
                } else if (output.kind == Lms2xxOutput::Kind::kSetBaud) {
                    port_baud = output.baud;
                } else if (plugged && port_baud == device->baud()) {
                    device->on_bytes(output.bytes, now);
                }
            }
            device->on_time(now);
            Bytes bytes(device->output().begin(), device->output().end());
            if (port_baud != device->baud()) {
                for (std::uint8_t& byte : bytes) {
                    byte = static_cast<std::uint8_t>(rng.next());
                }
            }
            device->clear_output();
            if (plugged) {
                session->on_bytes(bytes, now, [&](const Lms2xxScan& scan, Stamp beam0) {
                    ++scans;
                    count = scan.count;
                    age_s = (now - beam0).seconds();
                });
            }
        }
    }

    std::unique_ptr<Lms2xxSession> session;
    std::unique_ptr<Lms2xxDevice> device;
    Stamp now;
    Rng rng{17};
    std::uint32_t port_baud = 0;
    bool plugged = true;
    int scans = 0;
    int reopened = 0;
    std::uint16_t count = 0;
    double age_s = 0.0;
};

}  // namespace

TEST_CASE("lms2xx session: finds the speed, sets the wanted one, streams") {
    for (const std::uint32_t found : {9600U, 19200U, 38400U, 500000U}) {
        for (const std::uint32_t wanted : {9600U, 38400U, 500000U}) {
            CAPTURE(found, wanted);
            Line line({wanted, {180, 50}, 0x1FFF}, found);
            line.run_until(7.0);
            CHECK(line.session->state() == Lms2xxState::kStreaming);
            CHECK(line.port_baud == wanted);
            CHECK(line.device->baud() == wanted);
            CHECK(line.scans >= 3);
            CHECK(line.count == 361);
            CHECK(line.reopened == 0);
        }
    }
}

TEST_CASE("lms2xx session: every scan at 500 kbit/s, stamped at its first beam") {
    Line line({500000, {180, 50}, 0x1FFF}, 500000);
    line.run_until(10.0);
    const int before = line.scans;
    line.run_until(20.0);
    CHECK(line.scans - before > 300);  // 37.5 Hz, seen in steps of 5 ms
    // 732 bytes take 14.6 ms, a turn and a half 20 ms.
    CHECK(line.age_s == Approx(0.01464 + 0.02).margin(1e-4));
}

TEST_CASE("lms2xx session: a sensor left streaming by another is quieted first") {
    Line line({500000, {100, 100}, 0x1FFF}, 500000);
    line.device->on_bytes(hex("02 00 02 00 20 24 34 08"), Stamp{});
    REQUIRE(line.device->streams());
    line.device->clear_output();
    line.run_until(7.0);
    CHECK(line.session->state() == Lms2xxState::kStreaming);
    CHECK(line.count == 101);
}

TEST_CASE("lms2xx session: a variant that the sensor does not know is told, its own is used") {
    Line line({9600, {180, 25}, 0x1FFF}, 9600);
    line.run_until(5.0);
    CHECK(line.session->state() == Lms2xxState::kStreaming);
    CHECK(line.session->counters().refused == 1);
    CHECK(line.count == 361);
}

TEST_CASE("lms2xx session: unplugged and plugged again") {
    Line line({500000, {180, 100}, 0x1FFF}, 9600);
    line.run_until(3.0);
    REQUIRE(line.session->state() == Lms2xxState::kStreaming);
    line.plugged = false;
    line.run_until(3.3);
    CHECK(line.session->state() == Lms2xxState::kClosed);
    CHECK(line.session->counters().silences == 1);
    line.run_until(63.0);
    CHECK(line.reopened >= 10);
    CHECK(line.reopened <= 20);
    line.plugged = true;
    const int before = line.scans;
    line.run_until(75.0);
    CHECK(line.session->state() == Lms2xxState::kStreaming);
    CHECK(line.scans > before + 100);
}

TEST_CASE("lms2xx session: a sensor that lost its power comes back at 9600") {
    Line line({500000, {180, 100}, 0x1FFF}, 9600);
    line.run_until(3.0);
    line.device = std::make_unique<Lms2xxDevice>(9600);
    line.run_until(10.0);
    CHECK(line.session->state() == Lms2xxState::kStreaming);
    CHECK(line.device->baud() == 500000);
}

TEST_CASE("lms2xx session: nothing on the line is reopened after the sensor's start-up time") {
    Line line({500000, {180, 100}, 0x1FFF}, 1200);
    line.run_until(34.0);
    CHECK(line.reopened == 0);
    line.run_until(36.0);
    CHECK(line.reopened == 1);
}

TEST_CASE("lms2xx session: stop quiets the sensor") {
    Line line({500000, {180, 100}, 0x1FFF}, 500000);
    line.run_until(5.0);
    REQUIRE(line.device->streams());
    line.session->stop();
    line.run_until(5.1);
    CHECK_FALSE(line.device->streams());
}
