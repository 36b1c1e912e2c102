// What the tests of the CAN drivers share: the DBC files, logs, frames by hand.
#pragma once

#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <string>
#include <string_view>

#include "drivers/can/dbc_lookup.hpp"

namespace crspf::test {

inline std::string file_text(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    INFO(path.string());
    REQUIRE(in.good());
    return {std::istreambuf_iterator<char>(in), {}};
}

/// A DBC file of this repository.
inline std::string dbc_text(std::string_view name) {
    return file_text(std::filesystem::path(CRSPF_SOURCE_DIR) / "config" / name);
}

inline FrameSignal signal_of(std::string_view text, std::string_view message, std::string_view signal) {
    const DbcLookup found = find_signal(text, message, signal);
    INFO(message << '.' << signal << ' ' << found.error.line << ' '
                 << (found.error.reason != nullptr ? found.error.reason : ""));
    REQUIRE(found.status == DbcLookup::Status::kFound);
    return found.signal;
}

inline CanFrame make_frame(std::uint32_t id, std::initializer_list<unsigned> bytes, bool extended = false) {
    CanFrame out{.id = id, .extended = extended, .length = static_cast<std::uint8_t>(bytes.size())};
    std::transform(bytes.begin(), bytes.end(), out.data.begin(),
                   [](unsigned byte) { return static_cast<std::uint8_t>(byte); });
    return out;
}

}  // namespace crspf::test
