// The pose on a bus that is off, full, or down.
#include <catch2/catch.hpp>
#include <cerrno>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "drivers/can/pose_frames.hpp"
#include "platform/crspfd/output_module.hpp"

using namespace crspf;

namespace {

enum class Line : std::uint8_t { kUp, kDown, kFull, kBusOff };

/// What is on the bus, and how the bus is.
struct Wire {
    Line line = Line::kUp;
    std::vector<CanFrame> frames;
    int tries = 0;
    Stamp deadline;
};

class ScriptedBus final : public CanBus {
 public:
    explicit ScriptedBus(Wire& wire) : wire_(wire) {}

    Received receive(CanFrame& /*frame*/, Duration /*wait*/) override {
        if (wire_.line == Line::kBusOff && health_.state != CanState::kBusOff) {
            health_.state = CanState::kBusOff;
            ++health_.bus_offs;
        }
        return {.status = wire_.line == Line::kDown ? IoStatus::kClosed : IoStatus::kRetry};
    }
    IoStatus send(const CanFrame& frame, Stamp deadline) override {
        ++wire_.tries;
        wire_.deadline = deadline;
        switch (wire_.line) {
            case Line::kUp:
                health_.state = CanState::kActive;
                wire_.frames.push_back(frame);
                return IoStatus::kOk;
            case Line::kDown: return IoStatus::kClosed;
            case Line::kFull:
            case Line::kBusOff:
                ++health_.send_timeouts;
                ++health_.queue_full;
                return IoStatus::kRetry;
        }
        return IoStatus::kError;
    }
    const CanHealth& health() const override { return health_; }
    int error() const override { return wire_.line == Line::kDown ? ENETDOWN : 0; }

 private:
    Wire& wire_;
    CanHealth health_;
};

}  // namespace

TEST_CASE("output: a bus that takes nothing costs the poses of that time, and no more") {
    const Line trouble = GENERATE(Line::kDown, Line::kFull, Line::kBusOff);
    const auto exchange = std::make_unique<Exchange>();
    Wire wire;
    OutputModule output(PoseOutputConfig{}, *exchange, std::make_unique<ScriptedBus>(wire));
    constexpr double kStep_m = 0.01;
    Stamp now{10'000'000'000};
    double x_m = 0.0;
    PoseDecoder decoder;
    const auto turn = [&] {
        now = now + output.period();
        x_m += kStep_m;
        OdometryState odometry;
        odometry.stamp = now;
        odometry.P_odom_base.x_m = x_m;
        exchange->odometry.publish(odometry);
        wire.frames.clear();
        wire.tries = 0;
        output.turn(now);
        output.state.update();
        std::optional<PoseReport> pose;
        for (const CanFrame& frame : wire.frames) {
            if (const auto whole = decoder.on_frame(frame)) {
                pose = whole;
            }
        }
        return pose;
    };
    REQUIRE(turn());
    CHECK(output.state.value().unsent == 0);
    CHECK(output.state.value().bus_open);

    wire.line = trouble;
    for (int i = 0; i < 5; ++i) {
        CHECK_FALSE(turn());
        // The first frame that is refused is the last one tried, and nothing waits into the next period.
        CHECK(wire.tries == (trouble == Line::kDown ? 0 : 1));
        CHECK(wire.deadline < now + output.period());
    }
    const OutputState& state = output.state.value();
    CHECK(state.unsent == 5);
    CHECK(state.bus_open == (trouble != Line::kDown));
    CHECK(state.bus_error == (trouble == Line::kDown ? ENETDOWN : 0));
    CHECK(state.bus.bus_offs == (trouble == Line::kBusOff ? 1 : 0));
    CHECK(state.bus.queue_full == (trouble == Line::kDown ? 0 : 5));

    // It recovers by itself, with the pose of now.
    wire.line = Line::kUp;
    const auto pose = turn();
    REQUIRE(pose);
    CHECK(pose->P_map_base.x_m == Approx(x_m).margin(1e-3));
    CHECK(output.state.value().unsent == 5);
    CHECK(decoder.counters().bad_crc + decoder.counters().incomplete == 0);
}
