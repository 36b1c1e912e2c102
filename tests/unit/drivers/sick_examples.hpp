// Scans and bytes that the tests of drivers/sick share.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/rng.hpp"
#include "drivers/sick/lmd_scandata.hpp"

namespace crspf::test {

using Bytes = std::vector<std::uint8_t>;

/// "02 0A FF" -> bytes.
inline Bytes hex(std::string_view text) {
    Bytes bytes;
    int high = -1;
    for (const char c : text) {
        if (c == ' ') {
            continue;
        }
        const int digit = c <= '9' ? c - '0' : c - 'A' + 10;
        if (high < 0) {
            high = digit;
        } else {
            bytes.push_back(static_cast<std::uint8_t>(high * 16 + digit));
            high = -1;
        }
    }
    return bytes;
}

inline Bytes ascii(std::string_view text) {
    return {text.begin(), text.end()};
}

inline void append(Bytes& to, std::span<const std::uint8_t> from) {
    to.insert(to.end(), from.begin(), from.end());
}

inline SickChannel channel(std::array<char, 5> name, std::uint16_t first, std::uint16_t count,
                           std::int32_t start_1e4deg = -450000, std::int16_t step_1e4deg = 3333) {
    return {name, 1.0F, 0.0F, start_1e4deg, step_1e4deg, first, count};
}

/// The numbers of the published capture of a TiM7xx; its ranges are ours.
inline void fill_tim(LmdScandata& data, std::uint16_t count = 811) {
    data.serial = 18480390;
    data.telegram_counter = 44977;
    data.scan_counter = 44981;
    data.start_us = 3014133219;
    data.transmit_us = 3014139433;
    data.outputs = {0x08, 0x00};
    data.scan_frequency_centihertz = 1500;
    data.beam_frequency_hectohertz = 162;
    data.channels16 = 2;
    data.channel[0] = channel({'D', 'I', 'S', 'T', '1'}, 0, count);
    data.channel[1] = channel({'R', 'S', 'S', 'I', '1'}, count, count);
    data.has_time = true;
    data.year = 1970;
    data.month_to_second = {1, 1, 0, 50, 14};
    data.microsecond = 0x00021340;
    for (std::size_t i = 0; i < count; ++i) {
        data.values[i] = static_cast<std::uint16_t>(1000 + 7 * i);
        data.values[count + i] = static_cast<std::uint16_t>(0xE000 + i);
    }
}

inline Bytes framed(const LmdScandata& data, ColaDialect dialect) {
    Bytes payload(kLargestColaPayload);
    payload.resize(encode_lmd_scandata(data, dialect, payload));
    Bytes bytes(payload.size() + kColaFrame);
    bytes.resize(payload.empty() ? 0 : encode_cola(dialect, payload, bytes));
    return bytes;
}

/// A number below `n`.
inline std::uint32_t below(Rng& rng, std::uint32_t n) {
    return rng.next() % n;
}

/// `bytes` with each byte changed, dropped or doubled by a random one, each in a third of `per_mille` / 1000 of cases.
inline Bytes damaged(const Bytes& bytes, std::uint32_t per_mille, Rng& rng) {
    Bytes out;
    for (const std::uint8_t byte : bytes) {
        if (below(rng, 1000) >= per_mille) {
            out.push_back(byte);
            continue;
        }
        switch (below(rng, 3)) {
            case 0: out.push_back(static_cast<std::uint8_t>(rng.next())); break;
            case 1: break;
            default: out.push_back(static_cast<std::uint8_t>(rng.next())); out.push_back(byte);
        }
    }
    return out;
}

}  // namespace crspf::test
