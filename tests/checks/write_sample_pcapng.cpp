// Writes a recording of every kind of source to the path given, for pcapng_by_tshark.sh.
#include <cstdio>
#include <fstream>
#include <vector>

#include "platform/capture/frames.hpp"
#include "platform/capture/pcapng_writer.hpp"

int main(int argc, char** argv) {
    using crspf::CaptureRecord;
    using crspf::Direction;
    using crspf::LinkKind;
    using crspf::Stamp;
    const std::vector<std::uint8_t> payload{'h', 'e', 'l', 'l', 'o'};
    std::vector<std::uint8_t> file;
    std::vector<std::uint8_t> udp;
    std::vector<std::uint8_t> can;
    std::vector<std::uint8_t> can_fd;
    constexpr Stamp kStart{1'700'000'000'123'456'789};
    const auto record = [&](std::uint32_t source, Direction direction, std::int64_t at_ns, const auto& bytes) {
        return crspf::pcapng::append_record(
            file, {source, LinkKind::kOther, direction, false, kStart + crspf::Duration{at_ns}, bytes});
    };
    const bool made =
        crspf::append_udp_frame(udp, {0xC0A801C9, 0xFFFFFFFF, 2368, 2369, payload}) &&
        crspf::append_can_frame(can, {.id = 0x18FEF100, .extended = true, .length = 2, .data = {0xBE, 0xEF}}) &&
        crspf::append_can_frame(can_fd, {.id = 0x123, .fd = true, .length = 12, .data = {0xCA, 0xFE}}) &&
        crspf::pcapng::append_section(file, "the configuration") &&
        crspf::pcapng::append_source(file, {"front", "VLP-16", LinkKind::kEthernet}) &&
        crspf::pcapng::append_source(file, {"can0", "wheels", LinkKind::kCan}) &&
        crspf::pcapng::append_source(file, {"rear", "URG-04LX", LinkKind::kStream}) &&
        record(0, Direction::kReceived, 0, udp) && record(1, Direction::kSent, 1, can) &&
        record(1, Direction::kUnknown, 2, can_fd) && record(2, Direction::kReceived, 3, payload);
    if (argc != 2 || !made) {
        std::fprintf(stderr, "usage: write_sample_pcapng FILE\n");
        return 2;
    }
    std::ofstream stream(argv[1], std::ios::binary);
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes as the characters of a file
    stream.write(reinterpret_cast<const char*>(file.data()), static_cast<std::streamsize>(file.size()));
    stream.close();
    return stream.good() ? 0 : 1;
}
