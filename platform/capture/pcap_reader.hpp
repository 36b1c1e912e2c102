// Readers of the two formats of packet captures.
#pragma once

#include <memory>
#include <string_view>

#include "platform/capture/capture_reader.hpp"
#include "platform/capture/unpacked_file.hpp"

namespace crspf {

/// By the first bytes of a content.
[[nodiscard]] bool looks_like_pcapng(std::string_view content);
[[nodiscard]] bool looks_like_pcap(std::string_view content);

/// pcapng: sections of either byte order, interface descriptions and enhanced packets; every resolution and offset of
/// stamps. Other blocks are passed over and counted.
[[nodiscard]] std::unique_ptr<CaptureReader> open_pcapng(UnpackedFile file);

/// Classic pcap: stamps in microseconds or nanoseconds, either byte order.
[[nodiscard]] std::unique_ptr<CaptureReader> open_pcap(UnpackedFile file);

}  // namespace crspf
