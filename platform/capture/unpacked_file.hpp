// The content of a file block by block, plain or compressed, in bounded memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "platform/files/unique_fd.hpp"

struct archive;

namespace crspf {

/// gzip, bzip2, xz, lzma, zstd and lz4 are unpacked on the way, recognised by content.
class UnpackedFile {
 public:
    /// Reads the first block. Throws InputError for a path that cannot be read and for an empty file.
    explicit UnpackedFile(const std::filesystem::path& file);

    /// The block read last, up to some 64 KiB; empty at the end. Valid until the next read_block().
    [[nodiscard]] std::string_view block() const { return block_; }

    /// False at the end and, with failure() set, where the file cannot be read or unpacked further.
    bool read_block();

    /// Why the reading stopped before the end; empty if it did not.
    [[nodiscard]] const std::string& failure() const { return failure_; }

    /// How much of the file is read, 0 to 1. 0 where the size is not known (a pipe).
    [[nodiscard]] double progress() const;

    [[nodiscard]] const std::string& name() const { return name_; }

 private:
    struct Closer {
        void operator()(archive* a) const;
    };

    std::string name_;
    UniqueFd fd_;
    std::unique_ptr<archive, Closer> archive_;
    std::int64_t file_bytes_ = 0;
    std::string_view block_;  ///< in libarchive's memory
    std::string failure_;
};

}  // namespace crspf
