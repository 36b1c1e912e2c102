#include "drivers/velodyne/velodyne_models.hpp"

#include "core/base/real.hpp"
#include "core/base/trig.hpp"

namespace crspf {
namespace {

constexpr VelodyneTraits kPuck = {.lasers = 16,
                                  .columns_per_block = 2,
                                  .distance_unit_m = 0.002,
                                  .lasers_at_once = 1,
                                  .laser_us = 2.304,
                                  .column_us = 55.296,
                                  .first_firing_us = 0.0,
                                  .packet_us = 24 * 55.296};
constexpr VelodyneTraits kHdl32 = {.lasers = 32,
                                   .columns_per_block = 1,
                                   .distance_unit_m = 0.002,
                                   .lasers_at_once = 1,
                                   .laser_us = 1.152,
                                   .column_us = 46.08,
                                   .first_firing_us = -(11 * 46.08 + 31 * 1.152),
                                   .packet_us = 12 * 46.08};
constexpr VelodyneTraits kVlp32 = {.lasers = 32,
                                   .columns_per_block = 1,
                                   .distance_unit_m = 0.004,
                                   .lasers_at_once = 2,
                                   .laser_us = 2.304,
                                   .column_us = 55.296,
                                   .first_firing_us = 0.0,
                                   .packet_us = 12 * 55.296};
// 384 points a packet; the S2 makes 1 333 312 points a second, the S3 2 222 220.
constexpr VelodyneTraits kHdl64S2 = {.lasers = 64,
                                     .columns_per_block = 1,
                                     .distance_unit_m = 0.002,
                                     .lasers_at_once = 1,
                                     .laser_us = 0.728,
                                     .column_us = 32 * 0.728,
                                     .first_firing_us = 0.0,
                                     .packet_us = 384e6 / 1333312.0};
constexpr VelodyneTraits kHdl64S3 = {.lasers = 64,
                                     .columns_per_block = 1,
                                     .distance_unit_m = 0.002,
                                     .lasers_at_once = 1,
                                     .laser_us = 0.728,
                                     .column_us = 32 * 0.728,
                                     .first_firing_us = 0.0,
                                     .packet_us = 384e6 / 2222220.0};

constexpr std::array<double, 16> kVlp16_deg = {-15, 1, -13, 3, -11, 5, -9, 7, -7, 9, -5, 11, -3, 13, -1, 15};
constexpr std::array<double, 16> kPuckHiRes_deg = {-10,     0.6667, -8.6667, 2,      -7.3333, 3.3333, -6,      4.6667,
                                                   -4.6667, 6,      -3.3333, 7.3333, -2,      8.6667, -0.6667, 10};
constexpr std::array<double, 32> kHdl32e_deg = {
    -30.67, -9.33, -29.33, -8, -28, -6.67, -26.67, -5.33, -25.33, -4, -24, -2.67, -22.67, -1.33, -21.33, 0, -20, 1.33,
    -18.67, 2.67,  -17.33, 4,  -16, 5.33,  -14.67, 6.67,  -13.33, 8,  -12, 9.33,  -10.67, 10.67};

// VLP-32C manual, table 9-2.
constexpr std::array<double, 32> kVlp32c_deg = {-25,    -1,    -1.667, -15.639, -11.31, 0,     -0.667, -8.843,
                                                -7.254, 0.333, -0.333, -6.148,  -5.333, 1.333, 0.667,  -4,
                                                -4.667, 1.667, 1,      -3.667,  -3.333, 3.333, 2.333,  -2.667,
                                                -3,     7,     4.667,  -2.333,  -2,     15,    10.333, -1.333};
constexpr std::array<double, 32> kVlp32cAzimuthOffset_deg = {
    1.4, -4.2, 1.4, -1.4, 1.4, -1.4, 4.2, -1.4, 1.4, -4.2, 1.4, -1.4, 4.2, -1.4, 4.2, -1.4,
    1.4, -4.2, 1.4, -4.2, 4.2, -1.4, 1.4, -1.4, 1.4, -1.4, 1.4, -4.2, 4.2, -1.4, 1.4, -1.4};

template <std::size_t Lasers>
VelodyneCalibration with_angles(const std::array<double, Lasers>& vertical_deg) {
    VelodyneCalibration calibration;
    for (std::size_t i = 0; i < Lasers; ++i) {
        calibration[i].vertical_rad = radians(vertical_deg[i]);
    }
    return calibration;
}

VelodyneCalibration vlp32c() {
    VelodyneCalibration calibration = with_angles(kVlp32c_deg);
    for (std::size_t i = 0; i < kVlp32cAzimuthOffset_deg.size(); ++i) {
        calibration[i].rotation_rad = -radians(kVlp32cAzimuthOffset_deg[i]);
    }
    return calibration;
}

}  // namespace

const VelodyneTraits& traits_of(VelodyneModel model) {
    switch (model) {
        case VelodyneModel::kVlp16:
        case VelodyneModel::kPuckHiRes: return kPuck;
        case VelodyneModel::kHdl32e: return kHdl32;
        case VelodyneModel::kVlp32c: return kVlp32;
        case VelodyneModel::kHdl64eS2: return kHdl64S2;
        case VelodyneModel::kHdl64eS3: break;
    }
    return kHdl64S3;
}

std::optional<VelodyneModel> model_of_product(std::uint8_t product) {
    switch (product) {
        case 0x21: return VelodyneModel::kHdl32e;
        case 0x22: return VelodyneModel::kVlp16;
        case 0x24: return VelodyneModel::kPuckHiRes;
        case 0x28: return VelodyneModel::kVlp32c;
        default: return std::nullopt;
    }
}

std::uint8_t product_of_model(VelodyneModel model) {
    switch (model) {
        case VelodyneModel::kVlp16: return 0x22;
        case VelodyneModel::kPuckHiRes: return 0x24;
        case VelodyneModel::kHdl32e: return 0x21;
        case VelodyneModel::kVlp32c: return 0x28;
        case VelodyneModel::kHdl64eS2:
        case VelodyneModel::kHdl64eS3: break;
    }
    return 0;
}

std::optional<VelodyneCalibration> nominal_calibration(VelodyneModel model) {
    switch (model) {
        case VelodyneModel::kVlp16: return with_angles(kVlp16_deg);
        case VelodyneModel::kPuckHiRes: return with_angles(kPuckHiRes_deg);
        case VelodyneModel::kHdl32e: return with_angles(kHdl32e_deg);
        case VelodyneModel::kVlp32c: return vlp32c();
        case VelodyneModel::kHdl64eS2:
        case VelodyneModel::kHdl64eS3: break;
    }
    return std::nullopt;
}

double firing_us(VelodyneModel model, std::uint32_t laser) {
    // The two banks of the HDL-64E fire together.
    const VelodyneTraits& traits = traits_of(model);
    const std::uint32_t turn = laser % kVelodyneReturns / traits.lasers_at_once;
    return traits.laser_us * turn;
}

std::uint32_t most_level_laser(VelodyneModel model, const VelodyneCalibration& calibration) {
    std::uint32_t best = 0;
    for (std::uint32_t i = 1; i < traits_of(model).lasers; ++i) {
        if (absolute(calibration[i].vertical_rad) < absolute(calibration[best].vertical_rad)) {
            best = i;
        }
    }
    return best;
}

std::array<std::uint8_t, kVelodyneLasers> lasers_upward(VelodyneModel model, const VelodyneCalibration& calibration) {
    std::array<std::uint8_t, kVelodyneLasers> upward{};
    const std::uint32_t lasers = traits_of(model).lasers;
    for (std::uint32_t i = 0; i < lasers; ++i) {
        // Insertion: few lasers, and std::stable_sort would take memory from the heap.
        std::uint32_t at = i;
        for (; at > 0 && calibration[upward[at - 1]].vertical_rad > calibration[i].vertical_rad; --at) {
            upward[at] = upward[at - 1];
        }
        upward[at] = static_cast<std::uint8_t>(i);
    }
    return upward;
}

}  // namespace crspf
