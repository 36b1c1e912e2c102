// Bytes as text (RFC 4648, base64 with padding).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace crspf {

[[nodiscard]] std::string to_base64(std::span<const std::uint8_t> bytes);
/// None where it is no base64.
[[nodiscard]] std::optional<std::vector<std::uint8_t>> from_base64(std::string_view text);

}  // namespace crspf
