// Whatever the bytes of a capture: records that keep their promises, counters, or an InputError; and whatever the bytes
// of a frame: a payload inside it.
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <string>

#include "platform/capture/capture_reader.hpp"
#include "platform/capture/frames.hpp"
#include "platform/files/input_error.hpp"

namespace {

using crspf::FrameContent;
using crspf::LinkKind;

void require(bool promise) {
    if (!promise) {
        std::abort();
    }
}

// The bytes as a file that lies in memory only.
std::string file_of(const std::uint8_t* data, std::size_t size) {
    static const int fd = memfd_create("fuzz_pcapng", MFD_CLOEXEC);
    require(fd >= 0 && ftruncate(fd, 0) == 0 && pwrite(fd, data, size, 0) == static_cast<ssize_t>(size));
    return "/proc/self/fd/" + std::to_string(fd);
}

bool within(std::span<const std::uint8_t> part, std::span<const std::uint8_t> whole) {
    const std::less_equal<> before;
    return part.empty() ||
           (before(whole.data(), part.data()) && before(part.data() + part.size(), whole.data() + whole.size()));
}

void check_frame(LinkKind link, std::span<const std::uint8_t> bytes) {
    crspf::UdpDatagram datagram;
    if (udp_of(link, bytes, datagram) == FrameContent::kFound) {
        require(within(datagram.payload, bytes));
    }
    crspf::CanFrame frame;
    if (can_of(link, bytes, frame) == FrameContent::kFound) {
        require(is_valid(frame));
    }
}

void read_all(crspf::CaptureReader& reader) {
    std::uint64_t records = 0;
    for (crspf::CaptureRecord record; reader.next(record); ++records) {
        require(record.source < reader.sources().size());
        require(record.link == reader.sources()[record.source].link);
        require(record.bytes.size() <= crspf::CaptureRecord::kBytesMax);
        check_frame(record.link, record.bytes);
        require(reader.progress() >= 0.0 && reader.progress() <= 1.0);
    }
    require(reader.counts().records == records);
    require((reader.counts().unusable == 0) == reader.counts().first_unusable.empty());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    for (const LinkKind link :
         {LinkKind::kEthernet, LinkKind::kRawIp, LinkKind::kLinuxCooked, LinkKind::kLinuxCooked2, LinkKind::kCan}) {
        check_frame(link, {data, size});
    }
    try {
        read_all(*crspf::open_capture(file_of(data, size)));
    } catch (const crspf::InputError& e) {
        require(std::string(e.what()).starts_with("/proc/self/fd/"));
    }
    return 0;
}
