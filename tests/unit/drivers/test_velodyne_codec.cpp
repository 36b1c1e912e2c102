#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/rng.hpp"
#include "drivers/velodyne/velodyne_codec.hpp"

using namespace crspf;

namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr std::array kModels = {VelodyneModel::kVlp16,    VelodyneModel::kPuckHiRes, VelodyneModel::kHdl32e,
                                VelodyneModel::kHdl64eS2, VelodyneModel::kHdl64eS3,  VelodyneModel::kVlp32c};

VelodynePacket random_packet(Rng& rng, VelodyneModel model, bool dual) {
    VelodynePacket p;
    for (std::size_t b = 0; b < kVelodyneBlocks; ++b) {
        p.blocks[b].azimuth_cdeg =
            static_cast<std::uint16_t>(std::size_t{rng.next()} % 18000 * 2 + b / 2 % 2);  // blocks 0 and 2 differ
        if (b % 2 == 1 && (dual || is_hdl64e(model))) {
            p.blocks[b].azimuth_cdeg = p.blocks[b - 1].azimuth_cdeg;
        }
        for (std::size_t j = 0; j < kVelodyneReturns; ++j) {
            p.blocks[b].distance[j] = static_cast<std::uint16_t>(rng.next());
            p.blocks[b].reflectivity[j] = static_cast<std::uint8_t>(rng.next());
        }
    }
    p.stamp_us = rng.next() % kVelodyneHour_us;
    const std::uint8_t single = rng.next() % 2 == 0 ? kVelodyneStrongest : kVelodyneLast;
    p.mode = is_hdl64e(model) ? std::uint8_t{'G'} : dual ? kVelodyneDual : single;
    p.product = is_hdl64e(model) ? std::uint8_t{'A'} : product_of_model(model);
    return p;
}

Bytes bytes_of(const VelodynePacket& packet, VelodyneModel model) {
    Bytes bytes(kVelodyneDataBytes);
    REQUIRE(encode(packet, model, bytes) == kVelodyneDataBytes);
    return bytes;
}

VelodyneFault fault_of(const Bytes& bytes, VelodyneModel model = VelodyneModel::kVlp16) {
    VelodynePacket packet;
    return decode(bytes, model, packet);
}

Bytes sound() {
    Rng rng(7);
    return bytes_of(random_packet(rng, VelodyneModel::kVlp16, false), VelodyneModel::kVlp16);
}

Bytes position_bytes(std::string_view sentence, VelodynePps pps = VelodynePps::kLocked) {
    const Bytes text(sentence.begin(), sentence.end());
    Bytes bytes(kVelodynePositionBytes);
    REQUIRE(encode({.stamp_us = 1082341923, .pps = pps, .sentence = text}, bytes) == kVelodynePositionBytes);
    return bytes;
}

constexpr std::string_view kSentence =
    "$GPRMC,081802.00,A,3649.7478558,N,00224.4542928,W,0.034,212.5,210116,0.0,E,A*2E";

}  // namespace

TEST_CASE("velodyne: a million random returns of each model come back as they were sent") {
    Rng rng(20261125);
    for (const VelodyneModel model : kModels) {
        std::uint64_t wrong = 0;
        for (std::uint32_t i = 0; i < 1000000 / 384 + 1; ++i) {
            const VelodynePacket sent = random_packet(rng, model, i % 2 == 1);
            VelodynePacket got;
            wrong += decode(bytes_of(sent, model), model, got) != VelodyneFault::kNone || got != sent ? 1U : 0U;
        }
        CHECK(wrong == 0);
    }
}

TEST_CASE("velodyne: the layout of a packet") {
    VelodynePacket p;
    p.blocks[0].azimuth_cdeg = 0x1234;
    p.blocks[0].distance[1] = 0xABCD;
    p.blocks[0].reflectivity[1] = 0x5A;
    p.blocks[11].distance[31] = 0x0102;
    p.blocks[11].reflectivity[31] = 0x03;
    p.stamp_us = 3595704466U;  // the example of the HDL-64E's manual
    p.mode = kVelodyneStrongest;
    p.product = 0x22;
    const Bytes bytes = bytes_of(p, VelodyneModel::kVlp16);
    CHECK(bytes[0] == 0xFF);
    CHECK(bytes[1] == 0xEE);
    CHECK(bytes[2] == 0x34);
    CHECK(bytes[3] == 0x12);
    CHECK(bytes[7] == 0xCD);
    CHECK(bytes[8] == 0xAB);
    CHECK(bytes[9] == 0x5A);
    CHECK(bytes[1197] == 0x02);
    CHECK(bytes[1199] == 0x03);
    CHECK(bytes[1200] == 0x92);
    CHECK(bytes[1201] == 0x18);
    CHECK(bytes[1202] == 0x52);
    CHECK(bytes[1203] == 0xD6);
    CHECK(bytes[1204] == 0x37);
    CHECK(bytes[1205] == 0x22);
    const Bytes banks = bytes_of(p, VelodyneModel::kHdl64eS2);
    CHECK(banks[0] == 0xFF);
    CHECK(banks[1] == 0xEE);
    CHECK(banks[100] == 0xFF);
    CHECK(banks[101] == 0xDD);
    Bytes small(kVelodyneDataBytes - 1);
    CHECK(encode(p, VelodyneModel::kVlp16, small) == 0);
}

