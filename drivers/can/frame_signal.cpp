#include "drivers/can/frame_signal.hpp"

#include <algorithm>
#include <span>

namespace crspf {

bool addressed(const FrameSignal& signal, const CanFrame& frame) {
    return ((frame.id ^ signal.id) & signal.id_mask) == 0 && frame.extended == signal.extended && !frame.error &&
           !frame.remote;
}

std::optional<std::uint64_t> bits_in(const FrameSignal& signal, const CanFrame& frame) {
    const std::span<const std::uint8_t> payload = frame.payload();
    if (!addressed(signal, frame) || !fits(signal.layout, payload.size())) {
        return std::nullopt;
    }
    if (signal.range_count > 0) {
        if (!fits(signal.selector, payload.size())) {
            return std::nullopt;
        }
        const std::uint64_t selected = extract_bits(signal.selector, payload);
        const std::span<const FrameSignal::Range> ranges(signal.ranges.data(), signal.range_count);
        if (std::none_of(ranges.begin(), ranges.end(),
                         [&](const auto& range) { return range.low <= selected && selected <= range.high; })) {
            return std::nullopt;
        }
    }
    return extract_bits(signal.layout, payload);
}

std::optional<double> value_in(const FrameSignal& signal, const CanFrame& frame) {
    const std::optional<std::uint64_t> raw = bits_in(signal, frame);
    return raw ? std::optional(value_of(signal.layout, *raw)) : std::nullopt;
}

}  // namespace crspf
