// A session and a simulated sensor at the two ends of a line.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <deque>
#include <utility>
#include <vector>

#include "core/base/rng.hpp"
#include "drivers/scip/scip_device.hpp"
#include "drivers/scip/scip_session.hpp"

namespace crspf::test {

inline ScipSensor urg_04lx() {
    ScipSensor sensor;
    std::memcpy(sensor.model.data(), "URG-04LX", 8);
    sensor.dmin_mm = 20;
    sensor.dmax_mm = 5600;
    sensor.ares = 1024;
    sensor.amin = 44;
    sensor.amax = 725;
    sensor.afrt = 384;
    sensor.scan_rpm = 600;
    return sensor;
}

/// What a recorder beside the session would have written.
struct ScipTape {
    enum class Event : std::uint8_t { kOpened, kSent, kReceived };
    Event event;
    Stamp stamp;
    std::vector<std::uint8_t> bytes;
};

/// Advances in steps of 1 ms. The sensor's clock runs `drift` fast; what it sends arrives up to `jitter_s` late.
struct ScipBench {
    explicit ScipBench(const ScipDeviceParams& device_params, const ScipParams& params)
        : device(device_params), session(params), sensor(device_params.sensor), serial(params.baud != 0) {
        ranges.assign(sensor.amax + 1, 0);
        for (std::uint32_t i = 0; i < ranges.size(); ++i) {
            ranges[i] = 500 + 3 * i;
        }
    }

    template <typename Visit>
    void run(double seconds, Visit&& visit) {
        const std::int64_t end_ns = now.ns + Duration::from_seconds(seconds).ns;
        while (now.ns < end_ns) {
            now.ns += 1'000'000;
            step(visit);
        }
    }
    void run(double seconds) {
        run(seconds, [](const Scan&) {});
    }

    template <typename Visit>
    void step(Visit&& visit) {
        session.on_time(now);
        if (session.wants_port()) {
            ++openings;
            if (plugged) {
                session.on_open(now);
                tape.push_back({ScipTape::Event::kOpened, now, {}});
            } else {
                session.on_close(now);
            }
        }
        const Stamp device_now = device_time(now);
        if (plugged) {
            std::array<std::uint8_t, 16384> buffer{};
            ByteWriter out(buffer);
            // At the wrong bit rate neither end understands the other.
            const std::uint32_t baud_before = device.baud();
            const bool understood = !serial || session.baud() == baud_before;
            std::vector<std::uint8_t> request(session.to_send().begin(), session.to_send().end());
            session.sent(now);
            if (!request.empty()) {
                tape.push_back({ScipTape::Event::kSent, now, request});
            }
            if (!understood) {
                std::fill(request.begin(), request.end(), std::uint8_t{0xF0});
            }
            device.on_bytes(request, device_now, out);
            const std::int64_t turn = device_now.ns / period_ns();
            if (turn != turn_ && !mute) {
                device.on_revolution({turn_ * period_ns()}, ranges, {}, out);
            }
            turn_ = turn;
            std::vector<std::uint8_t> reply(out.written().begin(), out.written().end());
            if (!understood) {
                std::fill(reply.begin(), reply.end(), std::uint8_t{0xF8});
            }
            if (!reply.empty()) {
                const double late_s = -jitter_s * std::log(0.5 * (1.0 - rng.symmetric()));
                // Not before what was sent before.
                last_arrival = std::max(last_arrival, now + Duration::from_seconds(late_s));
                on_the_way_.emplace_back(last_arrival, reply);
            }
        } else {
            session.sent(now);
            on_the_way_.clear();
        }
        while (!on_the_way_.empty() && on_the_way_.front().first <= now) {
            const auto [arrival, reply] = on_the_way_.front();
            on_the_way_.pop_front();
            if (taping) {
                tape.push_back({ScipTape::Event::kReceived, arrival, reply});
            }
            session.on_bytes(reply, arrival, visit);
        }
    }

    [[nodiscard]] std::int64_t period_ns() const { return 60'000'000'000 / sensor.scan_rpm; }
    [[nodiscard]] Stamp device_time(Stamp host) const {
        return {host.ns + static_cast<std::int64_t>(static_cast<double>(host.ns) * drift)};
    }

    ScipDevice device;
    ScipSession session;
    ScipSensor sensor;
    bool serial;
    std::vector<std::uint32_t> ranges;
    Stamp now;
    Stamp last_arrival;
    double drift = 0.0;
    double jitter_s = 0.0;
    bool plugged = true;
    bool mute = false;
    bool taping = false;  ///< what is received goes to the tape, too
    int openings = 0;
    std::vector<ScipTape> tape;
    Rng rng{7};

 private:
    std::int64_t turn_ = 0;
    std::deque<std::pair<Stamp, std::vector<std::uint8_t>>> on_the_way_;
};

}  // namespace crspf::test
