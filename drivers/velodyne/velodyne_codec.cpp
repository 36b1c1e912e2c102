#include "drivers/velodyne/velodyne_codec.hpp"

#include <algorithm>

#include "drivers/common/byte_reader.hpp"
#include "drivers/common/byte_writer.hpp"

namespace crspf {
namespace {

constexpr std::uint16_t kUpperBank = 0xEEFF;  // the only one of the sensors with up to 32 lasers
constexpr std::uint16_t kLowerBank = 0xDDFF;
constexpr std::size_t kReturnBytes = 3;
constexpr std::size_t kUnusedBeforeStamp = 198;
constexpr std::size_t kUnusedAfterPps = 3;
constexpr std::size_t kSentenceAt = 206;
constexpr std::size_t kSentenceRoom = kVelodynePositionBytes - kSentenceAt;

constexpr std::uint16_t flag_of(VelodyneModel model, std::size_t block) {
    return is_hdl64e(model) && block % 2 == 1 ? kLowerBank : kUpperBank;
}

VelodyneFault check_tail(VelodyneModel model, const VelodynePacket& packet) {
    if (packet.stamp_us >= kVelodyneHour_us) {
        return VelodyneFault::kStamp;
    }
    if (is_hdl64e(model)) {
        // Four blocks of one azimuth: two returns of two banks.
        return packet.blocks[0].azimuth_cdeg == packet.blocks[2].azimuth_cdeg ? VelodyneFault::kMode
                                                                              : VelodyneFault::kNone;
    }
    const bool says_nothing = packet.mode == 0 && packet.product == 0 && model == VelodyneModel::kHdl32e;
    if (!says_nothing && packet.product != product_of_model(model)) {
        return VelodyneFault::kModel;
    }
    if (!says_nothing && (packet.mode < kVelodyneStrongest || packet.mode > kVelodyneDual)) {
        return VelodyneFault::kMode;
    }
    return VelodyneFault::kNone;
}

VelodyneFault check_pairs(const VelodynePacket& packet) {
    for (std::size_t b = 0; b < kVelodyneBlocks; b += 2) {
        if (packet.blocks[b].azimuth_cdeg != packet.blocks[b + 1].azimuth_cdeg) {
            return VelodyneFault::kAzimuth;
        }
    }
    return VelodyneFault::kNone;
}

constexpr int hex_digit(std::uint8_t c) {
    if (c >= '0' && c <= '9') {
        return c - '0';
    }
    if (c >= 'A' && c <= 'F') {
        return c - 'A' + 10;
    }
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

/// `sentence` from '$' to the second digit of the checksum.
bool checksum_holds(std::span<const std::uint8_t> sentence) {
    if (sentence.size() < 4 || sentence[sentence.size() - 3] != '*') {
        return false;
    }
    std::uint8_t sum = 0;
    for (const std::uint8_t c : sentence.subspan(1, sentence.size() - 4)) {
        sum ^= c;
    }
    const int high = hex_digit(sentence[sentence.size() - 2]);
    const int low = hex_digit(sentence[sentence.size() - 1]);
    return high >= 0 && low >= 0 && high * 16 + low == sum;
}

/// The second field, after the time: 'A' for active.
bool is_active(std::span<const std::uint8_t> sentence) {
    std::size_t commas = 0;
    for (std::size_t i = 0; i + 1 < sentence.size(); ++i) {
        commas += sentence[i] == ',' ? 1U : 0U;
        if (commas == 2) {
            return sentence[i + 1] == 'A';
        }
    }
    return false;
}

}  // namespace

VelodyneFault decode(std::span<const std::uint8_t> payload, VelodyneModel model, VelodynePacket& out) {
    if (payload.size() != kVelodyneDataBytes) {
        return VelodyneFault::kLength;
    }
    ByteReader in(payload);
    for (std::size_t b = 0; b < kVelodyneBlocks; ++b) {
        VelodyneBlock& block = out.blocks[b];
        if (in.little<std::uint16_t>() != flag_of(model, b)) {
            return VelodyneFault::kFlag;
        }
        block.azimuth_cdeg = in.little<std::uint16_t>();
        if (block.azimuth_cdeg >= kVelodyneTurn_cdeg) {
            return VelodyneFault::kAzimuth;
        }
        // One check of the end for the whole block: it is there, by the datagram's length.
        const std::span<const std::uint8_t> returns = in.take(kReturnBytes * kVelodyneReturns);
        for (std::size_t j = 0; j < kVelodyneReturns; ++j) {
            const std::uint8_t* const at = returns.data() + kReturnBytes * j;
            block.distance[j] = static_cast<std::uint16_t>(at[0] | at[1] << 8U);
            block.reflectivity[j] = at[2];
        }
    }
    out.stamp_us = in.little<std::uint32_t>();
    out.mode = in.byte();
    out.product = in.byte();
    const VelodyneFault fault = check_tail(model, out);
    if (fault != VelodyneFault::kNone) {
        return fault;
    }
    return is_hdl64e(model) || is_dual(model, out) ? check_pairs(out) : VelodyneFault::kNone;
}

std::size_t encode(const VelodynePacket& packet, VelodyneModel model, std::span<std::uint8_t> out) {
    if (out.size() < kVelodyneDataBytes) {
        return 0;
    }
    ByteWriter writer(out);
    for (std::size_t b = 0; b < kVelodyneBlocks; ++b) {
        const VelodyneBlock& block = packet.blocks[b];
        writer.little(flag_of(model, b));
        writer.little(block.azimuth_cdeg);
        for (std::size_t j = 0; j < kVelodyneReturns; ++j) {
            writer.little(block.distance[j]);
            writer.byte(block.reflectivity[j]);
        }
    }
    writer.little(packet.stamp_us);
    writer.byte(packet.mode);
    writer.byte(packet.product);
    return writer.position();
}

VelodyneFault decode(std::span<const std::uint8_t> payload, VelodynePosition& out) {
    if (payload.size() != kVelodynePositionBytes) {
        return VelodyneFault::kLength;
    }
    ByteReader in(payload);
    in.skip(kUnusedBeforeStamp);
    out.stamp_us = in.little<std::uint32_t>();
    const std::uint8_t pps = in.byte();
    in.skip(kUnusedAfterPps);
    if (out.stamp_us >= kVelodyneHour_us) {
        return VelodyneFault::kStamp;
    }
    if (pps > static_cast<std::uint8_t>(VelodynePps::kError)) {
        return VelodyneFault::kPps;
    }
    out.pps = static_cast<VelodynePps>(pps);
    const std::span<const std::uint8_t> text = in.take(kSentenceRoom);
    const auto end = std::find_if(text.begin(), text.end(), [](std::uint8_t c) { return c < ' '; });
    out.sentence = text.first(static_cast<std::size_t>(end - text.begin()));
    out.fix = false;
    if (out.sentence.empty()) {
        return VelodyneFault::kNone;
    }
    constexpr std::array<std::uint8_t, 7> kHead = {'$', 'G', 'P', 'R', 'M', 'C', ','};
    const bool rmc = out.sentence.size() > kHead.size() && std::equal(kHead.begin(), kHead.end(), out.sentence.begin());
    if (!rmc || !checksum_holds(out.sentence)) {
        return VelodyneFault::kSentence;
    }
    out.fix = is_active(out.sentence);
    return VelodyneFault::kNone;
}

std::size_t encode(const VelodynePosition& position, std::span<std::uint8_t> out) {
    constexpr std::array<std::uint8_t, 2> kEndOfLine = {'\r', '\n'};
    if (out.size() < kVelodynePositionBytes || position.sentence.size() + kEndOfLine.size() > kSentenceRoom) {
        return 0;
    }
    std::fill_n(out.begin(), kVelodynePositionBytes, std::uint8_t{0});
    ByteWriter writer(out.subspan(kUnusedBeforeStamp));
    writer.little(position.stamp_us);
    writer.byte(static_cast<std::uint8_t>(position.pps));
    if (!position.sentence.empty()) {
        ByteWriter text(out.subspan(kSentenceAt));
        text.bytes(position.sentence);
        text.bytes(kEndOfLine);
    }
    return kVelodynePositionBytes;
}

}  // namespace crspf
