#include "platform/capture/unpacked_file.hpp"

#include <archive.h>
#include <archive_entry.h>
#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "platform/files/input_error.hpp"

namespace crspf {
namespace {

constexpr std::size_t kReadBytes = 65536;

// libarchive fails without a word on some broken input.
std::string reason(archive* a) {
    const char* const text = archive_error_string(a);
    return text != nullptr ? text : "its compressed data are broken";
}

}  // namespace

void UnpackedFile::Closer::operator()(archive* a) const {
    archive_read_free(a);
}

UnpackedFile::UnpackedFile(const std::filesystem::path& file)
    : name_(file.string()), fd_(::open(file.c_str(), O_RDONLY | O_CLOEXEC)), archive_(archive_read_new()) {
    struct stat status {};
    if (!fd_.valid() || ::fstat(fd_.get(), &status) != 0 || S_ISDIR(status.st_mode)) {
        const int error = fd_.valid() && S_ISDIR(status.st_mode) ? EISDIR : errno;
        throw InputError(name_ + ": cannot be read: " + std::generic_category().message(error) +
                         "; check the path and its permissions");
    }
    file_bytes_ = status.st_size;
    archive* const a = archive_.get();
    // Not archive_read_support_filter_all(): that one would also start external programs on a file's say-so.
    archive_read_support_filter_gzip(a);
    archive_read_support_filter_bzip2(a);
    archive_read_support_filter_xz(a);
    archive_read_support_filter_lzma(a);
    archive_read_support_filter_zstd(a);
    archive_read_support_filter_lz4(a);
    archive_read_support_format_raw(a);
    archive_read_support_format_empty(a);
    archive_entry* entry = nullptr;
    int result = archive_read_open_fd(a, fd_.get(), kReadBytes);
    if (result == ARCHIVE_OK) {
        result = archive_read_next_header(a, &entry);
    }
    if (result < ARCHIVE_WARN) {
        failure_ = reason(a);
        return;
    }
    if ((result == ARCHIVE_EOF || !read_block()) && failure_.empty()) {
        throw InputError(name_ + ": empty; give a file that holds a recording");
    }
}

bool UnpackedFile::read_block() {
    if (!failure_.empty()) {
        return false;
    }
    const void* bytes = nullptr;
    std::size_t size = 0;
    la_int64_t offset = 0;
    block_ = {};
    while (block_.empty()) {
        const int result = archive_read_data_block(archive_.get(), &bytes, &size, &offset);
        if (result == ARCHIVE_EOF) {
            return false;
        }
        if (result < ARCHIVE_WARN) {
            failure_ = reason(archive_.get());
            return false;
        }
        block_ = {static_cast<const char*>(bytes), size};
    }
    return true;
}

double UnpackedFile::progress() const {
    if (file_bytes_ <= 0) {
        return 0.0;
    }
    const auto consumed = static_cast<double>(archive_filter_bytes(archive_.get(), -1));
    return std::clamp(consumed / static_cast<double>(file_bytes_), 0.0, 1.0);
}

}  // namespace crspf
