#include "tools/crspf/bench_streams.hpp"

#include <benchmark/benchmark.h>

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "drivers/can/can_signal.hpp"
#include "drivers/can/wheel_decoder.hpp"
#include "drivers/common/byte_writer.hpp"
#include "drivers/scip/scip_device.hpp"
#include "drivers/scip/scip_listener.hpp"

namespace crspf::cli {
namespace {

/// A UTM-30LX that sends whole turns, and who listens to it.
class ScipBench {
 public:
    ScipBench() : device_({.sensor = utm30lx()}), range_mm_(utm30lx().amax + 1) {
        for (std::size_t i = 0; i < range_mm_.size(); ++i) {
            range_mm_[i] = static_cast<std::uint32_t>(500 + 37 * i % 20'000);
        }
        constexpr std::array<std::uint8_t, 3> kParameters{'P', 'P', '\n'};
        talk(kParameters);
        ByteWriter scans(request_);
        put_request(scans, {.end = utm30lx().amax});
        scans.byte('\n');
        talk(scans.written());
    }

    void next() {
        now_ = now_ + Duration{25'000'000};
        ByteWriter out(reply_);
        device_.on_revolution(now_, range_mm_, {}, out);
        hear(out.written());
        ++sent_;
    }
    /// Every scan was understood.
    [[nodiscard]] bool sound() const { return scans_ == sent_; }

 private:
    static ScipSensor utm30lx() {
        ScipSensor sensor;
        sensor.dmin_mm = 23;
        sensor.dmax_mm = 60'000;
        sensor.ares = 1440;
        sensor.amax = 1080;
        sensor.afrt = 540;
        sensor.scan_rpm = 2400;
        return sensor;
    }
    void talk(Bytes request) {
        listener_->on_sent(now_);
        ByteWriter out(reply_);
        device_.on_bytes(request, now_, out);
        hear(out.written());
    }
    void hear(Bytes bytes) {
        listener_->on_bytes(
            bytes, now_, [this](const ScipReply& /*reply*/, const Scan* scan) { scans_ += scan != nullptr ? 1 : 0; });
    }

    Stamp now_{1'000'000'000};
    ScipDevice device_;
    std::unique_ptr<ScipListener> listener_ = std::make_unique<ScipListener>();
    std::vector<std::uint32_t> range_mm_;
    std::array<std::uint8_t, 64> request_{};
    std::array<std::uint8_t, 16384> reply_{};
    std::uint64_t sent_ = 0;
    std::uint64_t scans_ = 0;
};

/// Two wheels that count, a frame each in turn.
class WheelBench {
 public:
    void next() {
        const std::uint32_t side = sent_ % 2;
        CanFrame frame{.id = side + 1, .length = 8};
        const std::uint64_t count = sent_ / 2 * 7;
        for (std::size_t i = 0; i < 4; ++i) {
            frame.data[i] = static_cast<std::uint8_t>(count >> (8 * i));
        }
        now_ = now_ + Duration{500'000};
        samples_ += decoder_.on_frame(frame, now_) ? 1U : 0U;
        ++sent_;
    }
    /// A sample for each pair but the first, from which the counting begins.
    [[nodiscard]] bool sound() const { return samples_ + 1 >= sent_ / 2; }

 private:
    static WheelParams params() {
        const auto wheel = [](std::uint32_t id) {
            WheelBinding binding;
            binding.signal.signal.id = id;
            binding.signal.signal.layout.length = 32;
            binding.signal.scale = 1e-4;
            return binding;
        };
        return {.left = wheel(1), .right = wheel(2)};
    }

    Stamp now_{1'000'000'000};
    WheelDecoder decoder_{params()};
    std::uint64_t sent_ = 0;
    std::uint64_t samples_ = 0;
};

template <class Bench>
void register_case(const char* name) {
    // Goes on where it stopped, as a sensor does.
    const auto bench = std::make_shared<std::unique_ptr<Bench>>();
    benchmark::RegisterBenchmark(name, [bench](benchmark::State& state) {
        if (*bench == nullptr) {
            *bench = std::make_unique<Bench>();
        }
        for ([[maybe_unused]] auto _ : state) {
            (*bench)->next();
        }
        if (!(*bench)->sound()) {
            state.SkipWithError("not all of it was understood: this is not the cost of decoding");
        }
        state.SetItemsProcessed(state.iterations());
    });
}

}  // namespace

void register_stream_cases() {
    // NOLINTBEGIN(clang-analyzer-cplusplus.NewDeleteLeaks): the library keeps and frees what is registered
    register_case<ScipBench>(kScipUtm30lx);
    register_case<WheelBench>(kCanWheels);
    // NOLINTEND(clang-analyzer-cplusplus.NewDeleteLeaks)
}

}  // namespace crspf::cli
