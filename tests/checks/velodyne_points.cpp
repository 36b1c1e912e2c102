// Prints each return of the data packets on standard input (1206 bytes each) for velodyne_against_foxglove.sh:
//   packet block return laser azimuth[0.01 deg] distance[unit] x y z azimuth_of_point[0.01 deg] after_stamp[us]
// x y z stand at the block's own azimuth, as the other side computes them; azimuth_of_point is what the driver uses.
#include <array>
#include <cstdint>
#include <cstdio>
#include <string_view>

#include "drivers/velodyne/velodyne_geometry.hpp"

using namespace crspf;

namespace {

void print(const VelodynePacket& packet, const VelodyneColumns& columns, VelodyneModel model,
           const VelodyneGeometry& geometry, unsigned number) {
    const VelodyneTraits& traits = traits_of(model);
    for (std::uint32_t c = 0; c < columns.count; ++c) {
        const std::uint32_t b = c / traits.columns_per_block;
        const SinCos direction = sin_cos(packet.blocks[b].azimuth_cdeg * (kPi / 18000.0));
        const VelodyneReturns returns = returns_of(packet, model, columns.returns, c, 0, 0);
        std::array<float, kVelodyneReturns> x{};
        std::array<float, kVelodyneReturns> y{};
        std::array<float, kVelodyneReturns> z{};
        std::array<std::uint8_t, kVelodyneReturns> intensity{};
        geometry.place(0, direction, returns, {x, y, z, intensity});
        for (std::uint32_t laser = 0; laser < traits.lasers; ++laser) {
            if (returns.distance[laser] == 0) {
                continue;
            }
            const double later_us = firing_us(model, laser);
            std::printf("%u %u %u %u %u %u %.9g %.9g %.9g %.6f %.6f\n", number, b,
                        c % traits.columns_per_block * traits.lasers + laser, laser,
                        static_cast<unsigned>(packet.blocks[b].azimuth_cdeg),
                        static_cast<unsigned>(returns.distance[laser]), static_cast<double>(x[laser]),
                        static_cast<double>(y[laser]), static_cast<double>(z[laser]),
                        columns.column[c].azimuth_cdeg + columns.turn_cdeg_per_us[c] * later_us,
                        columns.column[c].after_stamp_us + later_us);
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    const std::string_view name = argc == 2 ? argv[1] : "";
    const VelodyneModel model = name == "hdl32e"   ? VelodyneModel::kHdl32e
                                : name == "vlp32c" ? VelodyneModel::kVlp32c
                                                   : VelodyneModel::kVlp16;
    const VelodyneGeometry geometry(model, nominal_calibration(model).value_or(VelodyneCalibration{}));
    std::array<std::uint8_t, kVelodyneDataBytes> payload{};
    for (unsigned number = 0; std::fread(payload.data(), 1, payload.size(), stdin) == payload.size(); ++number) {
        VelodynePacket packet;
        VelodyneColumns columns;
        if (decode(payload, model, packet) != VelodyneFault::kNone || !split(packet, model, columns)) {
            std::fprintf(stderr, "packet %u refused\n", number);
            return 1;
        }
        print(packet, columns, model, geometry, number);
    }
    return 0;
}
