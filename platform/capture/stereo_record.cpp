#include "platform/capture/stereo_record.hpp"

namespace crspf {

namespace {

constexpr std::size_t kLengthBytes = 4;

}  // namespace

std::optional<StereoRecord> split_stereo_record(std::span<const std::uint8_t> bytes) {
    if (bytes.size() < kLengthBytes) {
        return std::nullopt;
    }
    std::size_t left = 0;
    for (std::size_t i = 0; i < kLengthBytes; ++i) {
        left |= std::size_t{bytes[i]} << (8 * i);
    }
    bytes = bytes.subspan(kLengthBytes);
    if (left == 0 || left >= bytes.size()) {
        return std::nullopt;
    }
    return StereoRecord{.left_png = bytes.first(left), .right_png = bytes.subspan(left)};
}

void append_stereo_record(std::vector<std::uint8_t>& out, const StereoRecord& record) {
    for (std::size_t i = 0; i < kLengthBytes; ++i) {
        out.push_back(static_cast<std::uint8_t>(record.left_png.size() >> (8 * i)));
    }
    out.insert(out.end(), record.left_png.begin(), record.left_png.end());
    out.insert(out.end(), record.right_png.begin(), record.right_png.end());
}

}  // namespace crspf
