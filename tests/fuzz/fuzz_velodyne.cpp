// Whatever the datagrams: each is counted once, clouds and scans keep within their bounds. The first byte of the input
// chooses the model; then come records of one byte that says what is received and for how long there was silence, and
// the datagram. A record of kind 0 holds a whole data packet; other kinds repeat the last one with a few bytes changed,
// so that the search need not find 1206 bytes again for each next packet.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>

#include "core/slam/obstacle_scan.hpp"
#include "drivers/common/byte_reader.hpp"
#include "drivers/velodyne/velodyne_assembler.hpp"
#include "drivers/velodyne/velodyne_scan.hpp"

namespace {

using namespace crspf;

void require(bool promise) {
    if (!promise) {
        std::abort();
    }
}

std::uint64_t sum(const VelodyneCounters& n) {
    return n.packets + n.positions + n.foreign + n.bad_length + n.bad_flag + n.bad_azimuth + n.bad_stamp + n.bad_mode +
           n.bad_model + n.bad_position + n.late + n.without_calibration;
}

void check(const VelodyneCloud& cloud) {
    require(cloud.columns > 0 && cloud.columns <= capacity::kCloudColumns);
    require(cloud.at(cloud.columns, 0) <= capacity::kCloudPoints);
    require(cloud.missing_columns <= cloud.columns);
    for (std::uint32_t c = 0; c < cloud.columns; ++c) {
        require(cloud.azimuth_rad[c] >= 0.0 && cloud.azimuth_rad[c] < 6.2832);
        require(cloud.measured[c] || cloud.beam[cloud.at(c, 0)] == Beam::kInvalid);
    }
}

void check(const Scan& obstacles) {
    const auto farthest_m = static_cast<float>(ObstacleParams{}.range_max_m);
    for (std::uint32_t i = 0; i < obstacles.count; ++i) {
        require(obstacles.beam[i] == Beam::kInvalid ||
                (obstacles.range_m[i] >= 0.0F && obstacles.range_m[i] <= farthest_m));
    }
}

void check_position(std::span<const std::uint8_t> bytes) {
    VelodynePosition position;
    if (decode(bytes, position) == VelodyneFault::kNone) {
        std::array<std::uint8_t, kVelodynePositionBytes> again{};
        require(position.sentence.size() + 2 > again.size() - 206 || encode(position, again) == again.size());
    }
}

void check_packet(std::span<const std::uint8_t> bytes, VelodyneModel model) {
    VelodynePacket packet;
    if (decode(bytes, model, packet) == VelodyneFault::kNone) {
        std::array<std::uint8_t, kVelodyneDataBytes> again{};
        require(encode(packet, model, again) == again.size());
        require(std::equal(again.begin(), again.end(), bytes.begin()));
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    constexpr std::uint32_t kSensor = 1;
    ByteReader in(std::span<const std::uint8_t>(data, size));
    const auto model = static_cast<VelodyneModel>(in.byte() % 6);
    const auto calibration = nominal_calibration(model).value_or(VelodyneCalibration{});
    static const auto assembler = std::make_unique<std::optional<VelodyneAssembler>>();  // 4 MiB: made once
    // An HDL-64E without calibration would hear nothing else for 4096 packets.
    assembler->emplace(VelodyneParams{.model = model, .source_address = kSensor}, calibration);
    static const auto scan = std::make_unique<Scan>();
    const auto scanner = std::make_unique<VelodyneScanner>(VelodyneScanParams{}, model, calibration);
    static const auto obstacles = std::make_unique<ObstacleScanner>(ObstacleParams{}, LidarParams{});
    std::array<std::uint8_t, kVelodyneDataBytes> packet{};
    Stamp received{1000000000};
    std::uint64_t datagrams = 0;
    while (in.left() > 0) {
        const std::uint8_t kind = in.byte();
        received = received + Duration{std::int64_t{1000000} << (kind >> 4U)};
        std::span<const std::uint8_t> datagram = packet;
        if (kind % 4 == 0) {
            datagram = in.take(std::min(in.left(), kVelodyneDataBytes));
            std::copy(datagram.begin(), datagram.end(), packet.begin());
        } else if (kind % 4 == 1) {
            datagram = in.take(std::min(in.left(), kVelodynePositionBytes));
            static_cast<void>((*assembler)->on_position(datagram, kSensor));
            check_position(datagram);
            ++datagrams;
            continue;
        } else {
            for (int change = 0; change < kind % 4; ++change) {
                const std::size_t at = in.little<std::uint16_t>() % packet.size();
                packet[at] = in.byte();
            }
        }
        check_packet(datagram, model);
        ++datagrams;
        (*assembler)
            ->on_data(datagram, kind % 8 == 7 ? kSensor + 1 : kSensor, received, [&](const VelodyneCloud& cloud) {
                check(cloud);
                if (scanner->scan(cloud, VelodyneParams{}.cut_rad, *scan)) {
                    require(scan->count <= capacity::kBeams);
                }
                if (obstacles->scan(cloud, {}, *scan)) {
                    check(*scan);
                }
            });
    }
    require(sum((*assembler)->counters()) == datagrams);
    return 0;
}
