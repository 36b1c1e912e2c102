#include "tools/sim/scip_link.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "core/base/trig.hpp"
#include "platform/files/input_error.hpp"

namespace crspf::sim {
namespace {

constexpr std::size_t kReplyBytes = 16384;    // more than any reply
constexpr Duration kTick{5'000'000};          // the host looks at the time this often
constexpr Duration kTransfer{300'000};        // to the host, at least
constexpr std::size_t kChunkBytes = 512;      // the host gets replies in pieces, as from USB ...
constexpr Duration kChunk{500'000};           // ... one in this time
constexpr double kDistanceMax_mm = 65'000.0;  // a UST's codes begin at 65533

std::uint32_t rounded(double value) {
    return static_cast<std::uint32_t>(std::floor(value + 0.5));
}

}  // namespace

ScipSensor scip_sensor_of(const LidarModel& model) {
    std::string_view name;
    if (model.name == "urg") {
        name = "URG-04LX-UG01(simulated)";
    } else if (model.name == "scan270") {
        name = "UST-10LX(simulated)";
    } else {
        throw InputError("--lidar " + model.name + ": captures hold urg, scan270 or velodyne");
    }
    if (model.range_max_m * 1000.0 > kDistanceMax_mm) {
        throw InputError("--max-range: this sensor's protocol counts to 65 m; give less");
    }
    ScipSensor sensor;
    std::copy(name.begin(), name.end(), sensor.model.begin());
    sensor.dmin_mm = rounded(model.range_min_m * 1000.0);
    sensor.dmax_mm = rounded(model.range_max_m * 1000.0);
    sensor.ares = rounded(2.0 * kPi / model.increment_rad);
    sensor.amin = model.name == "urg" ? 44 : 0;
    sensor.amax = sensor.amin + model.beams - 1;
    sensor.afrt = sensor.amin + rounded(-model.angle_min_rad / model.increment_rad);
    sensor.scan_rpm = rounded(60.0 / model.revolution_s);
    sensor.family = model.name == "urg" ? ScipFamily::kUrg : ScipFamily::kUst;
    return sensor;
}

ScipLink::ScipLink(const ScipLinkParams& params, Record record)
    : params_(params),
      record_(std::move(record)),
      random_(params.seed, RandomStream::kScipLink),
      device_({.sensor = params.sensor, .starts_in_scip1 = false}),
      session_(ScipParams{}) {
    device_.power_on({});
}

Stamp ScipLink::device_time(Stamp host) const {
    const std::int64_t since_ns = (host - params_.power_on).ns;
    return {since_ns + static_cast<std::int64_t>(static_cast<double>(since_ns) * params_.clock_drift)};
}

Duration ScipLink::random_delay(Duration mean) {
    return {static_cast<std::int64_t>(static_cast<double>(mean.ns) * random_.exponential())};
}

void ScipLink::advance_to(Stamp until) {
    for (;;) {
        const Stamp at_device = to_device_.empty() ? next_tick_ : to_device_.front().arrival;
        const Stamp at_host = to_host_.empty() ? next_tick_ : to_host_.front().arrival;
        const Stamp now = std::min({next_tick_, at_device, at_host});
        if (now > until) {
            return;
        }
        if (!to_device_.empty() && at_device == now) {
            const Parcel request = std::move(to_device_.front());
            to_device_.pop_front();
            std::array<std::uint8_t, kReplyBytes> buffer{};
            ByteWriter out(buffer);
            device_.on_bytes(request.bytes, device_time(now), out);
            reply(now, out.written());
        } else if (!to_host_.empty() && at_host == now) {
            const Parcel piece = std::move(to_host_.front());
            to_host_.pop_front();
            record_(Direction::kReceived, now, piece.bytes);
            session_.on_bytes(piece.bytes, now, [](const Scan&) {});
            serve_host(now);
        } else {
            next_tick_ = next_tick_ + kTick;
            session_.on_time(now);
            serve_host(now);
        }
    }
}

void ScipLink::serve_host(Stamp now) {
    if (session_.wants_port()) {
        record_(Direction::kReceived, now, {});
        session_.on_open(now);
    }
    if (session_.to_send().empty()) {
        return;
    }
    const Bytes request = session_.to_send();
    record_(Direction::kSent, now, request);
    last_to_device_ = std::max(last_to_device_, now + random_delay(params_.request_delay));
    to_device_.push_back({last_to_device_, {request.begin(), request.end()}});
    session_.sent(now);
}

void ScipLink::reply(Stamp now, std::span<const std::uint8_t> bytes) {
    const Stamp begin = now + kTransfer;
    last_to_host_ = std::max(last_to_host_, Stamp{begin.ns + random_delay(params_.reply_delay).ns});
    for (std::size_t at = 0; at < bytes.size(); at += kChunkBytes) {
        const std::span<const std::uint8_t> piece = bytes.subspan(at, std::min(kChunkBytes, bytes.size() - at));
        to_host_.push_back({last_to_host_, {piece.begin(), piece.end()}});
        last_to_host_ = last_to_host_ + kChunk;
    }
}

void ScipLink::on_sweep(Stamp begin, Stamp end, std::span<const int> range_mm) {
    const ScipSensor& sensor = params_.sensor;
    std::vector<std::uint32_t> steps(sensor.amin, 0);
    steps.insert(steps.end(), range_mm.begin(), range_mm.end());
    const Stamp step0 = begin - Duration::from_seconds(sensor.amin * sensor.step_s());
    std::array<std::uint8_t, kReplyBytes> buffer{};
    ByteWriter out(buffer);
    device_.on_revolution(device_time(step0), steps, {}, out);
    reply(end, out.written());
}

}  // namespace crspf::sim
