#include "tools/sim/capture_writer.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "platform/capture/frames.hpp"
#include "platform/capture/pcapng_writer.hpp"
#include "platform/capture/stereo_record.hpp"
#include "tools/sim/carried.hpp"
#include "tools/sim/velodyne_sweep.hpp"

namespace crspf::sim {
namespace {

constexpr std::uint32_t kLidar = 0;
constexpr std::uint32_t kBase = 1;
constexpr Duration kPoweredBefore{5'000'000'000};  // the sensor's clock runs before anybody asks it
constexpr Duration kPacketTransfer{100'000};
constexpr double kPacketDelayMean_ns = 200'000;
constexpr Duration kPictureTransfer{30'000'000};  // read out, sent over USB, compressed
constexpr Duration kUnderWay{50'000'000};         // what was sent at the end has come after this
constexpr std::uint32_t kBroadcast = 0xFFFFFFFF;

Stamp stamp_of(std::int64_t us) {
    return {us * 1000};
}

void must(bool done) {
    if (!done) {
        throw std::logic_error("the capture's format cannot hold this record");
    }
}

std::string_view text_of(const std::vector<std::uint8_t>& bytes) {
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes as the characters of a file
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

CaptureWriter::CaptureWriter(const SimulationParams& params, const Config& config, std::string_view comment,
                             std::function<void(std::string_view)> write)
    : lidar_(params.lidar),
      odometry_s_(1.0 / params.odometry_rate_hz),
      write_(std::move(write)),
      random_(params.seed, RandomStream::kCapture),
      source_(*carried(config).lidar) {
    const SourceConfig* const base = carried(config).base;
    if (base != nullptr) {
        base_ = std::make_unique<BaseBus>(base->can, config.slam.odometry, params,
                                          [this](Stamp stamp, const CanFrame& frame) {
                                              std::vector<std::uint8_t> bytes;
                                              must(append_can_frame(bytes, frame));
                                              add(kBase, Direction::kReceived, stamp, std::move(bytes));
                                          });
    }
    std::string description = lidar_.velodyne == VelodyneModel::kHdl32e ? "HDL-32E, simulated" : "VLP-16, simulated";
    if (!lidar_.spatial()) {
        link_ = std::make_unique<StreamLink>(
            source_, lidar_,
            StreamLinkParams{.power_on = stamp_of(kCaptureStart_us) - kPoweredBefore, .seed = params.seed},
            [this](Direction direction, Stamp stamp, std::span<const std::uint8_t> bytes) {
                add(kLidar, direction, stamp, {bytes.begin(), bytes.end()});
            });
        description = link_->sensor();
    }
    must(pcapng::append_section(head_, comment));
    must(pcapng::append_source(
        head_,
        {.name = source_.name, .description = description, .link = link_ ? LinkKind::kStream : LinkKind::kEthernet}));
    if (base != nullptr) {
        must(pcapng::append_source(head_,
                                   {.name = base->name, .description = "the base, simulated", .link = LinkKind::kCan}));
    }
    if (params.stereo) {
        stereo_ = base != nullptr ? kBase + 1 : kBase;
        must(pcapng::append_source(
            head_, {.name = kStereoSource, .description = "stereo camera, simulated", .link = LinkKind::kStereo}));
    }
}

void CaptureWriter::begin(Stamp drive) {
    begun_ = true;
    write_(text_of(head_));
    const Stamp start = drive - Duration{kStandstill_us * 1000};
    if (base_) {
        base_->begin(start);
        // Counted back from the drive, so that the odometry's rhythm has no gap.
        const auto ticks = static_cast<std::int64_t>(static_cast<double>(kStandstill_us) * 1e-6 / odometry_s_);
        for (std::int64_t tick = ticks; tick > 0; --tick) {
            base_->send(drive - Duration::from_seconds(static_cast<double>(tick) * odometry_s_), {});
        }
    }
    if (link_) {
        link_->begin(start);
        link_->advance_to(drive);
    }
    newest_ = drive;
}

void CaptureWriter::odometry(const OdometryRecord& record, std::string& /*out*/) {
    const Stamp now = stamp_of(record.stamp_us);
    if (!begun_) {
        begin(now);
    }
    if (link_) {
        link_->advance_to(newest_);
    }
    flush(newest_);
    if (base_) {
        base_->send(now, record);
    }
    newest_ = now;
}

void CaptureWriter::scan(const ScanRecord& record, std::string& /*out*/) {
    const Stamp begin = stamp_of(record.stamp_us);
    const Stamp end = begin + Duration::from_seconds(lidar_.time_per_beam_s() * (lidar_.beams - 1));
    link_->advance_to(end);
    link_->on_sweep(begin, end, record.range_mm);
}

void CaptureWriter::packet(const PacketRecord& record, std::string& /*out*/) {
    std::vector<std::uint8_t> frame;
    const std::uint16_t port = record.port == kVelodyneDataPort ? source_.port.port : record.port;
    must(append_udp_frame(frame, {.source_address = source_.velodyne.source_address,
                                  .destination_address = kBroadcast,
                                  .source_port = port,
                                  .destination_port = port,
                                  .payload = record.payload}));
    const Duration delay{static_cast<std::int64_t>(kPacketDelayMean_ns * random_.exponential())};
    last_packet_ = std::max(last_packet_, Stamp{record.sent_ns} + kPacketTransfer + delay);
    add(kLidar, Direction::kReceived, last_packet_, std::move(frame));
}

void CaptureWriter::pictures(const PictureRecord& record, std::string& /*out*/) {
    const std::vector<std::uint8_t> left = encode_gray_png(record.pictures.left.view());
    const std::vector<std::uint8_t> right = encode_gray_png(record.pictures.right.view());
    std::vector<std::uint8_t> bytes;
    append_stereo_record(bytes, {.left_png = left, .right_png = right});
    const Stamp exposed = stamp_of(record.stamp_us);
    pending_.push_back({.source = stereo_,
                        .direction = Direction::kReceived,
                        .came = exposed + kPictureTransfer,
                        .stamp = exposed,
                        .bytes = std::move(bytes)});
}

void CaptureWriter::finish() {
    if (link_) {
        link_->advance_to(newest_ + kUnderWay);
    }
    flush(newest_ + Duration{1'000'000'000});
}

void CaptureWriter::add(std::uint32_t source, Direction direction, Stamp stamp, std::vector<std::uint8_t> bytes) {
    pending_.push_back(
        {.source = source, .direction = direction, .came = stamp, .stamp = stamp, .bytes = std::move(bytes)});
}

void CaptureWriter::flush(Stamp until) {
    std::stable_sort(pending_.begin(), pending_.end(),
                     [](const Pending& a, const Pending& b) { return a.came < b.came; });
    const auto end = std::find_if(pending_.begin(), pending_.end(), [&](const Pending& p) { return p.came > until; });
    std::vector<std::uint8_t> blocks;
    for (auto p = pending_.begin(); p != end; ++p) {
        must(pcapng::append_record(blocks, {.source = p->source,
                                            .link = LinkKind::kOther,
                                            .direction = p->direction,
                                            .cut = false,
                                            .stamp = p->stamp,
                                            .bytes = p->bytes}));
        ++records_;
    }
    write_(text_of(blocks));
    pending_.erase(pending_.begin(), end);
}

}  // namespace crspf::sim
