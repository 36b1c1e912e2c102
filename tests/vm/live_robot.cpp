// The robot of tests/support/live_robot.hpp at the other ends of real ports: a URG on a pseudo terminal; wheels on a
// CAN interface, or, where BASE is udp://127.0.0.1:PORT, their motion as another process would tell it. Does what it is
// told, a word a line: unplug, plug-in, mute, unmute, garble. Ends with its input.
//
// usage: live_robot TTY BASE              prints `ok` for each word when it is done
//        live_robot --config TTY BASE     the configuration of a service for it
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "platform/linux/monotonic_clock.hpp"
#include "platform/linux/socketcan.hpp"
#include "platform/service/motion_sender.hpp"
#include "tests/support/live_robot.hpp"
#include "tools/sim/live_sensors.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

constexpr Duration kWheelPeriod{20'000'000};

void turn_wheels(const std::stop_token& stop, const std::string& interface, Stamp begin) {
    SocketCan bus(interface, {});
    for (std::int64_t tick = 0; !stop.stop_requested(); ++tick) {
        sleep_until(begin + Duration{tick * kWheelPeriod.ns});
        CanFrame heard;
        while (bus.receive(heard, {}).status == IoStatus::kOk) {
        }
        for (const CanFrame& frame : wheels(static_cast<std::uint64_t>(tick))) {
            static_cast<void>(bus.send(frame, monotonic_now() + kWheelPeriod));  // a bus that is down loses it
        }
    }
}

void tell_motion(const std::stop_token& stop, std::uint16_t port, Stamp begin) {
    constexpr std::uint32_t kLoopback = 0x7F000001;
    MotionSender sender(kLoopback, port, MotionSender::new_session());
    Pose2 before = pose_at(0.0);
    for (std::int64_t tick = 0; !stop.stop_requested(); ++tick) {
        const Stamp stamp = begin + Duration{tick * kWheelPeriod.ns};
        sleep_until(stamp);
        const Pose2 now = pose_at((stamp - begin).seconds());
        sender.send({.stamp = stamp, .P_previous_base = inverse(before) * now});
        before = now;
    }
}

/// Of udp://127.0.0.1:PORT; none: it is the name of an interface.
std::optional<std::uint16_t> port_of(std::string_view base) {
    std::uint16_t port = 0;
    if (!base.starts_with(kMotionAddress)) {
        return std::nullopt;
    }
    base.remove_prefix(kMotionAddress.size());
    const auto [end, error] = std::from_chars(base.data(), base.data() + base.size(), port);
    return error == std::errc{} && end == base.data() + base.size() ? std::optional(port) : std::nullopt;
}

bool obey(sim::LiveUrg& urg, std::string_view word) {
    constexpr std::size_t kGarbage = 5000;
    if (word == "unplug") {
        urg.unplug();
    } else if (word == "plug-in") {
        urg.plug_in();
    } else if (word == "mute" || word == "unmute") {
        urg.mute(word == "mute");
    } else if (word == "garble") {
        urg.garble(kGarbage);
    } else {
        return false;
    }
    return true;
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<std::string> arguments(argv + 1, argv + argc);
    if (arguments.size() == 3 && arguments[0] == "--config") {
        std::fputs(live_robot_toml(arguments[1], arguments[2]).c_str(), stdout);
        return 0;
    }
    if (arguments.size() != 2) {
        std::fputs("usage: live_robot [--config] TTY BASE\n", stderr);
        return 2;
    }
    const Stamp begin = monotonic_now();
    // Called at a revolution's end. The robot drives on while its lidar is unplugged.
    const auto see = [begin](std::uint64_t /*revolution*/, std::span<std::uint32_t> step_mm) {
        revolution_at((monotonic_now() - begin).seconds() - urg_04lx().period_s(), step_mm);
    };
    sim::LiveUrg urg({.link = arguments[0], .sensor = urg_04lx(), .scan = see});
    const std::jthread base_thread([&arguments, begin](const std::stop_token& stop) {
        if (const auto port = port_of(arguments[1])) {
            tell_motion(stop, *port, begin);
        } else {
            turn_wheels(stop, arguments[1], begin);
        }
    });
    for (std::string word; std::getline(std::cin, word);) {
        std::puts(obey(urg, word) ? "ok" : "unknown word");
        std::fflush(stdout);
    }
    return 0;
}
