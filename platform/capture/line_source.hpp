// A text file line by line, plain or compressed, in bounded memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "platform/capture/unpacked_file.hpp"

namespace crspf {

/// Compressed files are unpacked on the way (unpacked_file.hpp).
class LineSource {
 public:
    static constexpr std::size_t kLineMax = std::size_t{1} << 20U;  ///< [bytes]

    struct Line {
        std::string_view text;  ///< without its end; valid until the next call of next()
        bool too_long = false;  ///< longer than kLineMax: passed over, `text` is empty
    };

    /// Throws InputError for a path that cannot be read and for an empty file.
    explicit LineSource(const std::filesystem::path& file) : LineSource(UnpackedFile(file)) {}

    /// From the start of `file`: its first block is not yet consumed. Throws InputError where that could not be read.
    explicit LineSource(UnpackedFile file);

    /// The first bytes of the content, up to some 64 KiB. Before the first next() only.
    [[nodiscard]] std::string_view peek() const { return block_; }

    /// False at the end. Throws InputError where the file cannot be read or unpacked further; the lines before that
    /// were delivered, a last one that is cut off there is not.
    bool next(Line& line);

    /// How much of the file is read, 0 to 1. 0 where the size is not known (a pipe).
    [[nodiscard]] double progress() const { return file_.progress(); }

    /// Lines delivered.
    [[nodiscard]] std::uint64_t line_number() const { return line_number_; }

    [[nodiscard]] const std::string& name() const { return file_.name(); }

 private:
    /// The next block into block_; false at the end and on a failure.
    bool read_block();
    [[noreturn]] void fail() const;

    UnpackedFile file_;
    std::string_view block_;  ///< what is not yet delivered of the file's block
    std::string carry_;       ///< a line that began in an earlier block
    std::uint64_t line_number_ = 0;
};

}  // namespace crspf
