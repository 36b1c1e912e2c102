#include "platform/service/stream_input.hpp"

#include <optional>

#include "platform/service/lidar_scans.hpp"

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
    MountedScans scans_;
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
        counts.append({{"unusable", scans_.unusable()}});
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

class Ld06Input final : public StreamInput {
 public:
    explicit Ld06Input(const LidarParams& lidar) : scans_(lidar) {}

    void on_open(Stamp /*now*/) override { listener_.on_open(); }
    void on_sent(Stamp /*now*/) override {}
    void on_received(std::span<const std::uint8_t> bytes, Stamp received, SampleSink& sink) override {
        listener_.on_bytes(bytes, received, [&](const Scan& scan) { scans_.deliver(scan, sink); });
    }
    [[nodiscard]] SourceCounts counts() const override { return counts_of(listener_); }

 private:
    Ld06Listener listener_;
    MountedScans scans_;
};

}  // namespace

std::unique_ptr<StreamInput> listen_to(const SourceConfig& source, const LidarParams& lidar) {
    switch (source.driver) {
        case SourceDriver::kScip: return std::make_unique<ScipInput>(lidar);
        case SourceDriver::kSick: return std::make_unique<SickInput>(lidar);
        case SourceDriver::kLms2xx: return std::make_unique<Lms2xxInput>(source.lms2xx, lidar);
        case SourceDriver::kLd06: return std::make_unique<Ld06Input>(lidar);
        case SourceDriver::kVelodyne:
        case SourceDriver::kCan:
        case SourceDriver::kMotion: break;
    }
    return nullptr;
}

}  // namespace crspf
