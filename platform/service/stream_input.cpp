#include "platform/service/stream_input.hpp"

#include <optional>

#include "drivers/common/mounted_scan.hpp"
#include "drivers/sick/lms2xx_scan.hpp"

namespace crspf {

namespace {

class ScipInput final : public StreamInput {
 public:
    explicit ScipInput(const LidarParams& lidar) : scans_(lidar) {}

    void on_open(Stamp /*now*/) override { listener_.on_open(); }
    void on_sent(Stamp now) override { listener_.on_sent(now); }
    void on_received(std::span<const std::uint8_t> bytes, Stamp received, SampleSink& sink) override {
        listener_.on_bytes(bytes, received, [&](const ScipReply&, const Scan* scan) {
            if (scan != nullptr) {
                scans_.deliver(*scan, sink);
            }
        });
    }
    [[nodiscard]] SourceCounts counts() const override { return counts_of(listener_); }

 private:
    ScipListener listener_;
    ScipScans scans_;
};

class SickInput final : public StreamInput {
 public:
    explicit SickInput(const LidarParams& lidar) : scans_(lidar) {}

    void on_open(Stamp /*now*/) override { listener_.on_open(); }
    void on_sent(Stamp /*now*/) override {}
    void on_received(std::span<const std::uint8_t> bytes, Stamp received, SampleSink& sink) override {
        listener_.on_bytes(bytes, received, [&](const ColaTelegram&, Stamp, const std::optional<SickTiming>& timing) {
            if (timing) {
                scans_.deliver(listener_.data(), *timing, sink);
            }
        });
    }
    [[nodiscard]] SourceCounts counts() const override {
        SourceCounts counts = counts_of(listener_);
        counts.emplace_back("unusable", scans_.unusable());
        return counts;
    }

 private:
    SickListener listener_;
    SickScans scans_;
};

class Lms2xxInput final : public StreamInput {
 public:
    Lms2xxInput(const Lms2xxParams& params, const LidarParams& lidar) : listener_(params), scans_(params, lidar) {}

    void on_open(Stamp /*now*/) override { listener_.on_open(); }
    void on_sent(Stamp /*now*/) override {}
    void on_received(std::span<const std::uint8_t> bytes, Stamp received, SampleSink& sink) override {
        listener_.on_bytes(bytes, received, [&](const Lms2xxMessage&, Stamp stamp, bool scan) {
            if (scan) {
                scans_.deliver(listener_.scan(), listener_.beam0(stamp), sink);
            }
        });
    }
    [[nodiscard]] SourceCounts counts() const override { return counts_of(listener_); }

 private:
    Lms2xxListener listener_;
    Lms2xxScans scans_;
};

}  // namespace

std::unique_ptr<StreamInput> listen_to(const SourceConfig& source, const LidarParams& lidar) {
    switch (source.driver) {
        case SourceDriver::kScip: return std::make_unique<ScipInput>(lidar);
        case SourceDriver::kSick: return std::make_unique<SickInput>(lidar);
        case SourceDriver::kLms2xx: return std::make_unique<Lms2xxInput>(source.lms2xx, lidar);
        case SourceDriver::kVelodyne:
        case SourceDriver::kCan: break;
    }
    return nullptr;
}

void ScipScans::deliver(const Scan& scan, SampleSink& sink) {
    scan_ = scan;
    mount(scan_, lidar_);
    sink.on_scan(scan_);
}

void SickScans::deliver(const LmdScandata& data, const SickTiming& timing, SampleSink& sink) {
    if (fill_scan(data, lidar_, clock_.beam0(timing), scan_) == SickScanResult::kFilled) {
        sink.on_scan(scan_);
    } else {
        ++unusable_;
    }
}

void Lms2xxScans::deliver(const Lms2xxScan& raw, Stamp beam0, SampleSink& sink) {
    if (fill_lms2xx_scan(raw, params_.value_mask, lidar_, beam0, scan_)) {
        sink.on_scan(scan_);
    }
}

SourceCounts counts_of(const ScipListener& listener) {
    const ScipListenerCounters& c = listener.counters();
    const ScipParserCounters& p = listener.parser_counters();
    return {{"scans", c.scans},
            {"lost_scans", c.lost_scans},
            {"bad_scans", c.bad_scans},
            {"bad_stamps", c.bad_stamps},
            {"clock_jumps", c.clock_jumps},
            {"stuck_stamps", c.stuck_stamps},
            {"unknown_sensor", c.unknown_sensor},
            {"bad_sum", p.bad_sum},
            {"bad_shape", p.bad_shape},
            {"overflow", p.overflow},
            {"bytes_dropped", p.bytes_dropped}};
}

SourceCounts counts_of(const SickListener& listener) {
    const SickSequenceCounters& s = listener.sequence_counters();
    const ColaCounters& p = listener.parser_counters();
    return {{"scans", s.delivered},   {"lost_scans", s.lost},
            {"withheld", s.withheld}, {"undecodable", listener.undecodable()},
            {"bad_sum", p.bad_sums},  {"bytes_dropped", p.bytes_skipped}};
}

SourceCounts counts_of(const Lms2xxListener& listener) {
    const Lms2xxCounters& p = listener.parser_counters();
    return {{"telegrams", p.telegrams},
            {"undecodable", listener.undecodable()},
            {"bad_sum", p.bad_sums},
            {"broken_off", p.broken_off},
            {"bytes_dropped", p.bytes_skipped}};
}

}  // namespace crspf
