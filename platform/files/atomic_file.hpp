// Output files that appear whole or not at all.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "platform/files/unique_fd.hpp"

namespace crspf {

/// Writes beside the target and renames onto it at commit(), so that a reader, a crash or a full disk never meets half
/// a file; what stood there before stays until then. A target that exists and is no regular file (a pipe, /dev/stdout)
/// is written to directly. A symbolic link is followed.
///
/// Constructor, write() and commit() throw InputError naming the target, the cause and a remedy; the temporary file is
/// gone once this object is.
class AtomicFile {
 public:
    explicit AtomicFile(const std::filesystem::path& target);
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;
    ~AtomicFile();

    void write(std::string_view bytes);

    /// Everything on the disk and under its name. Without it, nothing happened. The last call.
    void commit();

 private:
    void create_temporary();
    void write_out(std::string_view bytes);
    [[noreturn]] void fail(int error) const;

    std::filesystem::path target_;
    std::filesystem::path temporary_;  ///< empty: none, or renamed
    UniqueFd fd_;
    std::string buffer_;
};

}  // namespace crspf
