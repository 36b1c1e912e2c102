#include "drivers/can/signal_binding.hpp"

#include <cmath>  // isfinite

namespace crspf {

std::optional<std::uint64_t> BoundSignal::on_frame(const CanFrame& frame, Stamp received) {
    if (!addressed(binding_.signal, frame)) {
        return std::nullopt;
    }
    ++counters_.frames;
    on_time(received);
    const std::optional<std::uint64_t> raw = bits_in(binding_.signal, frame);
    if (!raw) {
        ++counters_.absent;
        return std::nullopt;
    }
    // The alive counter is followed through invalid frames, too.
    if (!alive_moved(frame)) {
        ++counters_.alive_stuck;
        return std::nullopt;
    }
    if ((binding_.validity && bits_in(*binding_.validity, frame) != binding_.valid_bits) ||
        !std::isfinite(value(*raw))) {
        ++counters_.invalid;
        return std::nullopt;
    }
    last_ = received;
    heard_ = true;
    silent_ = false;
    return raw;
}

void BoundSignal::on_time(Stamp now) {
    if (heard_ && !silent_ && !fresh(now)) {
        silent_ = true;
        ++counters_.timeouts;
    }
}

bool BoundSignal::alive_moved(const CanFrame& frame) {
    if (!binding_.alive) {
        return true;
    }
    const std::optional<std::uint64_t> alive = bits_in(*binding_.alive, frame);
    if (!alive) {
        return false;
    }
    const std::optional<std::uint64_t> before = alive_before_;
    alive_before_ = alive;
    if (!before) {
        return true;
    }
    const unsigned length = binding_.alive->layout.length;
    const std::uint64_t mask = length >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << length) - 1;
    const std::uint64_t step = (*alive - *before) & mask;
    counters_.alive_jumped += step > 1 ? 1U : 0U;
    return step != 0;
}

std::int64_t counted(std::uint64_t before, std::uint64_t now, std::uint64_t modulus) {
    const std::uint64_t forward = now >= before || modulus == 0 ? now - before : modulus - (before - now);
    const std::uint64_t half = modulus == 0 ? std::uint64_t{1} << 63U : modulus - modulus / 2;
    return static_cast<std::int64_t>(forward < half ? forward : forward - modulus);
}

}  // namespace crspf
