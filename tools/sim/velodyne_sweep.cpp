#include "tools/sim/velodyne_sweep.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "core/base/trig.hpp"
#include "drivers/velodyne/velodyne_codec.hpp"
#include "drivers/velodyne/velodyne_models.hpp"
#include "tools/sim/random.hpp"

namespace crspf::sim {
namespace {

constexpr double kPoweredBefore_s = 40.0;  // the drive's start
constexpr double kClockDrift = 20e-6;
constexpr double kCut_cdeg = 18000.0;

std::uint8_t reflectivity_of(Surface surface) {
    switch (surface) {
        case Surface::kGround: return 15;
        case Surface::kKerb: return 60;
        case Surface::kWall: return 40;
        case Surface::kPerson: return 30;
        case Surface::kCrown: return 20;
        case Surface::kCar: return 35;
        case Surface::kNothing: break;
    }
    return 0;
}

class VelodyneSweep final : public Sweep {
 public:
    VelodyneSweep(const World3d& world, const SimulationParams& params)
        : world_(&world),
          lidar_(params.lidar),
          model_(params.lidar.velodyne),
          traits_(traits_of(params.lidar.velodyne)),
          P_base_lidar_(params.P_base_lidar),
          wheel_base_m_(params.robot.wheel_base_m),
          wheel_span_m_(params.robot.wheel_span_m),
          lidar_height_m_(params.robot.lidar_height_m),
          random_(params.seed, RandomStream::kVelodyne),
          origin_us_(params.start_us) {
        const VelodyneCalibration calibration = nominal_calibration(model_).value_or(VelodyneCalibration{});
        for (std::uint32_t laser = 0; laser < traits_.lasers; ++laser) {
            elevation_[laser] = sin_cos(calibration[laser].vertical_rad);
        }
    }

    void advance(const Motion& motion, double start_s, double length_s, const Movers& movers) override {
        const double end_s = start_s + length_s;
        while (passage_s() < end_s) {
            truth_.push_back({.stamp_s = static_cast<double>(origin_us_) * 1e-6 + passage_s(),
                              .P_map_base = motion.pose_at(passage_s() - start_s)});
        }
        while (firing_s() < end_s) {
            const double at_s = firing_s();
            fire(motion.pose_at(at_s - start_s), at_s, movers);
            if (++laser_ == traits_.lasers) {
                laser_ = 0;
                if (++column_ == kVelodyneBlocks * traits_.columns_per_block) {
                    finish_packet(at_s);
                }
            }
        }
    }

    void deliver(LogWriter& writer, std::string& out) override {
        for (const PacketRecord& packet : finished_) {
            writer.packet(packet, out);
        }
        finished_.clear();
    }

    [[nodiscard]] std::vector<TimedPose> truth() const override { return truth_; }

 private:
    /// When the head next passes the cut, when the next laser is fired. [s] since the drive's start
    [[nodiscard]] double passage_s() const { return static_cast<double>(truth_.size()) * lidar_.revolution_s; }
    [[nodiscard]] double column_s() const {
        return (static_cast<double>(packets_) * traits_.packet_us + column_ * traits_.column_us) * 1e-6;
    }
    [[nodiscard]] double firing_s() const { return column_s() + firing_us(model_, laser_) * 1e-6; }
    [[nodiscard]] double azimuth_cdeg(double at_s) const {
        const double turns = at_s / lidar_.revolution_s + kCut_cdeg / kVelodyneTurn_cdeg;
        return (turns - std::floor(turns)) * kVelodyneTurn_cdeg;
    }
    [[nodiscard]] std::uint32_t clock_us(double at_s) const {
        const double shown_us = (at_s + kPoweredBefore_s) * (1.0 + kClockDrift) * 1e6;
        return static_cast<std::uint32_t>(std::fmod(std::floor(shown_us), static_cast<double>(kVelodyneHour_us)));
    }

