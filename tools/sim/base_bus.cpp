#include "tools/sim/base_bus.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "drivers/can/dbc_lookup.hpp"

namespace crspf::sim {
namespace {

constexpr Duration kFrame{110'000};        // on a bus of 1 Mbit/s
constexpr double kDelayMean_ns = 200'000;  // from there to the host's stamp

}  // namespace

FrameSignal signal_of(std::string_view dbc, std::string_view dotted) {
    const std::size_t dot = dotted.find('.');
    const DbcLookup found = find_signal(dbc, dotted.substr(0, dot), dotted.substr(dot + 1));
    if (found.status != DbcLookup::Status::kFound) {
        throw std::logic_error("a simulated bus's own signals are not in its DBC text");
    }
    return found.signal;
}

BaseBus::BaseBus(std::uint64_t seed, RandomStream stream, Record record)
    : record_(std::move(record)), random_(seed, stream) {}

void BaseBus::put(Stamp now, const CanFrame& frame) {
    const Duration delay{static_cast<std::int64_t>(kDelayMean_ns * random_.exponential())};
    last_ = std::max(last_ + kFrame, now + kFrame + delay);
    record_(last_, frame);
}

}  // namespace crspf::sim
