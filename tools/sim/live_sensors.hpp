// Sensors that live in real time, each a thread, at the other end of a real port.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <future>
#include <mutex>
#include <span>
#include <stop_token>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/can_frame.hpp"
#include "core/base/time.hpp"
#include "drivers/scip/scip_device.hpp"
#include "platform/files/unique_fd.hpp"
#include "tools/sim/random.hpp"

namespace crspf::sim {

struct LiveUrgParams {
    std::filesystem::path link;  ///< there the host finds the serial line; made anew with each plugging in
    ScipSensor sensor;
    /// Fills what the steps of a revolution read, from step 0 on. [mm] Called by the sensor's thread.
    std::function<void(std::uint64_t revolution, std::span<std::uint32_t> step_mm)> scan;
    Duration reply_delay{1'000'000};  ///< mean of what a reply takes beyond its bytes; never less than nothing
    double clock_drift = 100e-6;      ///< by which the sensor's clock is fast
    std::uint64_t seed = 1;
};

/// A SCIP sensor on a pseudo terminal. Plugged in from the beginning. Its calls may come from any one thread; they
/// return when the thing has happened, and tell the monotonic time of it.
class LiveUrg {
 public:
    explicit LiveUrg(LiveUrgParams params);

    Stamp plug_in();
    Stamp unplug();
    /// Neither hears nor says anything.
    Stamp mute(bool on);
    Stamp switch_laser_off();
    /// What it says waits, and comes in one piece when it may.
    Stamp hold(bool on);
    /// That share of what it says is lost from now on, in pieces.
    Stamp lose(double share);
    /// So many random bytes get in between what it says.
    Stamp garble(std::size_t bytes);

 private:
    struct Parcel {
        Stamp arrival;
        std::vector<std::uint8_t> bytes;
    };

    Stamp in_thread(std::function<void()> action);
    void run(const std::stop_token& stop);
    void open_line();
    void close_line();
    void listen(Stamp now);
    void turn(Stamp now);
    void say(Stamp now, std::span<const std::uint8_t> bytes);
    void deliver(Stamp now);
    [[nodiscard]] Stamp device_time(Stamp host) const;

    LiveUrgParams params_;
    Random random_;
    ScipDevice device_;
    UniqueFd line_;  ///< our end; invalid: unplugged
    bool mute_ = false;
    bool held_ = false;
    double lost_share_ = 0.0;
    Stamp power_on_;
    std::uint64_t revolution_ = 0;  ///< the present one, since power-on
    std::deque<Parcel> to_host_;

    std::mutex mutex_;  ///< of actions_
    std::vector<std::packaged_task<Stamp()>> actions_;
    std::jthread thread_;  ///< last: it uses all of the others
};

/// Sends a datagram each period to a port of this machine, from 127.0.0.1.
class LiveVelodyne {
 public:
    using Packet = std::function<std::vector<std::uint8_t>(std::uint64_t index)>;

    LiveVelodyne(std::uint16_t port, Duration period, Packet packet);

    [[nodiscard]] std::uint64_t sent() const { return sent_; }

 private:
    std::atomic<std::uint64_t> sent_ = 0;
    std::jthread thread_;
};

/// Sends frames each period into a pair of sockets that stands in for a bus.
class LiveCanNode {
 public:
    using Frames = std::function<std::vector<CanFrame>(std::uint64_t tick)>;

    LiveCanNode(Duration period, Frames frames);

    /// The other end, for SocketCan. Once.
    [[nodiscard]] UniqueFd take_bus() { return std::move(bus_); }

 private:
    UniqueFd bus_;
    UniqueFd node_;
    std::jthread thread_;
};

}  // namespace crspf::sim
