#include "drivers/sick/lms2xx_codec.hpp"

#include "drivers/common/byte_reader.hpp"
#include "drivers/common/byte_writer.hpp"

namespace crspf {
namespace {

constexpr std::uint8_t kToSensor = 0x00;
constexpr std::uint8_t kModeCommand = 0x20;
constexpr std::uint8_t kStatusCommand = 0x31;
constexpr std::uint8_t kVariantCommand = 0x3B;
constexpr std::uint8_t kScanReply = 0xB0;
constexpr unsigned kCountMask = 0x03FF;
constexpr unsigned kPartialShift = 11;
constexpr unsigned kPartialFlag = 0x2000;
constexpr unsigned kUnitShift = 14;

}  // namespace

std::uint16_t lms2xx_crc(std::span<const std::uint8_t> bytes) {
    std::uint32_t crc = 0;
    std::uint32_t previous = 0;
    for (const std::uint8_t byte : bytes) {
        crc = (crc & 0x8000U) != 0 ? ((crc & 0x7FFFU) << 1U) ^ 0x8005U : crc << 1U;
        crc ^= byte | (previous << 8U);
        previous = byte;
    }
    return static_cast<std::uint16_t>(crc);
}

std::size_t encode_lms2xx(std::uint8_t address, std::span<const std::uint8_t> payload, std::span<std::uint8_t> out) {
    if (payload.size() > kLargestLms2xxPayload) {
        return 0;
    }
    ByteWriter writer(out);
    writer.byte(kLms2xxStart);
    writer.byte(address);
    writer.little(static_cast<std::uint16_t>(payload.size()));
    writer.bytes(payload);
    if (writer.ok()) {
        writer.little(lms2xx_crc(writer.written()));
    }
    return writer.ok() ? writer.position() : 0;
}

std::size_t encode_lms2xx_mode(Lms2xxMode mode, std::span<std::uint8_t> out) {
    std::array<std::uint8_t, 10> payload{
        kModeCommand, static_cast<std::uint8_t>(mode), 'S', 'I', 'C', 'K', '_', 'L', 'M', 'S'};
    const std::size_t size = mode == Lms2xxMode::kInstallation ? payload.size() : 2;
    return encode_lms2xx(kToSensor, std::span(payload).first(size), out);
}

std::size_t encode_lms2xx_variant(const Lms2xxVariant& variant, std::span<std::uint8_t> out) {
    std::array<std::uint8_t, 5> payload{};
    ByteWriter writer(payload);
    writer.byte(kVariantCommand);
    writer.little(variant.angle_deg);
    writer.little(variant.resolution_cdeg);
    return encode_lms2xx(kToSensor, payload, out);
}

std::size_t encode_lms2xx_status_request(std::span<std::uint8_t> out) {
    return encode_lms2xx(kToSensor, std::array<std::uint8_t, 1>{kStatusCommand}, out);
}

bool mode_of_baud(std::uint32_t baud, Lms2xxMode& mode) {
    switch (baud) {
        case 9600: mode = Lms2xxMode::kBaud9600; return true;
        case 19200: mode = Lms2xxMode::kBaud19200; return true;
        case 38400: mode = Lms2xxMode::kBaud38400; return true;
        case 500000: mode = Lms2xxMode::kBaud500000; return true;
        default: return false;
    }
}

bool decode_lms2xx_scan(std::span<const std::uint8_t> payload, Lms2xxScan& scan) {
    ByteReader in(payload);
    const bool is_scan = in.byte() == kScanReply;
    const unsigned header = in.little<std::uint16_t>();
    scan.count = static_cast<std::uint16_t>(header & kCountMask);
    scan.partial = (header & kPartialFlag) != 0;
    scan.partial_index = static_cast<std::uint8_t>((header >> kPartialShift) & 3U);
    const unsigned unit = header >> kUnitShift;
    if (!is_scan || unit > 1 || scan.count == 0 || scan.count > scan.values.size()) {
        return false;
    }
    scan.unit = static_cast<Lms2xxScan::Unit>(unit);
    for (std::size_t i = 0; i < scan.count; ++i) {
        scan.values[i] = in.little<std::uint16_t>();
    }
    if (!in.ok() || in.left() < 1 || in.left() > 1 + scan.index.size()) {
        return false;
    }
    scan.indices = static_cast<std::uint8_t>(in.left() - 1);
    for (std::size_t i = 0; i < scan.indices; ++i) {
        scan.index[i] = in.byte();
    }
    scan.status = in.byte();
    return in.ok();
}

std::size_t encode_lms2xx_scan(const Lms2xxScan& scan, std::span<std::uint8_t> payload) {
    if (scan.count > scan.values.size() || scan.indices > scan.index.size()) {
        return 0;
    }
    ByteWriter out(payload);
    out.byte(kScanReply);
    out.little(static_cast<std::uint16_t>(scan.count | (scan.partial ? kPartialFlag : 0U) |
                                          (static_cast<unsigned>(scan.partial_index) << kPartialShift) |
                                          (static_cast<unsigned>(scan.unit) << kUnitShift)));
    for (std::size_t i = 0; i < scan.count; ++i) {
        out.little(scan.values[i]);
    }
    for (std::size_t i = 0; i < scan.indices; ++i) {
        out.byte(scan.index[i]);
    }
    out.byte(scan.status);
    return out.ok() ? out.position() : 0;
}

bool variant_of_count(std::uint16_t count, Lms2xxVariant& variant) {
    switch (count) {
        case 101: variant = {100, 100}; return true;
        case 201: variant = {100, 50}; return true;
        case 401: variant = {100, 25}; return true;
        case 181: variant = {180, 100}; return true;
        case 361: variant = {180, 50}; return true;
        default: return false;
    }
}

}  // namespace crspf
