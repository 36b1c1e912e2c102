#include "tools/sim/live_sensors.hpp"

#include <fcntl.h>
#include <linux/can.h>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <iterator>
#include <system_error>
#include <utility>

#include "platform/linux/monotonic_clock.hpp"
#include "platform/linux/socket_options.hpp"

namespace crspf::sim {
namespace {

constexpr std::size_t kReplyBytes = 16384;  // more than any reply
constexpr std::size_t kChunkBytes = 512;
constexpr Duration kPatience{2'000'000};  // the sensor's thread looks round this often

void must(bool done, const char* what) {
    if (!done) {
        throw std::system_error(errno, std::generic_category(), what);
    }
}

/// Calls `action(index)` each period until it is to stop.
template <typename Action>
void each_period(const std::stop_token& stop, Duration period, Action action) {
    const Stamp begin = monotonic_now();
    for (std::int64_t index = 0; !stop.stop_requested(); ++index) {
        sleep_until(begin + Duration{index * period.ns});
        action(static_cast<std::uint64_t>(index));
    }
}

}  // namespace

LiveUrg::LiveUrg(LiveUrgParams params)
    : params_(std::move(params)), random_(params_.seed, RandomStream::kLiveLine), device_({.sensor = params_.sensor}) {
    open_line();
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

Stamp LiveUrg::plug_in() {
    return in_thread([this] { open_line(); });
}

Stamp LiveUrg::unplug() {
    return in_thread([this] { close_line(); });
}

Stamp LiveUrg::mute(bool on) {
    return in_thread([this, on] {
        mute_ = on;
        to_host_.clear();
    });
}

Stamp LiveUrg::switch_laser_off() {
    return in_thread([this] { device_.switch_laser_off(); });
}

Stamp LiveUrg::hold(bool on) {
    return in_thread([this, on] { held_ = on; });
}

Stamp LiveUrg::lose(double share) {
    return in_thread([this, share] { lost_share_ = share; });
}

Stamp LiveUrg::garble(std::size_t bytes) {
    return in_thread([this, bytes] {
        Parcel junk{monotonic_now(), std::vector<std::uint8_t>(bytes)};
        std::generate(junk.bytes.begin(), junk.bytes.end(),
                      [this] { return static_cast<std::uint8_t>(random_.next()); });
        to_host_.push_front(std::move(junk));
    });
}

Stamp LiveUrg::in_thread(std::function<void()> action) {
    std::packaged_task<Stamp()> task([action = std::move(action)] {
        action();
        return monotonic_now();
    });
    std::future<Stamp> done = task.get_future();
    {
        const std::lock_guard lock(mutex_);
        actions_.push_back(std::move(task));
    }
    return done.get();
}

void LiveUrg::run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        std::vector<std::packaged_task<Stamp()>> actions;
        {
            const std::lock_guard lock(mutex_);
            actions.swap(actions_);
        }
        for (std::packaged_task<Stamp()>& action : actions) {
            action();
        }
        const Stamp now = monotonic_now();
        const short events = line_.valid() ? wait_for(line_.get(), POLLIN, kPatience) : short{POLLHUP};
        if ((events & POLLHUP) != 0) {
            // Nobody holds the other end: what is said then is lost, as on a USB line.
            to_host_.clear();
            sleep_until(now + kPatience);
        } else if (events != 0) {
            listen(monotonic_now());
        }
        if (line_.valid()) {
            turn(monotonic_now());
            deliver(monotonic_now());
        }
    }
}

