// A host that talks to a simulated SCIP sensor, in simulated time, and all that passes between the two.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <vector>

#include "core/base/time.hpp"
#include "drivers/scip/scip_device.hpp"
#include "drivers/scip/scip_session.hpp"
#include "platform/capture/capture_reader.hpp"
#include "tools/sim/lidar_model.hpp"
#include "tools/sim/random.hpp"

namespace crspf::sim {

/// What a lidar of this kind says of itself. Its steps look where the model's beams look.
/// Throws InputError for a model that does not speak SCIP, or reaches farther than SCIP's codes leave room for.
[[nodiscard]] ScipSensor scip_sensor_of(const LidarModel& model);

struct ScipLinkParams {
    ScipSensor sensor;
    Stamp power_on;                   ///< the sensor's clock is 0
    double clock_drift = 100e-6;      ///< by which the sensor's clock is fast
    Duration request_delay{200'000};  ///< mean of the random part of the way to the sensor
    Duration reply_delay{1'000'000};  ///< the same of the way back
    std::uint64_t seed = 1;
};

/// The host asks, the sensor answers; random delays only ever make things later, and nothing overtakes.
class ScipLink {
 public:
    /// What the host's port hears and says, at that time; an empty reception where it opened the port.
    using Record = std::function<void(Direction, Stamp, std::span<const std::uint8_t>)>;

    ScipLink(const ScipLinkParams& params, Record record);

    /// The host's port is there from now on.
    void begin(Stamp now) { next_tick_ = now; }
    /// All that happens up to then.
    void advance_to(Stamp until);
    /// A sweep is over at `end`, not before advance_to()'s time. `range_mm` are the sensor's steps from its first
    /// measuring one on, which passed at `begin`.
    void on_sweep(Stamp begin, Stamp end, std::span<const int> range_mm);

    [[nodiscard]] bool streaming() const { return session_.streaming(); }

 private:
    struct Parcel {
        Stamp arrival;
        std::vector<std::uint8_t> bytes;
    };

    void serve_host(Stamp now);
    void reply(Stamp now, std::span<const std::uint8_t> bytes);
    [[nodiscard]] Stamp device_time(Stamp host) const;
    [[nodiscard]] Duration random_delay(Duration mean);

    ScipLinkParams params_;
    Record record_;
    Random random_;
    ScipDevice device_;
    ScipSession session_;
    Stamp next_tick_;
    std::deque<Parcel> to_device_;
    std::deque<Parcel> to_host_;
    Stamp last_to_device_;
    Stamp last_to_host_;
};

}  // namespace crspf::sim
