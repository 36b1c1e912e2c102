// The simulated run as a capture: what the ports of the robot's computer heard and said, byte for byte.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "config/config.hpp"
#include "core/base/time.hpp"
#include "platform/capture/capture_reader.hpp"
#include "tools/sim/base_bus.hpp"
#include "tools/sim/log_writer.hpp"
#include "tools/sim/simulation.hpp"
#include "tools/sim/stream_link.hpp"

namespace crspf::sim {

/// [us] 2026-01-01T00:00:00Z: captures begin here, and drives so much later. In between the robot stands still, and its
/// computer brings its lidar to speak.
inline constexpr std::int64_t kCaptureStart_us = 1'767'225'600'000'000;
inline constexpr std::int64_t kStandstill_us = 500'000;

/// Of the pictures' source in a capture.
inline constexpr const char* kStereoSource = "stereo";

/// A pcapng file of the configuration's sources, in the order of reception: a conversation with its lidar, or the
/// datagrams of a Velodyne; the frames of the base's bus, where it has one; the pictures of a stereo camera, where it
/// has one, stamped with their exposure.
class CaptureWriter final : public LogWriter {
 public:
    /// `params.start_us` must be kCaptureStart_us + kStandstill_us. `comment` is the text of the configuration; bytes
    /// go to `write`. Throws InputError for a lidar that no capture can hold, and what carried() throws.
    CaptureWriter(const SimulationParams& params, const Config& config, std::string_view comment,
                  std::function<void(std::string_view)> write);
    CaptureWriter(const CaptureWriter&) = delete;
    CaptureWriter& operator=(const CaptureWriter&) = delete;
    ~CaptureWriter() override = default;

    void odometry(const OdometryRecord& record, std::string& out) override;
    void scan(const ScanRecord& record, std::string& out) override;
    void packet(const PacketRecord& record, std::string& out) override;
    void pictures(const PictureRecord& record, std::string& out) override;
    /// The drive is over; what is still on its way arrives.
    void finish();

    [[nodiscard]] std::uint64_t records() const { return records_; }

 private:
    struct Pending {
        std::uint32_t source = 0;
        Direction direction = Direction::kReceived;
        Stamp came;
        Stamp stamp;  ///< mostly the same
        std::vector<std::uint8_t> bytes;
    };

    void begin(Stamp drive);
    void add(std::uint32_t source, Direction direction, Stamp stamp, std::vector<std::uint8_t> bytes);
    void flush(Stamp until);

    LidarModel lidar_;
    double odometry_s_;
    std::function<void(std::string_view)> write_;
    Random random_;
    std::vector<std::uint8_t> head_;
    SourceConfig source_;               ///< the lidar
    std::unique_ptr<StreamLink> link_;  ///< none: a Velodyne
    std::unique_ptr<BaseBus> base_;     ///< none: a stereo camera alone is the odometer
    std::uint32_t stereo_ = 0;          ///< number of the source
    std::vector<Pending> pending_;
    Stamp newest_;  ///< of the odometry; before it nothing new can come
    bool begun_ = false;
    Stamp last_packet_;
    std::uint64_t records_ = 0;
};

}  // namespace crspf::sim
