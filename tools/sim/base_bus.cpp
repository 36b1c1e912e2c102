#include "tools/sim/base_bus.hpp"

#include <algorithm>
#include <utility>

namespace crspf::sim {
namespace {

constexpr Duration kFrame{110'000};        // on a bus of 1 Mbit/s
constexpr double kDelayMean_ns = 200'000;  // from there to the host's stamp

}  // namespace

BaseBus::BaseBus(std::uint64_t seed, std::uint64_t stream, Record record)
    : record_(std::move(record)), random_(seed, stream) {}

void BaseBus::put(Stamp now, const CanFrame& frame) {
    const Duration delay{static_cast<std::int64_t>(kDelayMean_ns * random_.exponential())};
    last_ = std::max(last_ + kFrame, now + kFrame + delay);
    record_(last_, frame);
}

}  // namespace crspf::sim
