// Whatever a line of a candump log says: a frame that a bus can carry and that survives being recorded, or a reason.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "platform/capture/candump.hpp"
#include "platform/capture/frames.hpp"

namespace {

void require(bool promise) {
    if (!promise) {
        std::abort();
    }
}

void check_line(std::string_view text) {
    crspf::CandumpLine line;
    if (crspf::parse_candump_line(text, line) != nullptr) {
        return;
    }
    require(line.stamp.ns >= 0 && !line.interface.empty() && is_valid(line.frame));
    std::vector<std::uint8_t> bytes;
    crspf::CanFrame read;
    require(append_can_frame(bytes, line.frame));
    require(can_of(crspf::LinkKind::kCan, bytes, read) == crspf::FrameContent::kFound);
    require(read == line.frame);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes as text
    std::string_view text(reinterpret_cast<const char*>(data), size);
    static_cast<void>(crspf::looks_like_candump(text));
    while (!text.empty()) {
        const std::size_t end = text.find('\n');
        check_line(text.substr(0, end));
        text.remove_prefix(end == text.npos ? text.size() : end + 1);
    }
    return 0;
}
