// Sensors on the network, each at the other end of a real socket.
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "config/config.hpp"
#include "drivers/sick/sick_device.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "platform/service/live_source.hpp"
#include "platform/service/motion_sender.hpp"
#include "tests/unit/drivers/sick_examples.hpp"
#include "tests/unit/drivers/velodyne_stream.hpp"
#include "tests/unit/platform/port_peers.hpp"
#include "tools/sim/live_sensors.hpp"

using namespace crspf;
using crspf::test::LoopbackSocket;

namespace {

constexpr Duration kPatience{60'000'000'000};

class Counting final : public SampleSink, public TrafficSink {
 public:
    void on_scan(const Scan& scan) override {
        ++scans;
        beams = scan.count;
    }
    void on_cloud(const Cloud& /*cloud*/) override {}
    void on_wheel(const DifferentialSample& /*sample*/) override {}
    void on_wheel(const AckermannSample& /*sample*/) override {}
    void on_imu(const ImuSample& /*sample*/) override {}
    void on_motion(const MotionSample& sample) override { motions.push_back(sample); }
    void on_traffic(Direction direction, Stamp /*stamp*/, std::span<const std::uint8_t> bytes) override {
        opened += bytes.empty() ? 1 : 0;
        sent += direction == Direction::kSent ? 1 : 0;
    }
    int scans = 0;
    int opened = 0;
    int sent = 0;
    std::vector<MotionSample> motions;
    std::uint32_t beams = 0;
};

bool scans_more(LiveSource& source, Counting& counting, int more) {
    const int wanted = counting.scans + more;
    const Stamp deadline = monotonic_now() + kPatience;
    while (counting.scans < wanted && monotonic_now() < deadline) {
        source.step(Duration{10'000'000}, counting, counting);
    }
    return counting.scans >= wanted;
}

/// A SICK lidar that accepts one connection after the other.
class SickServer {
 public:
    SickServer() : thread_([this](const std::stop_token& stop) { serve(stop); }) {}

    [[nodiscard]] std::uint16_t port() const { return socket_.port(); }
    void drop_connection() { drop_ = true; }

 private:
    void serve(const std::stop_token& stop) {
        const auto device = std::make_unique<SickDevice>(SickDeviceParams{}, monotonic_now());
        crspf::test::fill_tim(device->measurement());
        while (!stop.stop_requested()) {
            if (wait_for(socket_.fd(), POLLIN, Duration{10'000'000}) == 0) {
                continue;
            }
            const UniqueFd host(::accept4(socket_.fd(), nullptr, nullptr, SOCK_CLOEXEC));
            device->on_connect();
            device->clear_output();
            drop_ = false;
            while (!stop.stop_requested() && !drop_ && talk(*device, host.get())) {
            }
        }
    }
    static bool talk(SickDevice& device, int host) {
        std::array<std::uint8_t, 512> buffer{};
        if (wait_for(host, POLLIN, Duration{5'000'000}) != 0) {
            const ssize_t got = ::recv(host, buffer.data(), buffer.size(), 0);
            if (got <= 0) {
                return false;
            }
            device.on_bytes(std::span(buffer).first(static_cast<std::size_t>(got)), monotonic_now());
        }
        device.on_time(monotonic_now());
        const auto out = device.output();
        const bool sent = ::send(host, out.data(), out.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(out.size());
        device.clear_output();
        return sent;
    }

    LoopbackSocket socket_{SOCK_STREAM};
    std::atomic<bool> drop_ = false;
    std::jthread thread_;  ///< last: it uses the others
};

}  // namespace

TEST_CASE("live: a SICK on TCP, whose connection is lost once") {
    SickServer sensor;
    const Config config = parse_config(
        "[source.lidar]\ndriver = \"sick\"\nport = \"tcp://127.0.0.1:" + std::to_string(sensor.port()) + "\"\n", "c");
    const auto source = open_live(config.sources[0], config.slam.lidar);
    Counting counting;
    CHECK(source->report().state.view().find("not yet open") != std::string::npos);
    REQUIRE(scans_more(*source, counting, 10));
    CHECK(source->report().state.view() == "streaming");
    CHECK(counting.beams == 811);
    CHECK(counting.opened == 1);
    CHECK(counting.sent > 3);
    sensor.drop_connection();
    REQUIRE(scans_more(*source, counting, 20));
    CHECK(counting.opened >= 2);
}

TEST_CASE("live: a Velodyne's datagrams", "[real-kernel]") {
    const std::uint16_t port = crspf::test::free_port(SOCK_DGRAM);
    const Config config = parse_config(
        "[source.lidar]\ndriver = \"velodyne\"\naddress = \"127.0.0.1\"\nport = "
        "\"udp://127.0.0.1:" +
            std::to_string(port) + "\"\n",
        "c");
    const auto source = open_live(config.sources[0], config.slam.lidar);
    Counting counting;
    source->step({}, counting, counting);  // the socket stands before the sensor speaks
    crspf::test::VelodyneStream stream(VelodyneModel::kVlp16);
    const crspf::sim::LiveVelodyne sensor(port, Duration{1'327'000}, [&](std::uint64_t) {
        std::vector<std::uint8_t> payload(kVelodyneDataBytes);
        encode(stream.next([](double, std::uint32_t, std::uint32_t) { return 2500; }), VelodyneModel::kVlp16, payload);
        return payload;
    });
    REQUIRE(scans_more(*source, counting, 3));
    CHECK(counting.beams == 1800);
    CHECK(counting.sent == 0);
    CHECK(source->report().state.view() == "streaming");
}

TEST_CASE("live: another process's motion, which is blind at times", "[real-kernel]") {
    const std::uint16_t port = crspf::test::free_port(SOCK_DGRAM);
    const Config config = parse_config(
        "[source.stereo]\ndriver = \"motion\"\nport = \"udp://127.0.0.1:" + std::to_string(port) + "\"\n", "c");
    const auto source = open_live(config.sources[0], config.slam.lidar);
    Counting counting;
    source->step({}, counting, counting);
    CHECK(source->report().state.view().find("nothing yet") != std::string::npos);
    MotionSender sender(0x7F000001, port, 1);
    const auto send = [&](bool blind) {
        const std::size_t wanted = counting.motions.size() + 1;
        const Stamp stamp = monotonic_now();
        sender.send({.stamp = stamp, .P_previous_base = {.x_m = 0.1}, .translation_variance_m2 = 1e-4, .blind = blind});
        const Stamp deadline = monotonic_now() + kPatience;
        while (counting.motions.size() < wanted && monotonic_now() < deadline) {
            source->step(Duration{10'000'000}, counting, counting);
        }
        REQUIRE(counting.motions.size() == wanted);
        return stamp;
    };
    send(false);
    const Stamp stamp = send(false);
    CHECK(counting.motions.back().P_previous_base.x_m == Approx(0.1));
    CHECK(counting.motions.back().translation_variance_m2 == Approx(1e-4));
    CHECK(counting.motions.back().stamp - stamp > Duration{-1'000'000});  // of the time before the sending
    LiveReport report = source->report();
    CHECK(report.streaming);
    CHECK(report.state.view() == "streaming");
    CHECK(report.blind == Duration{});

    const Stamp blind = send(true);
    CHECK(counting.motions.back().blind);
    sleep_until(blind + Duration{210'000'000});
    report = source->report();
    CHECK(report.blind >= Duration{200'000'000});
    CHECK(report.state.view().starts_with("blind for "));
    CHECK(report.state.view().find(" s; its motion is a prediction") != std::string::npos);
    send(false);
    CHECK(source->report().state.view() == "streaming");
    CHECK(counting.sent == 0);
    CHECK(sender.counters().sent == 4);
}
