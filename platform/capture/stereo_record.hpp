// A pair of pictures as a record of LinkKind::kStereo: the bytes of the left PNG, counted in 32 bits, little-endian;
// then the left PNG; then the right one.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace crspf {

struct StereoRecord {
    std::span<const std::uint8_t> left_png;
    std::span<const std::uint8_t> right_png;
};

/// Nothing where the lengths contradict each other or a picture is empty. What is returned views `bytes`.
[[nodiscard]] std::optional<StereoRecord> split_stereo_record(std::span<const std::uint8_t> bytes);

void append_stereo_record(std::vector<std::uint8_t>& out, const StereoRecord& record);

}  // namespace crspf
