// A host that talks to a simulated lidar on a byte stream, in simulated time, and all that passes between the two.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "config/sources.hpp"
#include "core/base/time.hpp"
#include "platform/capture/capture_reader.hpp"
#include "platform/service/stream_talk.hpp"
#include "tools/sim/lidar_model.hpp"
#include "tools/sim/random.hpp"
#include "tools/sim/stream_sensor.hpp"

namespace crspf::sim {

struct StreamLinkParams {
    Stamp power_on;                   ///< the sensor's clock is 0
    double clock_drift = 100e-6;      ///< by which the sensor's clock is fast
    Duration request_delay{200'000};  ///< mean of the random part of the way to the sensor
    Duration reply_delay{1'000'000};  ///< the same of the way back
    std::uint64_t seed = 1;
};

/// The host asks, the sensor answers; random delays only ever make things later, and nothing overtakes.
class StreamLink {
 public:
    /// What the host's port hears and says, at that time; an empty reception where it opened the port.
    using Record = std::function<void(Direction, Stamp, std::span<const std::uint8_t>)>;

    /// The host talks as for `source`. Throws what stream_sensor() throws.
    StreamLink(const SourceConfig& source, const LidarModel& model, const StreamLinkParams& params, Record record);

    /// The host's port is there from now on.
    void begin(Stamp now) { next_tick_ = now; }
    /// All that happens up to then.
    void advance_to(Stamp until);
    /// A sweep of the model's beams is over at `end`, not before advance_to()'s time. The first passed at `begin`.
    void on_sweep(Stamp begin, Stamp end, std::span<const int> range_mm);

    [[nodiscard]] std::string sensor() const { return sensor_->name(); }

 private:
    struct Parcel {
        Stamp arrival;
        std::vector<std::uint8_t> bytes;
    };
    /// As which the host gets what the sensor says, one in this time.
    struct Pieces {
        std::size_t bytes;
        Duration period;
    };

    void open(Stamp now);
    void serve_host(Stamp now);
    void reply(Stamp now, std::span<const std::uint8_t> bytes);
    [[nodiscard]] Stamp sensor_time(Stamp host) const;
    [[nodiscard]] Duration random_delay(Duration mean);

    StreamLinkParams params_;
    Record record_;
    Random random_;
    Pieces pieces_;
    std::unique_ptr<StreamSensor> sensor_;
    std::unique_ptr<StreamTalk> host_;
    bool open_ = false;
    Stamp next_tick_;
    std::deque<Parcel> to_sensor_;
    std::deque<Parcel> to_host_;
    Stamp last_to_sensor_;
    Stamp last_to_host_;
};

}  // namespace crspf::sim
