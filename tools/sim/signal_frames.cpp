#include "tools/sim/signal_frames.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <span>
#include <stdexcept>

#include "drivers/can/dbc_reader.hpp"

namespace crspf::sim {
namespace {

/// The message of the signal without anything in it yet.
CanFrame empty_frame(std::string_view dbc, const FrameSignal& signal) {
    DbcReader reader(dbc);
    for (DbcReader::Item item = reader.next(); item != DbcReader::Item::kEnd; item = reader.next()) {
        const DbcMessage& message = reader.message();
        if (item == DbcReader::Item::kError) {
            break;
        }
        if (item == DbcReader::Item::kMessage && message.id == signal.id && message.extended == signal.extended) {
            return {.id = message.id,
                    .extended = message.extended,
                    .fd = message.bytes > 8,
                    .length = static_cast<std::uint8_t>(message.bytes)};
        }
    }
    throw std::logic_error("a signal's message is not in its DBC text");
}

void insert(const CanSignal& layout, CanFrame& frame, std::uint64_t bits) {
    insert_bits(layout, std::span(frame.data).first(frame.length), bits);
}

}  // namespace

SignalFrames::SignalFrames(std::string_view dbc, const std::vector<SignalBinding>& bindings) {
    // Those that share a message by turns first: a signal beside them is then in every one of its frames.
    for (const bool selected : {true, false}) {
        for (const SignalBinding& binding : bindings) {
            const FrameSignal& signal = binding.signal;
            const bool carried = std::any_of(frames_.begin(), frames_.end(),
                                             [&](const CanFrame& frame) { return bits_in(signal, frame).has_value(); });
            if ((signal.range_count > 0) != selected || carried) {
                continue;
            }
            CanFrame frame = empty_frame(dbc, signal);
            if (!fits(signal.layout, frame.length)) {
                throw std::logic_error("a signal does not fit its message");
            }
            if (selected) {
                insert(signal.selector, frame, signal.ranges[0].low);
            }
            frames_.push_back(frame);
        }
    }
    for (const SignalBinding& binding : bindings) {
        if (binding.alive) {
            counters_.push_back(*binding.alive);
        }
    }
}

void SignalFrames::set(const SignalBinding& binding, double value) {
    const CanSignal& layout = binding.signal.layout;
    double told = value / binding.scale;
    if (layout.type == SignalType::kUnsigned && layout.factor > 0.0 && layout.offset >= 0.0) {
        told = std::abs(told);
    }
    const std::optional<std::uint64_t> bits = bits_of(layout, told);
    if (!bits) {
        throw std::logic_error("a signal that cannot hold a number");
    }
    set_bits(binding.signal, *bits);
    if (binding.validity) {
        set_bits(*binding.validity, binding.valid_bits);
    }
}

void SignalFrames::set_bits(const FrameSignal& signal, std::uint64_t bits) {
    for (CanFrame& frame : frames_) {
        if (bits_in(signal, frame)) {
            insert(signal.layout, frame, bits);
        }
    }
}

void SignalFrames::send(const std::function<void(const CanFrame&)>& put) {
    ++alive_;
    for (const FrameSignal& counter : counters_) {
        set_bits(counter, alive_);
    }
    for (const CanFrame& frame : frames_) {
        put(frame);
    }
}

void WheelSignal::tell(double way_m, double speed_mps, SignalFrames& frames) {
    const SignalBinding& signal = binding_.signal;
    const double metres_per_value = signal.signal.layout.factor * signal.scale;
    const auto position = static_cast<std::int64_t>(std::floor(way_m / metres_per_value + 0.5));
    const std::int64_t moved = position - position_;
    position_ = position;
    bool backward = moved < 0;
    if (binding_.is_speed) {
        const bool reversed = speed_mps / signal.scale < 0.0;
        backward = reversed;
        frames.set(signal, binding_.direction && reversed ? -speed_mps : speed_mps);
    } else {
        counted_ += binding_.direction ? std::abs(moved) : moved;
        auto bits = static_cast<std::uint64_t>(counted_);
        if (binding_.modulus != 0) {
            const auto modulus = static_cast<std::int64_t>(binding_.modulus);
            bits = static_cast<std::uint64_t>((counted_ % modulus + modulus) % modulus);
        }
        frames.set_bits(signal.signal, bits);
        if (signal.validity) {
            frames.set_bits(*signal.validity, signal.valid_bits);
        }
    }
    if (binding_.direction) {
        const std::uint64_t forward_bits = binding_.backward_bits == 0 ? 1 : 0;
        frames.set_bits(*binding_.direction, backward ? binding_.backward_bits : forward_bits);
    }
}

}  // namespace crspf::sim
