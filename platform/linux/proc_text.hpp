// The small texts of /proc and /sys.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace crspf {

/// The first 64 KiB of a file without the blanks at its end; empty where it cannot be read. Never waits.
[[nodiscard]] std::optional<std::string> read_text(const std::filesystem::path& file);

/// The word after `label` in the line that begins with it: "16384" for "MemFree:" of "MemFree:   16384 kB".
[[nodiscard]] std::string_view word_after(std::string_view text, std::string_view label);

/// A number in the given base, or "unlimited", which is the greatest. Empty for anything else.
[[nodiscard]] std::optional<std::uint64_t> to_number(std::string_view word, int base = 10);

/// "0-3,8" is 0, 1, 2, 3, 8. Empty for anything that is no such list.
[[nodiscard]] std::vector<int> parse_cpu_list(std::string_view text);

}  // namespace crspf
