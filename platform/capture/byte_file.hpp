// A binary file, plain or compressed, in pieces of the reader's choice.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "platform/capture/unpacked_file.hpp"

namespace crspf {

class ByteFile {
 public:
    /// From the start of `file`: its first block is not yet consumed.
    explicit ByteFile(UnpackedFile file) : file_(std::move(file)), rest_(file_.block()) {}

    /// Appends the next `n` bytes to `into`. False, with what was left appended, at the end of the file.
    /// Throws InputError where the file cannot be read or unpacked further.
    bool read(std::size_t n, std::vector<std::uint8_t>& into);

    /// Of the unpacked content: how many bytes were read.
    [[nodiscard]] std::uint64_t offset() const { return offset_; }
    [[nodiscard]] double progress() const { return file_.progress(); }

    /// Throws InputError: "FILE: byte `at`: `reason`".
    [[noreturn]] void fail(std::uint64_t at, const std::string& reason) const;
    /// The same text.
    [[nodiscard]] std::string at(std::uint64_t at, const std::string& reason) const;

 private:
    UnpackedFile file_;
    std::string_view rest_;  ///< of the file's block
    std::uint64_t offset_ = 0;
};

}  // namespace crspf
