#include "platform/service/motion_input.hpp"

namespace crspf {

void MotionInput::on_data(std::span<const std::uint8_t> payload, Stamp received, SampleSink& sink) {
    if (const auto sample = decoder_.on_datagram(payload, received)) {
        sink.on_motion(*sample);
    }
}

Duration MotionInput::blind(Stamp now) const {
    const auto& since = decoder_.blind_since();
    return since ? now - *since : Duration{};
}

SourceCounts MotionInput::counts() const {
    const MotionCounters& c = decoder_.counters();
    return {{"samples", c.samples},
            {"blind", c.blind},
            {"lost", c.lost},
            {"restarts", c.restarts},
            {"ran_back", c.ran_back},
            {"implausible", c.implausible},
            {"not_finite", c.not_finite},
            {"bad_age", c.bad_age},
            {"bad_length", c.bad_length},
            {"bad_magic", c.bad_magic},
            {"bad_version", c.bad_version},
            {"bad_crc", c.bad_crc}};
}

}  // namespace crspf
