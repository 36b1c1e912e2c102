// Any line is read or refused with its column; what is read is written and read back to the same.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "drivers/can/candump_line.hpp"

namespace {

void require(bool promise) {
    if (!promise) {
        std::abort();
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text(data, data + size);
    const crspf::CandumpLine line = crspf::parse_candump_line(text);
    if (line.kind == crspf::CandumpLine::Kind::kBad) {
        require(line.column >= 1 && line.column <= size + 1 && line.reason != nullptr);
    }
    if (line.kind != crspf::CandumpLine::Kind::kFrame ||
        line.interface.find_first_of("\r\n") != std::string_view::npos) {
        return 0;
    }
    std::array<char, crspf::kCandumpLineMax> written{};
    const std::size_t length = crspf::format_candump_line(line, written);
    require(length > 0);
    const crspf::CandumpLine back = crspf::parse_candump_line({written.data(), length});
    require(back.kind == line.kind && back.frame == line.frame && back.stamp == line.stamp &&
            back.interface == line.interface && back.direction == line.direction);
    return 0;
}
