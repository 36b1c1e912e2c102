#include "platform/capture/capture_reader.hpp"

#include "platform/capture/candump.hpp"
#include "platform/capture/pcap_reader.hpp"
#include "platform/capture/stereo_folder.hpp"
#include "platform/files/input_error.hpp"

namespace crspf {

bool is_capture(const std::filesystem::path& file) {
    if (is_stereo_folder(file)) {
        return true;
    }
    const UnpackedFile content(file);
    const auto block = content.block();
    return looks_like_pcapng(block) || looks_like_pcap(block) || looks_like_candump(block);
}

std::unique_ptr<CaptureReader> open_capture(const std::filesystem::path& file) {
    if (is_stereo_folder(file)) {
        return open_stereo_folder(file);
    }
    UnpackedFile content(file);
    if (!content.failure().empty()) {
        throw InputError(content.name() + ": byte 0: cannot be unpacked: " + content.failure() +
                         "; the file is damaged, copy it again");
    }
    if (looks_like_pcapng(content.block())) {
        return open_pcapng(std::move(content));
    }
    if (looks_like_pcap(content.block())) {
        return open_pcap(std::move(content));
    }
    if (looks_like_candump(content.block())) {
        return open_candump(std::move(content));
    }
    throw InputError(content.name() +
                     ": byte 0: neither pcapng nor pcap nor a candump log; give one of these, plain or compressed");
}

}  // namespace crspf
