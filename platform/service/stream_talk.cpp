#include "platform/service/stream_talk.hpp"

#include "drivers/scip/scip_session.hpp"
#include "drivers/sick/lms2xx_session.hpp"
#include "drivers/sick/sick_session.hpp"
#include "platform/service/lidar_scans.hpp"

namespace crspf {

namespace {

class ScipTalk final : public StreamTalk {
 public:
    ScipTalk(const ScipParams& params, const LidarParams& lidar) : session_(params), scans_(lidar) {}

    void on_open(Stamp now) override {
        session_.on_open(now);
        line_baud_ = 0;
    }
    void on_close(Stamp now) override { session_.on_close(now); }
    void on_time(Stamp now) override { session_.on_time(now); }
    void on_sent(Stamp now) override { session_.sent(now); }
    void on_received(std::span<const std::uint8_t> bytes, Stamp received, SampleSink& sink) override {
        session_.on_bytes(bytes, received, [&](const Scan& scan) { scans_.deliver(scan, sink); });
    }

    [[nodiscard]] StreamWish next_wish(Stamp /*now*/) override {
        if (session_.wants_port()) {
            return {.kind = StreamWish::Kind::kReopen, .baud = 0, .bytes = {}};
        }
        if (session_.baud() != line_baud_) {
            line_baud_ = session_.baud();
            return {.kind = StreamWish::Kind::kSetBaud, .baud = line_baud_, .bytes = {}};
        }
        if (!session_.to_send().empty()) {
            return {.kind = StreamWish::Kind::kSend, .baud = 0, .bytes = session_.to_send()};
        }
        return {};
    }
    [[nodiscard]] bool streaming() const override { return session_.streaming(); }
    [[nodiscard]] StateText trouble() const override {
        const ScipCounters& c = session_.counters();
        const std::string_view diagnosis = session_.listener().identity().diagnosis.data();
        StateText text;
        if (c.refused + c.trouble > 0) {
            text.append(session_.last_trouble());
            if (!diagnosis.empty()) {
                text.append(" (").append(diagnosis).append(")");
            }
        }
        return text;
    }
    [[nodiscard]] StateText identity() const override {
        const ScipIdentity& identity = session_.listener().identity();
        return StateText(session_.listener().sensor().model.data())
            .append(", serial ")
            .append(identity.serial.data())
            .append(", firmware ")
            .append(identity.firmware.data());
    }
    [[nodiscard]] SourceCounts counts() const override {
        SourceCounts counts = counts_of(session_.listener());
        const ScipCounters& c = session_.counters();
        counts.append({{"silences", c.silences},
                       {"trouble", c.trouble},
                       {"laser_off", c.laser_off},
                       {"timeouts", c.timeouts},
                       {"refused", c.refused},
                       {"failures", c.failures}});
        return counts;
    }

 private:
    ScipSession session_;
    MountedScans scans_;
    std::uint32_t line_baud_ = 0;  ///< 0: as the port opens
};

class SickTalk final : public StreamTalk {
 public:
    SickTalk(const SickParams& params, const LidarParams& lidar) : session_(params), scans_(lidar) {}

    void on_open(Stamp now) override { session_.on_open(now); }
    void on_close(Stamp now) override { session_.on_closed(now); }
    void on_time(Stamp now) override { session_.on_time(now); }
    void on_sent(Stamp /*now*/) override {}
    void on_received(std::span<const std::uint8_t> bytes, Stamp received, SampleSink& sink) override {
        session_.on_bytes(bytes, received, [&](const LmdScandata& data, const SickTiming& timing) {
            scans_.deliver(data, timing, sink);
        });
    }

    [[nodiscard]] StreamWish next_wish(Stamp now) override {
        const SickOutput output = session_.next_output(now);
        switch (output.kind) {
            case SickOutput::Kind::kSend: return {.kind = StreamWish::Kind::kSend, .baud = 0, .bytes = output.bytes};
            case SickOutput::Kind::kReopen: return {.kind = StreamWish::Kind::kReopen, .baud = 0, .bytes = {}};
            case SickOutput::Kind::kNothing: break;
        }
        return {};
    }
    [[nodiscard]] bool streaming() const override { return session_.state() == SickState::kStreaming; }
    [[nodiscard]] StateText trouble() const override {
        return session_.counters().refused > 0 ? StateText(session_.last_refusal().text) : StateText();
    }
    [[nodiscard]] SourceCounts counts() const override {
        SourceCounts counts = counts_of(session_.listener());
        const SickSessionCounters& c = session_.counters();
        counts.append({{"unusable", scans_.unusable()},
                       {"silences", c.silences},
                       {"repeated", c.repeated},
                       {"refused", c.refused},
                       {"reopened", c.reopened}});
        return counts;
    }

