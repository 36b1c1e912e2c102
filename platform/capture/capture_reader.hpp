// Recorded traffic of sensors: who said what when, byte for byte, in the order of the file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/time.hpp"

namespace crspf {

/// What the bytes of a record are. Numbers: the registry of link types, https://www.tcpdump.org/linktypes.html
enum class LinkKind : std::uint8_t {
    kEthernet,      ///< 1: a frame, without its check sequence
    kRawIp,         ///< 101: an IP packet
    kLinuxCooked,   ///< 113: as `tcpdump -i any` wrote it
    kLinuxCooked2,  ///< 276: as it writes it now
    kCan,           ///< 227: a CAN frame (can_of())
    kStream,        ///< 147, for private use: here bytes of a serial line or a TCP connection
    kJournal,       ///< 148, for private use: here what a running service decided (journal.hpp)
    kStereo,  ///< 149, for private use: here a pair of pictures (stereo_record.hpp), stamped when they were exposed
    kOther,
};

enum class Direction : std::uint8_t { kUnknown, kReceived, kSent };

/// A port whose traffic was recorded.
struct CaptureSource {
    std::string name;         ///< "front", "can0" ...; may be empty
    std::string description;  ///< what and where it is; may be empty
    LinkKind link = LinkKind::kOther;

    friend bool operator==(const CaptureSource&, const CaptureSource&) = default;
};

struct CaptureRecord {
    /// [bytes] The largest that is written or read; what claims more is damage.
    static constexpr std::size_t kBytesMax = std::size_t{1} << 22U;

    std::uint32_t source = 0;  ///< index into sources()
    LinkKind link = LinkKind::kOther;
    Direction direction = Direction::kUnknown;
    bool cut = false;  ///< the capture kept the first bytes only
    Stamp stamp;       ///< since the recording's origin, mostly 1970 UTC; not necessarily increasing
    std::span<const std::uint8_t> bytes;
};

struct CaptureCounts {
    std::uint64_t records = 0;
    std::uint64_t ignored = 0;   ///< blocks without a record (statistics, names), lines that count drops
    std::uint64_t unusable = 0;  ///< records without a stamp or a source, damaged lines
    bool cut_short = false;      ///< the file ends within a record: its writer died; all before that was delivered
    std::string first_unusable;  ///< "FILE: byte N: reason" of the first one
};

class CaptureReader {
 public:
    virtual ~CaptureReader() = default;
    /// Fills `record`, whose bytes are valid until the next call; false at the end.
    /// Throws InputError with file and byte offset where the content is damaged or cannot be read on.
    virtual bool next(CaptureRecord& record) = 0;
    /// Those met so far: a file may add some on its way. Never shrinks.
    [[nodiscard]] virtual const std::vector<CaptureSource>& sources() const = 0;
    /// What the writer wrote about the whole; our own recordings hold their configuration. Empty before next().
    [[nodiscard]] virtual const std::string& comment() const = 0;
    [[nodiscard]] virtual const CaptureCounts& counts() const = 0;
    /// How far the reading has come, 0 to 1, by the compressed bytes consumed.
    [[nodiscard]] virtual double progress() const = 0;
    /// "pcapng", "pcap", "candump" or "folder of pictures".
    [[nodiscard]] virtual const char* format() const = 0;
};

/// Whether the file's content is one of the formats, or it is a folder of pictures (stereo_folder.hpp). Throws
/// InputError for a path that cannot be read.
[[nodiscard]] bool is_capture(const std::filesystem::path& file);

/// Opens a recording, plain or compressed, and recognises its format by content. Throws InputError for a path that
/// cannot be read, and for content that is none of the formats.
[[nodiscard]] std::unique_ptr<CaptureReader> open_capture(const std::filesystem::path& file);

}  // namespace crspf
