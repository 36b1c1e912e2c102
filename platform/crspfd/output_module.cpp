#include "platform/crspfd/output_module.hpp"

#include <utility>

namespace crspf {

OutputModule::OutputModule(const PoseOutputConfig& config, Exchange& exchange, std::unique_ptr<CanBus> bus)
    : exchange_(exchange),
      period_(Duration::from_seconds(1.0 / config.rate_hz)),
      composer_(config),
      encoder_(config.base_id),
      bus_(std::move(bus)) {}

void OutputModule::turn(Stamp now) {
    exchange_.odometry.for_output.update();
    exchange_.filter.for_output.update();
    out_.report = composer_.compose(now, exchange_.odometry.for_output.value(), exchange_.filter.for_output.value());
    out_.counters = composer_.counters();
    if (bus_ != nullptr) {
        send(out_.report, now);
    }
    state.publish(out_);
}

void OutputModule::send(const PoseReport& report, Stamp now) {
    // Opens the bus when it is up, and hears of its errors.
    CanFrame ignored;
    out_.bus_open = bus_->receive(ignored, {}).status != IoStatus::kClosed;
    if (const auto frames = encoder_.encode(report)) {
        bool sent = out_.bus_open;
        const Stamp deadline = now + Duration{period_.ns / 2};
        for (std::size_t i = 0; i < frames->size() && sent; ++i) {
            sent = bus_->send((*frames)[i], deadline) == IoStatus::kOk;
        }
        out_.unsent += sent ? 0 : 1;
    }
    out_.bus = bus_->health();
    out_.bus_error = bus_->error();
}

}  // namespace crspf