TEST_CASE("velodyne: what no sensor sends is refused, with its reason") {
    CHECK(fault_of(sound()) == VelodyneFault::kNone);
    Bytes bytes = sound();
    bytes.push_back(0);
    CHECK(fault_of(bytes) == VelodyneFault::kLength);
    CHECK(fault_of(Bytes(1205)) == VelodyneFault::kLength);
    CHECK(fault_of({}) == VelodyneFault::kLength);
    for (std::size_t block = 0; block < kVelodyneBlocks; ++block) {
        bytes = sound();
        bytes[100 * block + 1] = 0xDD;  // the lower bank: no VLP-16 has one
        CHECK(fault_of(bytes) == VelodyneFault::kFlag);
        bytes = sound();
        bytes[100 * block + 2] = 0xA0;  // 36000
        bytes[100 * block + 3] = 0x8C;
        CHECK(fault_of(bytes) == VelodyneFault::kAzimuth);
        bytes[100 * block + 2] = 0x9F;  // 35999
        CHECK(fault_of(bytes) == VelodyneFault::kNone);
    }
    bytes = sound();
    std::fill_n(bytes.begin() + 1200, 4, std::uint8_t{0xFF});
    CHECK(fault_of(bytes) == VelodyneFault::kStamp);
    bytes = sound();
    bytes[1204] = 0x3A;
    CHECK(fault_of(bytes) == VelodyneFault::kMode);
    CHECK(fault_of(sound(), VelodyneModel::kHdl32e) == VelodyneFault::kModel);
    CHECK(fault_of(sound(), VelodyneModel::kHdl64eS2) == VelodyneFault::kFlag);
    bytes = sound();
    bytes[1204] = kVelodyneDual;  // whose blocks then have to come in pairs
    CHECK(fault_of(bytes) == VelodyneFault::kAzimuth);
    // A silent tail is an HDL-32E of old, and no other.
    bytes[1204] = 0;
    bytes[1205] = 0;
    CHECK(fault_of(bytes, VelodyneModel::kHdl32e) == VelodyneFault::kNone);
    CHECK(fault_of(bytes, VelodyneModel::kVlp16) == VelodyneFault::kModel);
}

TEST_CASE("velodyne: two returns of an HDL-64E, which nobody described, are refused") {
    Rng rng(3);
    VelodynePacket p = random_packet(rng, VelodyneModel::kHdl64eS3, false);
    REQUIRE(fault_of(bytes_of(p, VelodyneModel::kHdl64eS3), VelodyneModel::kHdl64eS3) == VelodyneFault::kNone);
    p.blocks[2].azimuth_cdeg = p.blocks[0].azimuth_cdeg;
    p.blocks[3].azimuth_cdeg = p.blocks[0].azimuth_cdeg;
    CHECK(fault_of(bytes_of(p, VelodyneModel::kHdl64eS3), VelodyneModel::kHdl64eS3) == VelodyneFault::kMode);
}

TEST_CASE("velodyne: a position packet") {
    const Bytes bytes = position_bytes(kSentence);
    CHECK(bytes[0xC6] == (1082341923U & 0xFFU));
    CHECK(bytes[0xCA] == 2);
    CHECK(bytes[0xCE] == '$');
    CHECK(bytes[0xCE + kSentence.size()] == '\r');
    VelodynePosition position;
    REQUIRE(decode(bytes, position) == VelodyneFault::kNone);
    CHECK(position.stamp_us == 1082341923);
    CHECK(position.pps == VelodynePps::kLocked);
    CHECK(std::string(position.sentence.begin(), position.sentence.end()) == kSentence);
    CHECK(position.fix);

    // Without a receiver the sentence is empty, and that is no fault.
    REQUIRE(decode(position_bytes("", VelodynePps::kNone), position) == VelodyneFault::kNone);
    CHECK(position.sentence.empty());
    CHECK_FALSE(position.fix);
    // Without satellites it says V.
    REQUIRE(decode(position_bytes("$GPRMC,,V,,,,,,,,,,N*53"), position) == VelodyneFault::kNone);
    CHECK_FALSE(position.fix);
}

TEST_CASE("velodyne: position packets that are refused") {
    VelodynePosition position;
    for (std::size_t i = 1; i < kSentence.size(); ++i) {
        std::string damaged(kSentence);
        damaged[i] = static_cast<char>(damaged[i] ^ 1);
        INFO(damaged);
        CHECK(decode(position_bytes(damaged), position) == VelodyneFault::kSentence);
    }
    CHECK(decode(position_bytes(kSentence.substr(0, kSentence.size() - 1)), position) == VelodyneFault::kSentence);
    CHECK(decode(position_bytes("$GPRMC,"), position) == VelodyneFault::kSentence);
    CHECK(decode(position_bytes("$GPGGA,,,*7A"), position) == VelodyneFault::kSentence);
    Bytes bytes = position_bytes(kSentence);
    bytes[0xCA] = 4;
    CHECK(decode(bytes, position) == VelodyneFault::kPps);
    bytes = position_bytes(kSentence);
    bytes[0xC9] = 0xFF;
    CHECK(decode(bytes, position) == VelodyneFault::kStamp);
    bytes.pop_back();
    CHECK(decode(bytes, position) == VelodyneFault::kLength);
    const Bytes endless(305, 'x');
    Bytes room(kVelodynePositionBytes);
    CHECK(encode({.sentence = endless}, room) == 0);
}
