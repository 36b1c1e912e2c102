// A text file line by line, plain or compressed, in bounded memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "platform/files/unique_fd.hpp"

struct archive;

namespace crspf {

/// gzip, bzip2, xz, lzma, zstd and lz4 are unpacked on the way, recognised by content.
class LineSource {
 public:
    static constexpr std::size_t kLineMax = std::size_t{1} << 20U;  ///< [bytes]

    struct Line {
        std::string_view text;  ///< without its end; valid until the next call of next()
        bool too_long = false;  ///< longer than kLineMax: passed over, `text` is empty
    };

    /// Throws InputError for a path that cannot be read and for an empty file.
    explicit LineSource(const std::filesystem::path& file);

    /// The first bytes of the content, up to some 64 KiB. Before the first next() only.
    [[nodiscard]] std::string_view peek() const { return block_; }

    /// False at the end. Throws InputError where the file cannot be read or unpacked further; the lines before that
    /// were delivered, a last one that is cut off there is not.
    bool next(Line& line);

    /// How much of the file is read, 0 to 1. 0 where the size is not known (a pipe).
    [[nodiscard]] double progress() const;

    /// Lines delivered.
    [[nodiscard]] std::uint64_t line_number() const { return line_number_; }

    [[nodiscard]] const std::string& name() const { return name_; }

 private:
    struct Closer {
        void operator()(archive* a) const;
    };

    /// The next block of unpacked bytes into block_; false at the end and, with failure_ set, on a failure.
    bool read_block();
    [[noreturn]] void fail() const;

    std::string name_;
    UniqueFd fd_;
    std::unique_ptr<archive, Closer> archive_;
    std::int64_t file_bytes_ = 0;
    std::string_view block_;  ///< unpacked, not yet delivered; in libarchive's memory
    std::string carry_;       ///< a line that began in an earlier block
    std::string failure_;
    std::uint64_t line_number_ = 0;
};

}  // namespace crspf
