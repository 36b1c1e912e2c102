// LMDscandata: one scan of an LMS1xx, LMS5xx, TiM5xx or TiM7xx, in either dialect of CoLa, and back.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/sick/cola_codec.hpp"

namespace crspf {

/// Channels of one telegram: five echoes, their intensities, angles.
inline constexpr std::size_t kSickChannels = 16;
inline constexpr std::size_t kSickEncoders = 3;
/// Values of all channels. CoLa takes two bytes for a 16-bit value, so any telegram that the parser passes fits.
inline constexpr std::size_t kSickValues = kLargestColaPayload / 2;

using SickName = std::array<char, 5>;  ///< "DIST1", "RSSI1", ...

struct SickChannel {
    SickName name{};
    float scale = 1.0F;
    float offset = 0.0F;            ///< ranges: [m], added after scaling
    std::int32_t start_1e4deg = 0;  ///< [0.0001 degree] of value 0; 90 degrees is straight ahead, counter-clockwise
    std::int16_t step_1e4deg = 0;   ///< [0.0001 degree]
    std::uint16_t first = 0;        ///< index into LmdScandata::values
    std::uint16_t count = 0;
    friend bool operator==(const SickChannel&, const SickChannel&) = default;
};

struct SickEncoder {
    std::int32_t ticks = 0;
    std::int16_t speed = 0;
    friend bool operator==(const SickEncoder&, const SickEncoder&) = default;
};

struct LmdScandata {
    std::uint16_t version = 1;
    std::uint16_t device = 1;
    std::uint32_t serial = 0;
    std::array<std::uint8_t, 2> status{};  ///< 0 0: ok
    std::uint16_t telegram_counter = 0;
    std::uint16_t scan_counter = 0;
    std::uint32_t start_us = 0;     ///< [us] of the sensor's clock, wraps: when the scan began
    std::uint32_t transmit_us = 0;  ///< [us] of the sensor's clock, wraps: when it was sent
    std::array<std::uint8_t, 2> inputs{};
    std::array<std::uint8_t, 2> outputs{};
    std::uint16_t layer = 0;
    std::uint32_t scan_frequency_centihertz = 0;  ///< [0.01 Hz]
    std::uint32_t beam_frequency_hectohertz = 0;  ///< [100 Hz]; some firmware says [Hz]
    std::uint16_t encoders = 0;
    std::array<SickEncoder, kSickEncoders> encoder{};
    std::uint16_t channels16 = 0;  ///< the first channels are of 16 bit,
    std::uint16_t channels8 = 0;   ///< the ones behind them of 8
    std::array<SickChannel, kSickChannels> channel{};
    bool has_time = false;
    std::uint16_t year = 0;
    std::array<std::uint8_t, 5> month_to_second{};  ///< month, day, hour, minute, second of the sensor's calendar
    std::uint32_t microsecond = 0;
    std::array<std::uint16_t, kSickValues> values{};  ///< raw, of all channels

    /// The values of a channel; empty where the channel does not lie within `values`.
    [[nodiscard]] std::span<const std::uint16_t> of(const SickChannel& one) const;
    /// The first channel of that name among those of 16 bit; null where there is none.
    [[nodiscard]] const SickChannel* find(const SickName& name) const;
};

/// False where anything is missing, left over or out of its range: CoLa-B's XOR misses one error in 256, the structure
/// finds most of what it misses. `data` then holds nothing of use. Position, name, comment and event are passed over.
/// Wait-free; about 16000 values at most.
[[nodiscard]] bool decode_lmd_scandata(const ColaTelegram& telegram, LmdScandata& data);

/// The payload, without frame, position, name, comment and event. Returns its length, 0 where it does not fit.
std::size_t encode_lmd_scandata(const LmdScandata& data, ColaDialect dialect, std::span<std::uint8_t> out);

}  // namespace crspf
