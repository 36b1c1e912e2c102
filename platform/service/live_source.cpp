#include "platform/service/live_source.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/ldrobot/ld06_codec.hpp"
#include "platform/capture/frames.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "platform/linux/serial_port.hpp"
#include "platform/linux/socketcan.hpp"
#include "platform/linux/tcp_client.hpp"
#include "platform/linux/udp_receiver.hpp"
#include "platform/service/can_input.hpp"
#include "platform/service/motion_input.hpp"
#include "platform/service/stream_talk.hpp"
#include "platform/service/velodyne_input.hpp"

namespace crspf {

namespace {

constexpr Duration kTalkStep{10'000'000};   // a conversation has its timeouts
constexpr Duration kIdleStep{100'000'000};  // what only listens has none
constexpr Duration kSendWithin{10'000'000};
constexpr std::uint32_t kBaudOfUsb = 115200;  // any will do

LiveReport closed_report(const SourceConfig& source, int error) {
    LiveReport report;
    report.state.append(source.port_text).append(": ").append(error == 0 ? "not yet open" : ::strerrordesc_np(error));
    return report;
}

LiveReport streaming_report() {
    return {.streaming = true, .state = StateText("streaming"), .counts = {}};
}

LiveReport silent_report(const SourceConfig& source, std::string_view why) {
    LiveReport report;
    report.state.append(source.port_text).append(": ").append(why);
    return report;
}

class LiveStream final : public LiveSource {
 public:
    LiveStream(const SourceConfig& source, const LidarParams& lidar, std::unique_ptr<ByteStream> port)
        : source_(source), port_(std::move(port)), talk_(talk_to(source, lidar)) {}

    void step(Duration wait, SampleSink& samples, TrafficSink& traffic) override {
        talk_->on_time(monotonic_now());
        fulfil_wishes(traffic);
        if (!open_) {
            open(wait, traffic);
            return;
        }
        const Received got = port_->read(buffer_, std::min(wait, kTalkStep));
        if (got.status == IoStatus::kClosed) {
            lose();
        } else if (got.status == IoStatus::kOk) {
            const auto bytes = std::span(buffer_).first(got.bytes);
            traffic.on_traffic(Direction::kReceived, got.stamp, bytes);
            talk_->on_received(bytes, got.stamp, samples);
        }
    }

    [[nodiscard]] LiveReport report() const override {
        LiveReport report = open_ ? talk_report() : closed_report(source_, port_->error());
        report.counts = talk_->counts();
        return report;
    }

 private:
    [[nodiscard]] LiveReport talk_report() const {
        if (talk_->streaming()) {
            LiveReport report = streaming_report();
            const StateText identity = talk_->identity();
            if (!identity.empty()) {
                report.state.append(", ").append(identity.view());
            }
            return report;
        }
        const StateText trouble = talk_->trouble();
        LiveReport report = silent_report(source_, trouble.empty() ? "no answer yet" : "the sensor says: ");
        report.state.append(trouble.view());
        return report;
    }

    void fulfil_wishes(TrafficSink& traffic) {
        for (;;) {
            const Stamp now = monotonic_now();
            const StreamWish wish = talk_->next_wish(now);
            switch (wish.kind) {
                case StreamWish::Kind::kNothing: return;
                case StreamWish::Kind::kReopen:
                    wants_open_ = true;
                    if (std::exchange(open_, false)) {
                        port_->close();
                    }
                    return;
                case StreamWish::Kind::kSetBaud: static_cast<void>(port_->set_baud(wish.baud)); break;
                case StreamWish::Kind::kSend: send(wish.bytes, traffic); break;
            }
        }
    }

    void send(std::span<const std::uint8_t> bytes, TrafficSink& traffic) {
        const Stamp now = monotonic_now();
        const Sent sent = port_->write(bytes);
        traffic.on_traffic(Direction::kSent, now, bytes.first(sent.bytes));
        talk_->on_sent(now);
        if (sent.status == IoStatus::kClosed) {
            lose();
        }
    }

    /// As long as it takes: a port that is not there is no failure of the conversation.
    void open(Duration wait, TrafficSink& traffic) {
        if (!wants_open_) {
            sleep_until(monotonic_now() + std::min(wait, kTalkStep));
            return;
        }
        if (port_->read({}, std::min(wait, kIdleStep)).status == IoStatus::kClosed) {
            return;
        }
        const Stamp now = monotonic_now();
        open_ = true;
        wants_open_ = false;
        traffic.on_traffic(Direction::kReceived, now, {});
        talk_->on_open(now);
    }

