// The UDP datagrams of a small capture: microseconds, little-endian, Ethernet and IPv4 without options.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <stdexcept>
#include <vector>

#include "core/base/time.hpp"
#include "drivers/common/byte_reader.hpp"

namespace crspf::test {

struct Datagram {
    Stamp received;
    std::uint32_t source = 0;
    std::uint16_t port = 0;  ///< destination
    std::vector<std::uint8_t> payload;
};

inline std::vector<Datagram> read_capture(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    const std::vector<std::uint8_t> bytes(std::istreambuf_iterator<char>(stream), {});
    ByteReader in(bytes);
    if (in.little<std::uint32_t>() != 0xA1B2C3D4U) {
        throw std::runtime_error(file.string() + ": not a capture this test reads");
    }
    in.skip(20);
    std::vector<Datagram> out;
    while (in.left() > 0) {
        const std::int64_t s = in.little<std::uint32_t>();
        const std::int64_t us = in.little<std::uint32_t>();
        const auto captured = in.little<std::uint32_t>();
        in.skip(4);
        ByteReader frame(in.take(captured));
        Datagram d;
        d.received = {(s * 1000000 + us) * 1000};
        frame.skip(14 + 12);
        d.source = frame.big<std::uint32_t>();
        frame.skip(4 + 2);
        d.port = frame.big<std::uint16_t>();
        frame.skip(4);
        const std::span<const std::uint8_t> payload = frame.take(frame.left());
        d.payload.assign(payload.begin(), payload.end());
        if (!in.ok() || !frame.ok()) {
            throw std::runtime_error(file.string() + ": cut off");
        }
        out.push_back(d);
    }
    return out;
}

}  // namespace crspf::test
