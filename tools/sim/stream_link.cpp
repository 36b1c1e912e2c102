#include "tools/sim/stream_link.hpp"

#include <algorithm>
#include <utility>

#include "platform/service/sample_sink.hpp"

namespace crspf::sim {
namespace {

constexpr Duration kTick{5'000'000};     // the host looks at the time this often
constexpr Duration kTransfer{300'000};   // to the host, at least
constexpr std::size_t kUsbBytes = 512;   // of a piece ...
constexpr Duration kUsbPiece{500'000};   // ... and one comes in this time
constexpr std::size_t kTcpBytes = 1448;  // likewise,
constexpr Duration kTcpPiece{120'000};   // at 100 Mbit/s

/// For a host that talks and does not look.
class NoSamples final : public SampleSink {
 public:
    void on_scan(const Scan& /*scan*/) override {}
    void on_cloud(const Cloud& /*cloud*/) override {}
    void on_wheel(const DifferentialSample& /*sample*/) override {}
    void on_wheel(const AckermannSample& /*sample*/) override {}
    void on_imu(const ImuSample& /*sample*/) override {}
    void on_motion(const MotionSample& /*sample*/) override {}
};

}  // namespace

StreamLink::StreamLink(const SourceConfig& source, const LidarModel& model, const StreamLinkParams& params,
                       Record record)
    : params_(params),
      record_(std::move(record)),
      random_(params.seed, RandomStream::kStreamLink),
      pieces_(source.port.kind == PortConfig::Kind::kTcp ? Pieces{kTcpBytes, kTcpPiece} : Pieces{kUsbBytes, kUsbPiece}),
      sensor_(stream_sensor(source, model)),
      host_(talk_to(source, LidarParams{})) {}

Stamp StreamLink::sensor_time(Stamp host) const {
    const std::int64_t since_ns = (host - params_.power_on).ns;
    return {since_ns + static_cast<std::int64_t>(static_cast<double>(since_ns) * params_.clock_drift)};
}

Duration StreamLink::random_delay(Duration mean) {
    return {static_cast<std::int64_t>(static_cast<double>(mean.ns) * random_.exponential())};
}

void StreamLink::advance_to(Stamp until) {
    for (;;) {
        const Stamp at_sensor = to_sensor_.empty() ? next_tick_ : to_sensor_.front().arrival;
        const Stamp at_host = to_host_.empty() ? next_tick_ : to_host_.front().arrival;
        const Stamp now = std::min({next_tick_, at_sensor, at_host});
        if (now > until) {
            return;
        }
        if (!to_sensor_.empty() && at_sensor == now) {
            const Parcel request = std::move(to_sensor_.front());
            to_sensor_.pop_front();
            reply(now, sensor_->on_bytes(request.bytes, sensor_time(now)));
        } else if (!to_host_.empty() && at_host == now) {
            const Parcel piece = std::move(to_host_.front());
            to_host_.pop_front();
            record_(Direction::kReceived, now, piece.bytes);
            NoSamples nowhere;
            host_->on_received(piece.bytes, now, nowhere);
            serve_host(now);
        } else {
            next_tick_ = next_tick_ + kTick;
            if (!std::exchange(open_, true)) {
                open(now);
            }
            host_->on_time(now);
            serve_host(now);
        }
    }
}

void StreamLink::open(Stamp now) {
    record_(Direction::kReceived, now, {});
    sensor_->on_connect();
    host_->on_open(now);
}

void StreamLink::serve_host(Stamp now) {
    for (;;) {
        const StreamWish wish = host_->next_wish(now);
        switch (wish.kind) {
            case StreamWish::Kind::kNothing: return;
            case StreamWish::Kind::kSetBaud: break;  // it is heard at any
            case StreamWish::Kind::kReopen: open(now); break;
            case StreamWish::Kind::kSend:
                record_(Direction::kSent, now, wish.bytes);
                last_to_sensor_ = std::max(last_to_sensor_, now + random_delay(params_.request_delay));
                to_sensor_.push_back({last_to_sensor_, {wish.bytes.begin(), wish.bytes.end()}});
                host_->on_sent(now);
                break;
        }
    }
}

void StreamLink::reply(Stamp now, std::span<const std::uint8_t> bytes) {
    const Stamp begin = now + kTransfer;
    last_to_host_ = std::max(last_to_host_, Stamp{begin.ns + random_delay(params_.reply_delay).ns});
    for (std::size_t at = 0; at < bytes.size(); at += pieces_.bytes) {
        const std::span<const std::uint8_t> piece = bytes.subspan(at, std::min(pieces_.bytes, bytes.size() - at));
        to_host_.push_back({last_to_host_, {piece.begin(), piece.end()}});
        last_to_host_ = last_to_host_ + pieces_.period;
    }
}

void StreamLink::on_sweep(Stamp begin, Stamp end, std::span<const int> range_mm) {
    reply(end, sensor_->on_sweep(sensor_time(begin), sensor_time(end), range_mm));
}

}  // namespace crspf::sim
