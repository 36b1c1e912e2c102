#include "platform/service/can_input.hpp"

#include <algorithm>
#include <string_view>
#include <type_traits>

namespace crspf {

namespace {

/// Several signals and nodes count the same things: their sums.
void add(SourceCounts& out, const char* name, std::uint64_t count) {
    auto* const found =
        std::find_if(out.begin(), out.end(), [&](const auto& c) { return std::string_view(c.first) == name; });
    if (found == out.end()) {
        out.append({{name, count}});
    } else {
        found->second += count;
    }
}

void add(SourceCounts& out, const BindingCounters& binding) {
    add(out, "absent", binding.absent);
    add(out, "invalid", binding.invalid);
    add(out, "alive_stuck", binding.alive_stuck);
    add(out, "alive_jumped", binding.alive_jumped);
    add(out, "silences", binding.timeouts);
}

}  // namespace

CanInput::CanInput(const CanSourceConfig& config) {
    if (const auto* wheels = std::get_if<WheelParams>(&config.odometer)) {
        decoder_.emplace<WheelDecoder>(*wheels);
    } else if (const auto* ackermann = std::get_if<AckermannParams>(&config.odometer)) {
        decoder_.emplace<AckermannDecoder>(*ackermann);
    } else if (const auto* imu = std::get_if<ImuParams>(&config.odometer)) {
        decoder_.emplace<ImuDecoder>(*imu);
    }
    for (const std::uint32_t node : config.canopen_nodes) {
        nodes_.emplace_back(static_cast<std::uint8_t>(node), Duration::from_seconds(config.heartbeat_timeout_s));
    }
}

std::optional<CanFrame> CanInput::on_frame(const CanFrame& frame, Stamp received, SampleSink& sink) {
    if (auto* wheels = std::get_if<WheelDecoder>(&decoder_)) {
        if (const auto sample = wheels->on_frame(frame, received)) {
            sink.on_wheel(*sample);
        }
    } else if (auto* ackermann = std::get_if<AckermannDecoder>(&decoder_)) {
        if (const auto sample = ackermann->on_frame(frame, received)) {
            sink.on_wheel(*sample);
        }
    } else if (auto* imu = std::get_if<ImuDecoder>(&decoder_)) {
        if (const auto sample = imu->on_frame(frame, received)) {
            sink.on_imu(*sample);
        }
    }
    std::optional<CanFrame> answer;
    for (HeartbeatWatch& node : nodes_) {
        if (const auto start = node.on_frame(frame, received)) {
            answer = start;  // a heartbeat is one node's
        }
    }
    return answer;
}

void CanInput::on_time(Stamp now) {
    std::visit(
        [now](auto& decoder) {
            if constexpr (!std::is_same_v<std::decay_t<decltype(decoder)>, std::monostate>) {
                decoder.on_time(now);
            }
        },
        decoder_);
    for (HeartbeatWatch& node : nodes_) {
        node.on_time(now);
    }
}

SourceCounts CanInput::counts() const {
    SourceCounts out;
    if (const auto* wheels = std::get_if<WheelDecoder>(&decoder_)) {
        const WheelCounters& c = wheels->counters();
        out = {{"samples", c.samples}, {"jumps", c.jumps}, {"restarts", c.restarts}, {"unpaired", c.unpaired}};
        add(out, wheels->left_counters());
        add(out, wheels->right_counters());
    } else if (const auto* ackermann = std::get_if<AckermannDecoder>(&decoder_)) {
        out = {{"samples", ackermann->counters().samples}, {"incomplete", ackermann->counters().incomplete}};
        add(out, ackermann->speed().counters());
        add(out, ackermann->steering_counters());
    } else if (const auto* imu = std::get_if<ImuDecoder>(&decoder_)) {
        out = {{"samples", imu->counters().samples}, {"incomplete", imu->counters().incomplete}};
        if (imu->speed()) {
            add(out, imu->speed()->counters());
        }
        add(out, imu->yaw_rate_counters());
        if (const auto& inertial = imu->inertial()) {
            for (const BoundSignal& signal : inertial->signals()) {
                add(out, signal.counters());
            }
        }
    }
    for (const HeartbeatWatch& node : nodes_) {
        add(out, "node_boot_ups", node.counters().boot_ups);
        add(out, "node_silences", node.counters().timeouts);
    }
    return out;
}

}  // namespace crspf
