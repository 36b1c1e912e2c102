// A simulated Velodyne sensor: its packets, one after the other.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "drivers/velodyne/velodyne_codec.hpp"
#include "drivers/velodyne/velodyne_geometry.hpp"
#include "drivers/velodyne/velodyne_models.hpp"

namespace crspf::test {

using Bytes = std::vector<std::uint8_t>;

/// Turns evenly and fires as the real one; the stamp is true to the microsecond. `distance(azimuth_rad, laser, r)`
/// gives what is seen, in the model's unit.
class VelodyneStream {
 public:
    explicit VelodyneStream(VelodyneModel model, bool dual = false, double turns_per_s = 10.0)
        : model_(model), dual_(dual), cdeg_per_us_(turns_per_s * 0.036) {}

    double start_us = 0.0;           ///< on the sensor's clock
    double start_cdeg = 0.0;         ///< azimuth at that time
    std::uint32_t packet_index = 0;  ///< of the next packet

    [[nodiscard]] double period_us() const { return traits_of(model_).packet_us / (dual_ ? 2.0 : 1.0); }
    /// When the first column of packet `index` is fired.
    [[nodiscard]] double packet_us(std::uint32_t index) const { return start_us + period_us() * index; }
    [[nodiscard]] double azimuth_cdeg(double at_us) const {
        return std::fmod(start_cdeg + (at_us - start_us) * cdeg_per_us_, 36000.0);
    }

    template <typename Distance>
    VelodynePacket next(Distance distance) {
        const VelodyneTraits& t = traits_of(model_);
        VelodynePacket p;
        const double first_us = packet_us(packet_index);
        p.stamp_us = static_cast<std::uint32_t>(
            std::fmod(std::floor(first_us - t.first_firing_us + 0.5), static_cast<double>(kVelodyneHour_us)));
        p.mode = is_hdl64e(model_) ? std::uint8_t{'H'} : dual_ ? kVelodyneDual : kVelodyneStrongest;
        p.product = product_of_model(model_);
        const std::uint32_t together = is_hdl64e(model_) || dual_ ? 2 : 1;
        for (std::uint32_t b = 0; b < kVelodyneBlocks; ++b) {
            const std::uint32_t group = b / together;
            const double block_us = first_us + t.column_us * t.columns_per_block * group;
            p.blocks[b].azimuth_cdeg =
                static_cast<std::uint16_t>(static_cast<int>(std::floor(azimuth_cdeg(block_us) + 0.5)) % 36000);
            for (std::uint32_t j = 0; j < kVelodyneReturns; ++j) {
                const std::uint32_t bank = is_hdl64e(model_) ? b % 2 : 0;
                const std::uint32_t laser = j % t.lasers + 32 * bank;
                const std::uint32_t column = j / t.lasers;
                const double at_us = block_us + t.column_us * column + firing_us(model_, laser);
                const double azimuth_rad = azimuth_cdeg(at_us) * 3.14159265358979323846 / 18000.0;
                p.blocks[b].distance[j] = static_cast<std::uint16_t>(distance(azimuth_rad, laser, dual_ ? b % 2 : 0));
                p.blocks[b].reflectivity[j] = static_cast<std::uint8_t>(j);
            }
        }
        ++packet_index;
        return p;
    }

    [[nodiscard]] Bytes bytes(const VelodynePacket& packet) const {
        Bytes out(kVelodyneDataBytes);
        encode(packet, model_, out);
        return out;
    }

    template <typename Distance>
    Bytes next_bytes(Distance distance) {
        return bytes(next(distance));
    }

 private:
    VelodyneModel model_;
    bool dual_;
    double cdeg_per_us_;
};

}  // namespace crspf::test