    void lose() {
        if (std::exchange(open_, false)) {
            talk_->on_close(monotonic_now());
        }
    }

    SourceConfig source_;
    std::unique_ptr<ByteStream> port_;
    std::unique_ptr<StreamTalk> talk_;
    bool open_ = false;
    bool wants_open_ = true;
    std::array<std::uint8_t, 4096> buffer_{};
};

/// A port where datagrams come, and what passes through it.
class LiveDatagrams {
 public:
    LiveDatagrams(SourceConfig source, std::unique_ptr<DatagramSource> port)
        : source_(std::move(source)), port_(std::move(port)) {}

    /// One datagram, once `traffic` was told of it; its bytes are payload(). None came where its status says so.
    Datagram receive(Duration wait, TrafficSink& traffic) {
        const Datagram datagram = port_->receive(buffer_, std::min(wait, kIdleStep));
        heard_ = heard_ || datagram.io.status == IoStatus::kOk;
        closed_ = datagram.io.status == IoStatus::kClosed;
        if (datagram.io.status != IoStatus::kOk) {
            return datagram;
        }
        payload_ = std::span(buffer_).first(datagram.io.bytes);
        frame_.clear();
        const bool fits = append_udp_frame(frame_, {.source_address = datagram.source_address,
                                                    .destination_address = source_.port.address,
                                                    .source_port = datagram.source_port,
                                                    .destination_port = source_.port.port,
                                                    .payload = payload_});
        if (fits) {
            traffic.on_traffic(Direction::kReceived, datagram.io.stamp, frame_);
        }
        return datagram;
    }
    [[nodiscard]] std::span<const std::uint8_t> payload() const { return payload_; }

    /// @param silent what to say before the first datagram
    [[nodiscard]] LiveReport report(std::string_view silent) const {
        return closed_  ? closed_report(source_, port_->error())
               : heard_ ? streaming_report()
                        : silent_report(source_, silent);
    }

 private:
    SourceConfig source_;
    std::unique_ptr<DatagramSource> port_;
    bool heard_ = false;
    bool closed_ = true;
    std::array<std::uint8_t, 2048> buffer_{};
    std::span<const std::uint8_t> payload_;
    std::vector<std::uint8_t> frame_;
};

class LiveVelodyne final : public LiveSource {
 public:
    LiveVelodyne(const SourceConfig& source, const LidarParams& lidar, std::unique_ptr<DatagramSource> port)
        : silent_("nothing yet from " + source.velodyne_address),
          port_(source, std::move(port)),
          input_(std::make_unique<VelodyneInput>(source, lidar)) {}

    void step(Duration wait, SampleSink& samples, TrafficSink& traffic) override {
        const Datagram datagram = port_.receive(wait, traffic);
        if (datagram.io.status == IoStatus::kOk) {
            input_->on_data(port_.payload(), datagram.source_address, datagram.io.stamp, samples);
        }
    }

    [[nodiscard]] LiveReport report() const override {
        LiveReport report = port_.report(silent_);
        report.counts = input_->counts();
        return report;
    }

 private:
    std::string silent_;
    LiveDatagrams port_;
    std::unique_ptr<VelodyneInput> input_;
};

/// "1.2 s"
void append_seconds(StateText& text, Duration duration) {
    constexpr std::int64_t kTenth_ns = 100'000'000;
    std::array<char, 24> digits{};
    const std::int64_t tenths = duration.ns / kTenth_ns;
    const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), tenths / 10);
    const char tenth = static_cast<char>('0' + tenths % 10);
    text.append({digits.data(), end}).append(".").append({&tenth, 1}).append(" s");
}

class LiveMotion final : public LiveSource {
 public:
    LiveMotion(const SourceConfig& source, std::unique_ptr<DatagramSource> port) : port_(source, std::move(port)) {}

    void step(Duration wait, SampleSink& samples, TrafficSink& traffic) override {
        const Datagram datagram = port_.receive(wait, traffic);
        if (datagram.io.status == IoStatus::kOk) {
            input_.on_data(port_.payload(), datagram.io.stamp, samples);
        }
    }

    [[nodiscard]] LiveReport report() const override {
        LiveReport report = port_.report("nothing yet; does the odometry's process run?");
        report.counts = input_.counts();
        report.blind = std::max(input_.blind(monotonic_now()), Duration{});
        if (report.streaming && report.blind > Duration{}) {
            report.state = StateText("blind for ");
            append_seconds(report.state, report.blind);
            report.state.append("; its motion is a prediction");
        }
        return report;
    }

 private:
    LiveDatagrams port_;
    MotionInput input_;
};