void LiveUrg::open_line() {
    line_ = UniqueFd(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    must(line_.valid() && ::grantpt(line_.get()) == 0 && ::unlockpt(line_.get()) == 0, "pseudo terminal");
    // Raw before the host makes it so: an echo would be heard as commands.
    termios settings{};
    must(::tcgetattr(line_.get(), &settings) == 0, "pseudo terminal");
    ::cfmakeraw(&settings);
    must(::tcsetattr(line_.get(), TCSANOW, &settings) == 0, "pseudo terminal");
    power_on_ = monotonic_now();
    device_.power_on({});
    revolution_ = 0;
    std::filesystem::remove(params_.link);
    std::filesystem::create_symlink(::ptsname(line_.get()), params_.link);
}

void LiveUrg::close_line() {
    std::filesystem::remove(params_.link);
    line_ = UniqueFd();
    to_host_.clear();
}

Stamp LiveUrg::device_time(Stamp host) const {
    const std::int64_t since_ns = (host - power_on_).ns;
    return {since_ns + static_cast<std::int64_t>(static_cast<double>(since_ns) * params_.clock_drift)};
}

void LiveUrg::listen(Stamp now) {
    std::array<std::uint8_t, 256> request{};
    const ssize_t got = ::read(line_.get(), request.data(), request.size());
    if (got <= 0 || mute_) {
        return;
    }
    std::array<std::uint8_t, kReplyBytes> buffer{};
    ByteWriter out(buffer);
    device_.on_bytes(std::span(request).first(static_cast<std::size_t>(got)), device_time(now), out);
    say(now, out.written());
}

void LiveUrg::turn(Stamp now) {
    const ScipSensor& sensor = params_.sensor;
    for (;;) {
        const double begin_s = static_cast<double>(revolution_) * sensor.period_s();
        const Stamp begin = power_on_ + Duration::from_seconds(begin_s);
        const Stamp end = begin + Duration::from_seconds(sensor.amax * sensor.step_s());
        if (now < end) {
            return;
        }
        std::vector<std::uint32_t> step_mm(sensor.amax + 1, 0);
        params_.scan(revolution_, step_mm);
        std::array<std::uint8_t, kReplyBytes> buffer{};
        ByteWriter out(buffer);
        device_.on_revolution(device_time(begin), step_mm, {}, out);
        if (!mute_) {
            say(end, out.written());
        }
        ++revolution_;
    }
}

void LiveUrg::say(Stamp now, std::span<const std::uint8_t> bytes) {
    const Duration delay{
        static_cast<std::int64_t>(static_cast<double>(params_.reply_delay.ns) * random_.exponential())};
    const Stamp arrival = to_host_.empty() ? now + delay : std::max(now + delay, to_host_.back().arrival);
    for (std::size_t at = 0; at < bytes.size(); at += kChunkBytes) {
        const std::span<const std::uint8_t> piece = bytes.subspan(at, std::min(kChunkBytes, bytes.size() - at));
        if (random_.uniform() >= lost_share_) {
            to_host_.push_back({arrival, {piece.begin(), piece.end()}});
        }
    }
}

void LiveUrg::deliver(Stamp now) {
    while (!held_ && !to_host_.empty() && to_host_.front().arrival <= now) {
        std::vector<std::uint8_t>& bytes = to_host_.front().bytes;
        const ssize_t written = ::write(line_.get(), bytes.data(), bytes.size());
        if (written < static_cast<ssize_t>(bytes.size())) {
            bytes.erase(bytes.begin(), bytes.begin() + std::max<ssize_t>(written, 0));
            return;  // the host has to read first
        }
        to_host_.pop_front();
    }
}

LiveVelodyne::LiveVelodyne(std::uint16_t port, Duration period, Packet packet)
    : thread_([this, port, period, packet = std::move(packet)](const std::stop_token& stop) {
          const UniqueFd socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
          const sockaddr_in to = socket_address(0x7F000001, port);
          each_period(stop, period, [&](std::uint64_t index) {
              const std::vector<std::uint8_t> bytes = packet(index);
              if (::sendto(socket.get(), bytes.data(), bytes.size(), 0, any_address(to), sizeof(to)) >= 0) {
                  ++sent_;
              }
          });
      }) {}

LiveCanNode::LiveCanNode(Duration period, Frames frames) {
    std::array<int, 2> ends{};
    must(::socketpair(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()) == 0, "socket pair");
    bus_ = UniqueFd(ends[0]);
    node_ = UniqueFd(ends[1]);
    thread_ = std::jthread([this, period, frames = std::move(frames)](const std::stop_token& stop) {
        each_period(stop, period, [&](std::uint64_t tick) {
            for (const CanFrame& frame : frames(tick)) {
                canfd_frame raw{};  // of a classic frame the first CAN_MTU bytes
                raw.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0U);
                raw.len = frame.length;
                std::copy_n(frame.data.begin(), std::min<std::size_t>(frame.length, CAN_MAX_DLEN),
                            std::begin(raw.data));
                // A full bus loses it.
                [[maybe_unused]] const ssize_t written = ::send(node_.get(), &raw, CAN_MTU, MSG_NOSIGNAL);
            }
        });
    });
}

}  // namespace crspf::sim