 private:
    SickSession session_;
    SickScans scans_;
};

class Lms2xxTalk final : public StreamTalk {
 public:
    Lms2xxTalk(const Lms2xxParams& params, const LidarParams& lidar) : session_(params), scans_(params, lidar) {}

    void on_open(Stamp now) override { session_.on_open(now); }
    void on_close(Stamp now) override { session_.on_closed(now); }
    void on_time(Stamp now) override { session_.on_time(now); }
    void on_sent(Stamp /*now*/) override {}
    void on_received(std::span<const std::uint8_t> bytes, Stamp received, SampleSink& sink) override {
        session_.on_bytes(bytes, received,
                          [&](const Lms2xxScan& raw, Stamp beam0) { scans_.deliver(raw, beam0, sink); });
    }

    [[nodiscard]] StreamWish next_wish(Stamp now) override {
        const Lms2xxOutput output = session_.next_output(now);
        switch (output.kind) {
            case Lms2xxOutput::Kind::kSend: return {.kind = StreamWish::Kind::kSend, .baud = 0, .bytes = output.bytes};
            case Lms2xxOutput::Kind::kReopen: return {.kind = StreamWish::Kind::kReopen, .baud = 0, .bytes = {}};
            case Lms2xxOutput::Kind::kSetBaud:
                return {.kind = StreamWish::Kind::kSetBaud, .baud = output.baud, .bytes = {}};
            case Lms2xxOutput::Kind::kNothing: break;
        }
        return {};
    }
    [[nodiscard]] bool streaming() const override { return session_.state() == Lms2xxState::kStreaming; }
    [[nodiscard]] StateText trouble() const override {
        return session_.counters().refused > 0 ? StateText("the sensor refused a command; is its speed right?")
                                               : StateText();
    }
    [[nodiscard]] SourceCounts counts() const override {
        SourceCounts counts = counts_of(session_.listener());
        const Lms2xxSessionCounters& c = session_.counters();
        counts.append(
            {{"silences", c.silences}, {"repeated", c.repeated}, {"refused", c.refused}, {"reopened", c.reopened}});
        return counts;
    }

 private:
    Lms2xxSession session_;
    Lms2xxScans scans_;
};

/// It speaks from power-on and does not listen: all there is to be told is whether it does.
class Ld06Talk final : public StreamTalk {
 public:
    explicit Ld06Talk(const LidarParams& lidar) : scans_(lidar) {}

    void on_open(Stamp now) override {
        listener_.on_open();
        now_ = now;
        heard_ = now - kSilence;
    }
    void on_close(Stamp /*now*/) override {}
    void on_time(Stamp now) override { now_ = now; }
    void on_sent(Stamp /*now*/) override {}
    void on_received(std::span<const std::uint8_t> bytes, Stamp received, SampleSink& sink) override {
        const std::uint64_t before = listener_.parser_counters().packets;
        listener_.on_bytes(bytes, received, [&](const Scan& scan) { scans_.deliver(scan, sink); });
        heard_ = listener_.parser_counters().packets > before ? received : heard_;
    }

    [[nodiscard]] StreamWish next_wish(Stamp /*now*/) override { return {}; }
    [[nodiscard]] bool streaming() const override { return now_ - heard_ < kSilence; }
    [[nodiscard]] StateText trouble() const override { return {}; }
    [[nodiscard]] SourceCounts counts() const override { return counts_of(listener_); }

 private:
    static constexpr Duration kSilence{500'000'000};

    Ld06Listener listener_;
    MountedScans scans_;
    Stamp now_;
    Stamp heard_;  ///< the newest packet
};

}  // namespace

std::unique_ptr<StreamTalk> talk_to(const SourceConfig& source, const LidarParams& lidar) {
    switch (source.driver) {
        case SourceDriver::kScip: return std::make_unique<ScipTalk>(source.scip, lidar);
        case SourceDriver::kSick: return std::make_unique<SickTalk>(source.sick, lidar);
        case SourceDriver::kLms2xx: return std::make_unique<Lms2xxTalk>(source.lms2xx, lidar);
        case SourceDriver::kLd06: return std::make_unique<Ld06Talk>(lidar);
        case SourceDriver::kVelodyne:
        case SourceDriver::kCan:
        case SourceDriver::kMotion: break;
    }
    return nullptr;
}

}  // namespace crspf
