#include "platform/crspfd/source_thread.hpp"

#include <algorithm>
#include <utility>

#include "platform/linux/monotonic_clock.hpp"

namespace crspf {

namespace {

constexpr Duration kWait{100'000'000};
constexpr Duration kReport{100'000'000};

}  // namespace

SourceThread::SourceThread(SourceConfig config, std::unique_ptr<LiveSource> source, Exchange& exchange,
                           Wakeup& odometry, Wakeup& filter)
    : config_(std::move(config)),
      source_(std::move(source)),
      exchange_(exchange),
      odometry_(odometry),
      filter_(filter) {
    reports_.publish({.streaming = false, .state = StateText("starting"), .counts = {}});
}

void SourceThread::turn(ThreadHealth& health, Duration deadline) {
    received_ = {};
    source_->step(kWait, *this, *this);
    const Stamp now = monotonic_now();
    if (received_ > Stamp{}) {
        health.worked(now - received_, deadline);
    }
    health.turned(now);
    if (now - reported_ >= kReport) {
        reported_ = now;
        reports_.publish(source_->report());
    }
}

void SourceThread::on_traffic(Direction direction, Stamp stamp, std::span<const std::uint8_t> bytes) {
    if (direction == Direction::kReceived) {
        received_ = stamp;
    }
    // Acquire, with the release of Service::start(): the ring is drained from now on.
    if (!exchange_.recording.load(std::memory_order_acquire)) {
        return;
    }
    if (TrafficRecord* const record = bytes.size() <= TrafficRecord::kBytesMax ? traffic.claim() : nullptr) {
        record->direction = direction;
        record->stamp = stamp;
        record->size = static_cast<std::uint32_t>(bytes.size());
        std::copy(bytes.begin(), bytes.end(), record->bytes.begin());
        traffic.commit();
    }
}

void SourceThread::on_scan(const Scan& scan) {
    count_sample();
    if (config_.record_only) {
        return;
    }
    ReceivedScan& slot = exchange_.scan.slot();
    slot.scan = scan;
    slot.received = received_;
    exchange_.scan.publish();
    filter_.notify();
}

void SourceThread::on_cloud(const Cloud& cloud) {
    count_sample();
    if (config_.record_only || exchange_.cloud == nullptr) {
        return;
    }
    ReceivedCloud& slot = exchange_.cloud->slot();
    slot.cloud.take(cloud);
    slot.received = received_;
    exchange_.cloud->publish();
    filter_.notify();
}

template <class Sample>
void SourceThread::hand_on(const Sample& sample) {
    count_sample();
    if (config_.record_only) {
        return;
    }
    static_cast<void>(exchange_.motions.push({.sample = sample, .received = received_}));  // the ring counts
    odometry_.notify();
}

void SourceThread::count_sample() {
    TimeHistogram::bump(samples_);
    last_sample_ns_.store(received_.ns, std::memory_order_relaxed);
}

}  // namespace crspf
