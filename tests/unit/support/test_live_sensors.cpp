// Each live sensor is heard through the real port and the real driver. Times are told, not judged: the machine may be
// busy.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "drivers/can/can_signal.hpp"
#include "drivers/can/wheel_decoder.hpp"
#include "drivers/scip/scip_session.hpp"
#include "drivers/velodyne/velodyne_assembler.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "platform/linux/serial_port.hpp"
#include "platform/linux/socketcan.hpp"
#include "platform/linux/udp_receiver.hpp"
#include "tests/unit/drivers/scip_bench.hpp"
#include "tests/unit/drivers/velodyne_stream.hpp"
#include "tests/unit/platform/port_peers.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tools/sim/live_sensors.hpp"

namespace crspf {

namespace {

using sim::LiveCanNode;
using sim::LiveUrg;
using sim::LiveVelodyne;
using test::Scratch;

constexpr Duration kPatience{60'000'000'000};

void revolution_mm(std::uint64_t revolution, std::span<std::uint32_t> step_mm) {
    for (std::size_t i = 0; i < step_mm.size(); ++i) {
        step_mm[i] = static_cast<std::uint32_t>(1000 + 2 * i + revolution % 50);
    }
}

/// The loop of a service: a port and the conversation over it.
class Host {
 public:
    explicit Host(const std::filesystem::path& link) : port_(link, 115200) {}

    void step() {
        session_.on_time(monotonic_now());
        if (session_.wants_port()) {
            open();
        } else if (!open_) {
            sleep_until(monotonic_now() + Duration{5'000'000});
        } else {
            talk();
        }
    }

    /// Steps until it is so; false after a minute.
    template <typename Condition>
    bool until(Condition condition) {
        const Stamp deadline = monotonic_now() + kPatience;
        while (!condition()) {
            if (monotonic_now() > deadline) {
                return false;
            }
            step();
        }
        return true;
    }
    bool scans_more(std::uint64_t count) {
        const std::uint64_t wanted = scans + count;
        return until([&] { return scans >= wanted; });
    }

    [[nodiscard]] const ScipSession& session() const { return session_; }

    std::uint64_t scans = 0;
    std::uint64_t wrong = 0;  ///< scans that are none of revolution_mm()
    std::uint64_t losses = 0;
    Stamp last_scan;   ///< reception
    Stamp last_stamp;  ///< of its beam 0

 private:
    void open();
    void talk();
    void on_scan(const Scan& scan, Stamp received);

    SerialPort port_;
    bool open_ = false;
    ScipSession session_{ScipParams{}};
};

void Host::open() {
    port_.close();
    open_ = port_.read({}, Duration{200'000'000}).status != IoStatus::kClosed;
    if (open_) {
        session_.on_open(monotonic_now());
    } else {
        session_.on_close(monotonic_now());
    }
}

void Host::talk() {
    if (!session_.to_send().empty()) {
        const Stamp now = monotonic_now();
        static_cast<void>(port_.write(session_.to_send()));  // what gets lost is asked for again
        session_.sent(now);
    }
    std::array<std::uint8_t, 4096> buffer{};
    const Received received = port_.read(buffer, Duration{5'000'000});
    if (received.status == IoStatus::kClosed) {
        ++losses;
        open_ = false;
        session_.on_close(monotonic_now());  // once: each would lengthen the pause
    } else if (received.status == IoStatus::kOk) {
        session_.on_bytes(std::span(buffer).first(received.bytes), received.stamp,
                          [&](const Scan& scan) { on_scan(scan, received.stamp); });
    }
}

void Host::on_scan(const Scan& scan, Stamp received) {
    ++scans;
    last_scan = received;
    last_stamp = scan.stamp;
    const std::uint32_t first = session_.listener().ranges().range_mm[0];
    const std::uint32_t amin = session_.listener().sensor().amin;
    bool right = scan.count == 682 && first >= 1000 + 2 * amin && first < 1050 + 2 * amin;
    for (std::uint32_t i = 0; right && i < scan.count; ++i) {
        right = session_.listener().ranges().range_mm[i] == first + 2 * i;
    }
    wrong += right ? 0U : 1U;
}

double ms(Duration d) {
    return d.seconds() * 1e3;
}

FrameSignal position_signal(std::uint32_t id) {
    FrameSignal signal;
    signal.id = id;
    signal.layout = {.start_bit = 16, .length = 32, .type = SignalType::kSigned};
    return signal;
}

CanFrame position_frame(std::uint32_t id, std::int64_t counts) {
    CanFrame frame{.id = id, .length = 6};
    insert_bits(position_signal(id).layout, frame.data, static_cast<std::uint32_t>(counts));
    return frame;
}

}  // namespace

TEST_CASE("live URG: unplugged and plugged in again, told in figures", "[real-kernel]") {
    const Scratch scratch;
    LiveUrg urg({.link = scratch / "urg", .sensor = test::urg_04lx(), .scan = revolution_mm});
    const Stamp begin = monotonic_now();
    const auto host = std::make_unique<Host>(scratch / "urg");
    REQUIRE(host->scans_more(1));
    WARN("first scan " << ms(host->last_scan - begin) << " ms after power-on");
    REQUIRE(host->scans_more(20));
    CHECK(host->wrong == 0);
    CHECK(host->losses == 0);
    // Beam 0 lies 240 degrees of the mirror's turn, and a transfer, before the reception; never after it.
    CHECK(host->last_stamp < host->last_scan);

    for (const std::int64_t pause_ms : {0, 500, 3000}) {
        CAPTURE(pause_ms);
        const std::uint64_t losses = host->losses;
        const Stamp unplugged = urg.unplug();
        REQUIRE(host->until([&] { return host->losses > losses; }));
        CHECK_FALSE(host->session().streaming());
        const Duration noticed = monotonic_now() - unplugged;
        const Stamp again = monotonic_now() + Duration{pause_ms * 1'000'000};
        REQUIRE(host->until([&] { return monotonic_now() >= again; }));
        const Stamp plugged = urg.plug_in();
        REQUIRE(host->scans_more(1));
        WARN("unplugging noticed after " << ms(noticed) << " ms (3 periods are 300 ms); away for " << pause_ms
                                         << " ms; first scan " << ms(host->last_scan - plugged)
                                         << " ms after plugging in");
        REQUIRE(host->scans_more(5));
        CHECK(host->wrong == 0);
    }
}

TEST_CASE("live URG: silence, laser off and garbage are got over", "[real-kernel]") {
    const Scratch scratch;
    LiveUrg urg({.link = scratch / "urg", .sensor = test::urg_04lx(), .scan = revolution_mm});
    const auto host = std::make_unique<Host>(scratch / "urg");
    REQUIRE(host->scans_more(5));

    const Stamp muted = urg.mute(true);
    REQUIRE(host->until([&] { return host->session().counters().silences > 0; }));
    WARN("silence noticed after " << ms(monotonic_now() - muted) << " ms (3 periods are 300 ms)");
    urg.mute(false);
    REQUIRE(host->scans_more(5));

    urg.switch_laser_off();
    REQUIRE(host->until([&] { return host->session().counters().laser_off > 0; }));
    REQUIRE(host->scans_more(5));

    const auto dropped = [&] { return host->session().listener().parser_counters().bytes_dropped; };
    const std::uint64_t before = dropped();
    urg.garble(300);
    REQUIRE(host->until([&] { return dropped() > before; }));
    REQUIRE(host->scans_more(5));
    CHECK(host->wrong == 0);
}

TEST_CASE("live Velodyne: heard through the UDP port", "[real-kernel]") {
    constexpr std::uint32_t kLoopback = 0x7F000001;
    const std::uint16_t port = test::free_port(SOCK_DGRAM);
    UdpReceiver receiver({.own_address = kLoopback, .port = port, .source_address = kLoopback});
    const auto assembler = std::make_unique<VelodyneAssembler>(VelodyneParams{.source_address = kLoopback});
    test::VelodyneStream stream(VelodyneModel::kVlp16);
    LiveVelodyne sensor(port, Duration{1'327'104},
                        [&](std::uint64_t) { return stream.next_bytes([](auto...) { return 2500; }); });
    std::size_t revolutions = 0;
    std::size_t points = 0;
    std::size_t wrong = 0;
    auto visit = [&](const VelodyneCloud& cloud) {
        revolutions += cloud.complete ? 1U : 0U;
        for (std::uint32_t column = 0; column < cloud.columns; ++column) {
            for (std::uint32_t laser = 0; laser < cloud.lasers; ++laser) {
                const std::size_t i = cloud.at(column, laser);
                const float square =
                    cloud.x_m[i] * cloud.x_m[i] + cloud.y_m[i] * cloud.y_m[i] + cloud.z_m[i] * cloud.z_m[i];
                points += cloud.measured[column] ? 1U : 0U;
                wrong += cloud.measured[column] && (square < 24.9F || square > 25.1F) ? 1U : 0U;
            }
        }
    };
    const Stamp deadline = monotonic_now() + kPatience;
    std::vector<std::uint8_t> buffer(2048);
    while (revolutions < 3 && monotonic_now() < deadline) {
        const Datagram datagram = receiver.receive(buffer, Duration{10'000'000});
        if (datagram.io.status == IoStatus::kOk) {
            assembler->on_data(std::span(buffer).first(datagram.io.bytes), datagram.source_address, datagram.io.stamp,
                               visit);
        }
    }
    CHECK(revolutions >= 3);
    CHECK(points > 84'000);
    CHECK(wrong == 0);
    CHECK(sensor.sent() + 1 >= assembler->counters().packets);  // the last may be heard before it is counted
    CHECK(assembler->counters().foreign + assembler->counters().bad_length == 0);
}

TEST_CASE("live CAN node: heard through SocketCan") {
    constexpr double kScale_m = 1e-4;
    LiveCanNode node(Duration{20'000'000}, [](std::uint64_t tick) {
        const auto t = static_cast<std::int64_t>(tick);
        return std::vector<CanFrame>{position_frame(0x381, 40 * t), position_frame(0x382, 60 * t)};
    });
    SocketCan bus(node.take_bus());
    WheelParams wheels;
    wheels.left.signal = {.signal = position_signal(0x381), .scale = kScale_m};
    wheels.right.signal = {.signal = position_signal(0x382), .scale = kScale_m};
    // The two frames are sent one after the other; how far apart they are heard is the machine's business.
    wheels.pair_within = Duration{9'000'000};
    WheelDecoder decoder(wheels);
    double left_m = 0.0;
    double right_m = 0.0;
    std::size_t samples = 0;
    const Stamp deadline = monotonic_now() + kPatience;
    while (samples < 30 && monotonic_now() < deadline) {
        CanFrame frame;
        const Received received = bus.receive(frame, Duration{10'000'000});
        if (received.status != IoStatus::kOk) {
            continue;
        }
        if (const std::optional<DifferentialSample> sample = decoder.on_frame(frame, received.stamp)) {
            left_m += sample->left_m;
            right_m += sample->right_m;
            ++samples;
        }
    }
    REQUIRE(samples == 30);
    const double ticks = left_m / (40 * kScale_m);
    CHECK(ticks >= 30.0 - 1e-9);
    CHECK(ticks == Approx(std::floor(ticks + 0.5)));
    CHECK(right_m == Approx(1.5 * left_m));
    CHECK(bus.health().interface_downs == 0);
}

}  // namespace crspf
