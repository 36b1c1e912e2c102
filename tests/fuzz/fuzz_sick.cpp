// Whatever the bytes on a SICK lidar's line: the parsers, the decoders of scans and both sessions read none beyond
// their end, and what they pass can be turned into a Scan and written again.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>

#include "drivers/sick/lms2xx_scan.hpp"
#include "drivers/sick/lms2xx_session.hpp"
#include "drivers/sick/sick_device.hpp"
#include "drivers/sick/sick_session.hpp"

namespace {

using namespace crspf;

void require(bool promise) {
    if (!promise) {
        std::abort();
    }
}

struct Memory {
    LmdScandata data;
    LmdScandata back;
    Scan scan;
    std::array<std::uint8_t, kLargestColaPayload> payload{};
};

void check(const ColaTelegram& telegram, Memory& m) {
    if (!decode_lmd_scandata(telegram, m.data)) {
        return;
    }
    static_cast<void>(fill_scan(m.data, {}, Stamp{}, m.scan));
    const std::size_t size = encode_lmd_scandata(m.data, ColaDialect::kBinary, m.payload);
    if (size > 0) {
        require(decode_lmd_scandata({ColaDialect::kBinary, std::span(m.payload).first(size)}, m.back));
        require(m.back.telegram_counter == m.data.telegram_counter);
        for (std::size_t i = 0; i < std::size_t{m.data.channels16} + m.data.channels8; ++i) {
            const auto before = m.data.of(m.data.channel[i]);
            const auto after = m.back.of(m.back.channel[i]);
            require(m.back.channel[i] == m.data.channel[i]);
            require(std::equal(before.begin(), before.end(), after.begin(), after.end()));
        }
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    const std::span<const std::uint8_t> input(bytes, size);
    const auto m = std::make_unique<Memory>();

    const auto cola = std::make_unique<ColaParser>();
    const std::size_t cut = size == 0 ? 0 : bytes[0] % size;
    const auto on_telegram = [&](const ColaTelegram& telegram, Stamp) { check(telegram, *m); };
    cola->feed(input.first(cut), Stamp{}, on_telegram);
    cola->feed(input.subspan(cut), Stamp{}, on_telegram);
    check({ColaDialect::kBinary, input}, *m);
    check({ColaDialect::kAscii, input}, *m);

    const auto session = std::make_unique<SickSession>(SickParams{});
    session->on_open(Stamp{});
    for (std::size_t at = 0; at < size; at += 64) {
        session->on_bytes(input.subspan(at, size - at < 64 ? size - at : 64), Stamp{},
                          [](const LmdScandata&, const SickTiming&) {});
        static_cast<void>(session->next_output(Stamp{}));
    }
    const auto device = std::make_unique<SickDevice>(SickDeviceParams{}, Stamp{});
    device->on_bytes(input, Stamp{});

    const auto lms = std::make_unique<Lms2xxSession>(Lms2xxParams{});
    lms->on_open(Stamp{});
    Lms2xxParser parser;
    Lms2xxScan scan;
    parser.feed(input, Stamp{}, [&](const Lms2xxMessage& message, Stamp) {
        require(message.kind != Lms2xxMessage::Kind::kTelegram || !message.payload.empty());
        if (decode_lms2xx_scan(message.payload, scan)) {
            static_cast<void>(fill_lms2xx_scan(scan, 0x1FFF, {}, Stamp{}, m->scan));
        }
    });
    if (decode_lms2xx_scan(input, scan)) {
        const std::size_t written = encode_lms2xx_scan(scan, m->payload);
        require(written == size);
    }
    lms->on_bytes(input, Stamp{}, [](const Lms2xxScan&, Stamp) {});
    return 0;
}
