#include "platform/service/motion_sender.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <ctime>
#include <string>

#include "platform/files/input_error.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "platform/linux/socket_options.hpp"

namespace crspf {

namespace {

bool is_motion(const MotionSample& sample) {
    const Pose2& P = sample.P_previous_base;
    return std::isfinite(P.x_m) && std::isfinite(P.y_m) && std::isfinite(P.theta_rad) &&
           std::isfinite(sample.translation_variance_m2) && sample.translation_variance_m2 >= 0.0 &&
           std::isfinite(sample.rotation_variance_rad2) && sample.rotation_variance_rad2 >= 0.0;
}

}  // namespace

MotionSender::MotionSender(std::uint32_t address, std::uint16_t port, std::uint32_t session)
    : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)), address_(address), port_(port) {
    if (!socket_.valid()) {
        throw InputError(std::string("a UDP socket: ") + ::strerrordesc_np(errno) +
                         "; the motion cannot be told to crspfd");
    }
    sum_.session = session;
}

std::uint32_t MotionSender::new_session() {
    const std::int64_t now_ns = clock_now(CLOCK_REALTIME).ns;
    return static_cast<std::uint32_t>(now_ns ^ (now_ns >> 32));
}

void MotionSender::send(const MotionSample& sample) {
    if (!is_motion(sample)) {
        ++counters_.refused;
        return;
    }
    sum_.blind = sample.blind;
    sum_.P_odom_base = sum_.P_odom_base * sample.P_previous_base;
    sum_.translation_variance_m2 += sample.translation_variance_m2;
    sum_.rotation_variance_rad2 += sample.rotation_variance_rad2;
    ++sum_.sequence;
    sum_.age = std::max(monotonic_now() - sample.stamp, Duration{});
    std::array<std::uint8_t, kMotionBytes> bytes{};
    encode(sum_, bytes);
    const sockaddr_in to = socket_address(address_, port_);
    const ssize_t sent = ::sendto(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL, any_address(to), sizeof(to));
    ++(sent == static_cast<ssize_t>(bytes.size()) ? counters_.sent : counters_.unsent);
}

}  // namespace crspf
