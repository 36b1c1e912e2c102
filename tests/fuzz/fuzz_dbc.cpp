// Any text reads to its end or to an error with its place; whatever signal it delivers fits its message, and decodes.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "drivers/can/dbc_lookup.hpp"
#include "drivers/can/dbc_reader.hpp"

namespace {

void require(bool promise) {
    if (!promise) {
        std::abort();
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text(data, data + size);
    crspf::DbcReader reader(text);
    std::string_view message;
    std::string_view signal;
    bool in_first = false;  // of two messages of one name the first counts
    std::array<std::uint8_t, 1785> payload{};
    while (true) {
        const crspf::DbcReader::Item item = reader.next();
        if (item == crspf::DbcReader::Item::kEnd) {
            break;
        }
        if (item == crspf::DbcReader::Item::kError) {
            require(reader.error().line >= 1 && reader.error().column >= 1 && reader.error().reason != nullptr);
            require(crspf::find_signal(text, "a", "b").status == crspf::DbcLookup::Status::kBadText);
            return 0;
        }
        if (item == crspf::DbcReader::Item::kMessage) {
            in_first = message.empty();
            message = in_first ? reader.message().name : message;
        }
        if (item == crspf::DbcReader::Item::kSignal) {
            const crspf::CanSignal& layout = reader.signal().layout;
            require(!reader.signal().name.empty());
            require(crspf::fits(layout, reader.message().bytes));
            crspf::insert_bits(layout, payload, ~std::uint64_t{0});
            require(crspf::decode(layout, payload).has_value());
            signal = signal.empty() && in_first ? reader.signal().name : signal;
        }
    }
    if (!signal.empty()) {
        const auto status = crspf::find_signal(text, message, signal).status;
        require(status != crspf::DbcLookup::Status::kNoMessage && status != crspf::DbcLookup::Status::kNoSignal &&
                status != crspf::DbcLookup::Status::kBadText);
    }
    return 0;
}