    void fire(const Pose2& P_world_base, double at_s, const Movers& movers) {
        VelodyneBlock& block = packet_.blocks[column_ / traits_.columns_per_block];
        if (laser_ == 0 && column_ % traits_.columns_per_block == 0) {
            const auto azimuth = static_cast<std::int32_t>(std::floor(azimuth_cdeg(at_s) + 0.5));
            block.azimuth_cdeg = static_cast<std::uint16_t>(azimuth % kVelodyneTurn_cdeg);
            if (column_ == 0) {
                packet_.stamp_us = clock_us(at_s - traits_.first_firing_us * 1e-6);
            }
        }
        if (laser_ == 0) {
            base_ = frame_on(world_->terrain(), P_world_base, wheel_base_m_, wheel_span_m_);
        }
        const Vector3 mounted{.x = P_base_lidar_.x_m, .y = P_base_lidar_.y_m, .z = lidar_height_m_};
        const SinCos azimuth = sin_cos(P_base_lidar_.theta_rad - radians(azimuth_cdeg(at_s) / 100.0));
        const SinCos& elevation = elevation_[laser_];
        const Vector3 direction{.x = elevation.cos * azimuth.cos, .y = elevation.cos * azimuth.sin, .z = elevation.sin};
        const Echo echo =
            world_->cast(base_.origin + base_.turned(mounted), base_.turned(direction), movers, lidar_.range_max_m);
        // Drawn for every beam, as Lidar::read_mm() does.
        const bool dropped = random_.uniform() < lidar_.dropout;
        const double range_m = echo.range_m + random_.normal() * lidar_.noise_m;
        const bool seen = echo.surface != Surface::kNothing && !dropped && range_m >= lidar_.range_min_m &&
                          range_m <= lidar_.range_max_m;
        const double distance = seen ? std::floor(range_m / traits_.distance_unit_m + 0.5) : 0.0;
        const std::size_t at = column_ % traits_.columns_per_block * traits_.lasers + laser_;
        block.distance[at] = static_cast<std::uint16_t>(distance);
        block.reflectivity[at] = seen ? reflectivity_of(echo.surface) : std::uint8_t{0};
    }

    void finish_packet(double at_s) {
        const std::int64_t sent_ns = origin_us_ * 1000 + static_cast<std::int64_t>(at_s * 1e9);
        packet_.mode = kVelodyneStrongest;
        packet_.product = product_of_model(model_);
        PacketRecord record{.sent_ns = sent_ns, .port = kVelodyneDataPort, .payload = {}};
        record.payload.resize(kVelodyneDataBytes);
        encode(packet_, model_, record.payload);
        finished_.push_back(std::move(record));
        column_ = 0;
        ++packets_;
        if (at_s >= static_cast<double>(positions_)) {
            ++positions_;
            PacketRecord position{.sent_ns = sent_ns, .port = kVelodynePositionPort, .payload = {}};
            position.payload.resize(kVelodynePositionBytes);
            encode(
                VelodynePosition{.stamp_us = clock_us(at_s), .pps = VelodynePps::kNone, .sentence = {}, .fix = false},
                position.payload);
            finished_.push_back(std::move(position));
        }
    }

    const World3d* world_;
    LidarModel lidar_;
    VelodyneModel model_;
    VelodyneTraits traits_;
    Pose2 P_base_lidar_;
    double wheel_base_m_;
    double wheel_span_m_;
    double lidar_height_m_;
    Random random_;
    std::int64_t origin_us_;  ///< stamp of the drive's start
    std::array<SinCos, kVelodyneLasers> elevation_{};
    Frame base_;  ///< while a column is fired

    // What is fired next.
    std::int64_t packets_ = 0;
    std::uint32_t column_ = 0;
    std::uint32_t laser_ = 0;
    std::int64_t positions_ = 0;  ///< sent
    VelodynePacket packet_;
    std::vector<PacketRecord> finished_;
    std::vector<TimedPose> truth_;
};

}  // namespace

std::unique_ptr<Sweep> velodyne_sweep(const World3d& world, const SimulationParams& params) {
    return std::make_unique<VelodyneSweep>(world, params);
}

}  // namespace crspf::sim
