// Telegrams of CoLa, the command language of SICK's sensors, and the commands that we use.
//
// CoLa-A: 02, text, 03. It has no sum: over TCP, whose own sum covers it, that is enough; over a raw serial line it is
// not. CoLa-B: 02 02 02 02, u32 length, payload, u8 XOR of the payload. Source: SICK telegram listings 8014631,
// 8023198.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/sick/cola_fields.hpp"

namespace crspf {

/// Payload of the largest telegram that is read or written: one echo with its intensities of an LMS5xx (1141 beams) in
/// CoLa-A, three of them in CoLa-B. Larger ones are skipped and counted as bytes_skipped.
inline constexpr std::size_t kLargestColaPayload = 16384;
/// Framing around a payload, at most: CoLa-B's.
inline constexpr std::size_t kColaFrame = 9;
/// What begins a telegram, once in CoLa-A and four times in CoLa-B.
inline constexpr std::uint8_t kColaStart = 0x02;
/// What ends one of CoLa-A.
inline constexpr std::uint8_t kColaEnd = 0x03;
/// A command of ours, framed.
inline constexpr std::size_t kLargestColaCommand = 80;

/// A telegram without its frame. Views the parser's buffer.
struct ColaTelegram {
    ColaDialect dialect = ColaDialect::kBinary;
    std::span<const std::uint8_t> payload;

    /// "sSN", "sRA", ...: what kind of telegram it is.
    [[nodiscard]] std::span<const std::uint8_t> kind() const;
    /// "LMDscandata", "STlms", ...; empty for sFA, which has none.
    [[nodiscard]] std::span<const std::uint8_t> name() const;
    template <std::size_t K, std::size_t N>
    [[nodiscard]] bool is(const char (&kind_text)[K], const char (&name_text)[N]) const {
        return spells(kind(), kind_text) && spells(name(), name_text);
    }
    /// What stands behind the name.
    [[nodiscard]] ColaFieldReader fields() const;
};

/// True for the first three letters of every telegram, in either direction.
[[nodiscard]] bool is_cola_kind(std::span<const std::uint8_t> three);

[[nodiscard]] std::uint8_t cola_sum(std::span<const std::uint8_t> payload);

/// Frames a payload. Returns the number of bytes written, 0 where they do not fit.
std::size_t encode_cola(ColaDialect dialect, std::span<const std::uint8_t> payload, std::span<std::uint8_t> out);

/// Angles and frequency of the scan. The sensor rejects what it cannot do.
struct SickScanConfig {
    std::uint32_t frequency_centihertz = 5000;  ///< [0.01 Hz]
    std::uint32_t resolution_1e4deg = 5000;     ///< [0.0001 degree]
    std::int32_t start_1e4deg = -450000;        ///< [0.0001 degree] 90 degrees is straight ahead
    std::int32_t stop_1e4deg = 2250000;         ///< [0.0001 degree]
    friend bool operator==(const SickScanConfig&, const SickScanConfig&) = default;
};

/// What STlms says of a sensor that measures.
inline constexpr std::uint16_t kSickReady = 7;

enum class SickCommand : std::uint8_t {
    kLogin,            ///< sMN SetAccessMode: level 3, "authorized client"
    kUseBinary,        ///< sWN EIHstCola 1
    kUseAscii,         ///< sWN EIHstCola 0
    kConfigureScan,    ///< sMN mLMPsetscancfg
    kConfigureOutput,  ///< sWN LMDscandatacfg: first echo and intensities, 16 bit, every scan
    kStartMeasuring,   ///< sMN LMCstartmeas
    kReadStatus,       ///< sRN STlms
    kRun,              ///< sMN Run: logs out, activates
    kSubscribe,        ///< sEN LMDscandata 1
    kUnsubscribe,      ///< sEN LMDscandata 0
    kReadScanConfig,   ///< sRN LMPscancfg
};

/// A command, framed. `config` counts for kConfigureScan only. Returns the number of bytes, 0 where they do not fit.
std::size_t encode_command(SickCommand command, ColaDialect dialect, const SickScanConfig& config,
                           std::span<std::uint8_t> out);

/// Whether `reply` answers `command`, whatever it says. A refusal (sFA) names no command and answers none here.
[[nodiscard]] bool answers(const ColaTelegram& reply, SickCommand command);

/// Whether the sensor did what `command` asked for; true for replies that carry no verdict.
[[nodiscard]] bool accepted(const ColaTelegram& reply, SickCommand command);

/// The number of a refusal (sFA), 0 where `reply` is none or does not tell.
[[nodiscard]] std::uint16_t refusal(const ColaTelegram& reply);
/// What the number says, for people.
[[nodiscard]] const char* refusal_text(std::uint16_t number);

}  // namespace crspf