class LiveCan final : public LiveSource {
 public:
    LiveCan(const SourceConfig& source, std::unique_ptr<CanBus> port)
        : source_(source), port_(std::move(port)), input_(source.can) {}

    void step(Duration wait, SampleSink& samples, TrafficSink& traffic) override {
        CanFrame frame;
        const Received got = port_->receive(frame, std::min(wait, kIdleStep));
        heard_ = heard_ || got.status == IoStatus::kOk;
        closed_ = got.status == IoStatus::kClosed;
        if (got.status == IoStatus::kOk) {
            tell(Direction::kReceived, got.stamp, frame, traffic);
            if (const auto answer = input_.on_frame(frame, got.stamp, samples)) {
                const Stamp now = monotonic_now();
                if (port_->send(*answer, now + kSendWithin) == IoStatus::kOk) {
                    tell(Direction::kSent, now, *answer, traffic);
                }
            }
        }
        input_.on_time(monotonic_now());
    }

    [[nodiscard]] LiveReport report() const override {
        const CanHealth& health = port_->health();
        LiveReport report = closed_ ? closed_report(source_, port_->error())
                            : health.state == CanState::kBusOff
                                ? silent_report(source_, "bus off; look at wires and bit rate")
                            : heard_ ? streaming_report()
                                     : silent_report(source_, "no frame yet");
        report.counts = input_.counts();
        report.counts.append({{"bus_offs", health.bus_offs},
                              {"bus_errors", health.bus_errors},
                              {"dropped", health.dropped},
                              {"interface_downs", health.interface_downs}});
        return report;
    }

 private:
    void tell(Direction direction, Stamp stamp, const CanFrame& frame, TrafficSink& traffic) {
        bytes_.clear();
        if (append_can_frame(bytes_, frame)) {
            traffic.on_traffic(direction, stamp, bytes_);
        }
    }

    SourceConfig source_;
    std::unique_ptr<CanBus> port_;
    CanInput input_;
    bool heard_ = false;
    bool closed_ = true;
    std::vector<std::uint8_t> bytes_;
};

}  // namespace

LinkKind link_of(SourceDriver driver) {
    switch (driver) {
        case SourceDriver::kVelodyne:
        case SourceDriver::kMotion: return LinkKind::kEthernet;
        case SourceDriver::kCan: return LinkKind::kCan;
        case SourceDriver::kScip:
        case SourceDriver::kSick:
        case SourceDriver::kLms2xx:
        case SourceDriver::kLd06: break;
    }
    return LinkKind::kStream;
}

std::unique_ptr<LiveSource> open_live(const SourceConfig& source, const LidarParams& lidar) {
    const PortConfig& port = source.port;
    switch (port.kind) {
        case PortConfig::Kind::kUdp:
            return open_live(
                source, lidar,
                std::make_unique<UdpReceiver>(UdpReceiverParams{
                    .own_address = port.address,
                    .port = port.port,
                    .source_address = source.driver == SourceDriver::kVelodyne ? source.velodyne.source_address : 0}));
        case PortConfig::Kind::kCan:
            return open_live(source, lidar, std::make_unique<SocketCan>(port.device, std::vector<CanFilter>{}));
        case PortConfig::Kind::kTcp:
            return open_live(source, lidar, std::make_unique<TcpClient>(port.address, port.port));
        case PortConfig::Kind::kSerial: break;
    }
    const std::uint32_t baud = source.driver == SourceDriver::kScip && source.scip.baud != 0 ? source.scip.baud
                               : source.driver == SourceDriver::kLd06                        ? kLd06Baud
                                                                                             : kBaudOfUsb;
    return open_live(source, lidar, std::make_unique<SerialPort>(port.device, baud));
}

std::unique_ptr<LiveSource> open_live(const SourceConfig& source, const LidarParams& lidar,
                                      std::unique_ptr<ByteStream> port) {
    return std::make_unique<LiveStream>(source, lidar, std::move(port));
}

std::unique_ptr<LiveSource> open_live(const SourceConfig& source, const LidarParams& lidar,
                                      std::unique_ptr<DatagramSource> port) {
    if (source.driver == SourceDriver::kMotion) {
        return std::make_unique<LiveMotion>(source, std::move(port));
    }
    return std::make_unique<LiveVelodyne>(source, lidar, std::move(port));
}

std::unique_ptr<LiveSource> open_live(const SourceConfig& source, const LidarParams& /*lidar*/,
                                      std::unique_ptr<CanBus> port) {
    return std::make_unique<LiveCan>(source, std::move(port));
}

}  // namespace crspf
