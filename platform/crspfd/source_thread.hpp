// The thread of one sensor: listens, answers, and hands on what it said.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "config/sources.hpp"
#include "core/base/latest_value.hpp"
#include "core/base/spsc_ring.hpp"
#include "platform/crspfd/exchange.hpp"
#include "platform/crspfd/thread_health.hpp"
#include "platform/linux/wakeup.hpp"
#include "platform/service/live_source.hpp"

namespace crspf {

/// What passed through a port, on its way to the recorder.
struct TrafficRecord {
    static constexpr std::size_t kBytesMax = 4096;  ///< what a port reads at once

    Direction direction = Direction::kUnknown;
    Stamp stamp;
    std::uint32_t size = 0;
    std::array<std::uint8_t, kBytesMax> bytes{};
};

/// turn() is one thread's; the rest is for the control thread.
class SourceThread final : private SampleSink, private TrafficSink {
 public:
    /// @param odometry, filter are woken when there is something for them
    SourceThread(SourceConfig config, std::unique_ptr<LiveSource> source, Exchange& exchange, Wakeup& odometry,
                 Wakeup& filter);

    /// Waits for the sensor, at most 100 ms. No heap, no throw.
    void turn(ThreadHealth& health, Duration deadline);

    /// -> recorder, while recording: a third of a second of the fastest sensor.
    SpscRing<TrafficRecord, 256> traffic;

    [[nodiscard]] const SourceConfig& config() const { return config_; }
    /// The newest report of the source; control thread.
    [[nodiscard]] const LiveReport& report() {
        reports_.update();
        return reports_.value();
    }
    [[nodiscard]] std::uint64_t samples() const { return samples_.load(std::memory_order_relaxed); }
    /// When the last sample was received; the beginning of time: none yet.
    [[nodiscard]] Stamp last_sample() const { return {last_sample_ns_.load(std::memory_order_relaxed)}; }

 private:
    void on_scan(const Scan& scan) override;
    void on_cloud(const Cloud& cloud) override;
    void on_wheel(const DifferentialSample& sample) override { hand_on(sample); }
    void on_wheel(const AckermannSample& sample) override { hand_on(sample); }
    void on_imu(const ImuSample& sample) override { hand_on(sample); }
    void on_motion(const MotionSample& sample) override { hand_on(sample); }
    void on_traffic(Direction direction, Stamp stamp, std::span<const std::uint8_t> bytes) override;
    template <class Sample>
    void hand_on(const Sample& sample);
    void count_sample();

    SourceConfig config_;
    std::unique_ptr<LiveSource> source_;
    Exchange& exchange_;
    Wakeup& odometry_;
    Wakeup& filter_;
    Stamp received_;  ///< of the bytes that are being understood
    Stamp reported_;
    LatestValue<LiveReport> reports_;
    std::atomic<std::uint64_t> samples_{0};
    std::atomic<std::int64_t> last_sample_ns_{0};
};

}  // namespace crspf
