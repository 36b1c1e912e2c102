// Records what the ports hear and say, into pcapng files that follow each other.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "platform/capture/capture_reader.hpp"
#include "platform/files/unique_fd.hpp"

namespace crspf {

/// [bytes] that whoever is not root may still write where `directory` lies; 0 where that cannot be told.
[[nodiscard]] std::uint64_t free_bytes_of(const std::filesystem::path& directory);

struct RecorderParams {
    std::filesystem::path directory;  ///< there, and writable
    std::string prefix = "crspf";     ///< files are PREFIX-20231114T221320Z.pcapng, by the first record
    std::uint64_t file_bytes_max = std::uint64_t{1} << 28U;  ///< [bytes] a file ends before it would grow beyond
    Duration file_time_max{600'000'000'000};                 ///< and after this time of records
    std::uint64_t free_bytes_min = std::uint64_t{1} << 30U;  ///< [bytes] left to the others on the disk
    Duration sync_interval{5'000'000'000};  ///< what a power cut may cost; a crash of ours costs a second
    /// From the stamps of the records to 1970 UTC, in which files are written.
    Duration utc_minus_stamp{};
};

/// Counters never fall. Each record appended is in exactly one of the first three, or still in the buffer.
struct RecorderCounters {
    std::uint64_t written = 0;
    std::uint64_t refused = 0;  ///< too long, before 1970, or of no source
    std::uint64_t lost = 0;     ///< while the disk was full or failed
    std::uint64_t files = 0;
};

/// One thread's; waits for the disk, so not that of a control loop. Keeps time by the stamps of the records and reads
/// no clock. A disk that is full or fails pauses the recording: records are counted as lost, and a new file is tried
/// once a second. What is on the disk is readable up to its last whole record at any time.
class Recorder {
 public:
    using FreeBytes = std::function<std::uint64_t(const std::filesystem::path&)>;

    /// `comment` stands at the head of each file: the configuration. Throws InputError where recording is not possible:
    /// no directory, no space, texts longer than the format holds.
    Recorder(RecorderParams params, const std::vector<CaptureSource>& sources, std::string_view comment,
             FreeBytes free_bytes = free_bytes_of);
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;
    ~Recorder();

    /// `source` is an index into the constructor's. False where the record is refused or lost, or where one before it
    /// turned out to be.
    bool append(std::uint32_t source, Direction direction, Stamp stamp, std::span<const std::uint8_t> bytes);

    /// What is in the buffer goes to the disk and stays there. For a pause of the sensors; the destructor does it, too.
    bool flush();

    [[nodiscard]] const RecorderCounters& counters() const { return counters_; }
    /// "PATH: reason; remedy" of what makes the recording pause; empty while it runs.
    [[nodiscard]] const std::string& problem() const { return problem_; }
    /// The file that is being written; empty while there is none.
    [[nodiscard]] const std::filesystem::path& file() const { return file_; }

 private:
    static constexpr Stamp kAnyTime{std::numeric_limits<std::int64_t>::min()};

    [[nodiscard]] bool has_space();
    bool start_file(Stamp stamp);
    bool end_file();
    bool write_out();
    bool sync();
    void fail(const std::filesystem::path& path, int error);
    void pause();

    RecorderParams params_;
    FreeBytes free_bytes_;
    std::size_t source_count_;
    std::vector<std::uint8_t> head_;  ///< of each file: section and sources
    RecorderCounters counters_;
    std::string problem_;

    UniqueFd fd_;
    std::filesystem::path file_;
    std::uint64_t file_bytes_ = 0;  ///< on the disk, all of them whole blocks
    std::vector<std::uint8_t> buffer_;
    std::uint64_t buffered_records_ = 0;
    Stamp file_begin_;
    Stamp last_write_;
    Stamp last_sync_;
    Stamp latest_;
    Stamp retry_ = kAnyTime;  ///< when a new file is tried
};

}  // namespace crspf
