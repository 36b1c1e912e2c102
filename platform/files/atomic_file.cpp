#include "platform/files/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstdio>
#include <system_error>

#include "platform/files/input_error.hpp"

namespace crspf {
namespace {

constexpr std::size_t kBufferBytes = 65536;
constexpr int kTemporaryNames = 100;  // stale ones of crashed runs with the same process id are passed over

const char* remedy(int error) {
    switch (error) {
        case ENOSPC:
        case EDQUOT: return "free some space or write elsewhere";
        case EACCES:
        case EPERM:
        case EROFS: return "write to a directory that you may write to";
        case ENOENT:
        case ENOTDIR: return "create the directory first";
        case EISDIR: return "name a file, not a directory";
        case EFBIG: return "raise the file size limit (ulimit -f) or write elsewhere";
        default: return "check the disk or write elsewhere";
    }
}

std::filesystem::path follow_links(const std::filesystem::path& path) {
    std::error_code unresolved;
    const std::filesystem::path real = std::filesystem::canonical(path, unresolved);
    return unresolved ? path : real;
}

// A rename survives a power cut only once the directory is on the disk too. Not every file system can do that, and the
// content itself is safe already: nothing is lost if it fails.
void sync_directory_of(const std::filesystem::path& file) {
    const std::filesystem::path directory = file.has_parent_path() ? file.parent_path() : ".";
    const UniqueFd fd(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (fd.valid()) {
        static_cast<void>(::fsync(fd.get()));
    }
}

}  // namespace

AtomicFile::AtomicFile(const std::filesystem::path& target) : target_(follow_links(target)) {
    buffer_.reserve(kBufferBytes);
    struct stat status {};
    const bool exists = ::stat(target_.c_str(), &status) == 0;
    if (!exists || S_ISREG(status.st_mode)) {
        create_temporary();
        return;
    }
    fd_ = UniqueFd(::open(target_.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY));
    if (!fd_.valid()) {
        fail(errno);
    }
}

AtomicFile::~AtomicFile() {
    if (!temporary_.empty()) {
        ::unlink(temporary_.c_str());
    }
}

void AtomicFile::create_temporary() {
    for (int i = 0; i < kTemporaryNames; ++i) {
        const std::string name = target_.string() + ".tmp" + std::to_string(::getpid()) + "-" + std::to_string(i);
        fd_ = UniqueFd(::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
        if (fd_.valid()) {
            temporary_ = name;
            return;
        }
        if (errno != EEXIST) {
            break;
        }
    }
    fail(errno);
}

void AtomicFile::write(std::string_view bytes) {
    if (buffer_.size() + bytes.size() > kBufferBytes) {
        write_out(buffer_);
        buffer_.clear();
    }
    if (bytes.size() > kBufferBytes) {
        write_out(bytes);
    } else {
        buffer_ += bytes;
    }
}

void AtomicFile::write_out(std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(fd_.get(), bytes.data(), bytes.size());
        if (written >= 0) {
            bytes.remove_prefix(static_cast<std::size_t>(written));
        } else if (errno != EINTR) {
            fail(errno);
        }
    }
}

void AtomicFile::commit() {
    write_out(buffer_);
    buffer_.clear();
    if (!temporary_.empty() && ::fsync(fd_.get()) != 0) {
        fail(errno);
    }
    // Some file systems report a full disk only here.
    if (::close(fd_.release()) != 0 && errno != EINTR) {
        fail(errno);
    }
    if (temporary_.empty()) {
        return;
    }
    if (std::rename(temporary_.c_str(), target_.c_str()) != 0) {
        fail(errno);
    }
    temporary_.clear();
    sync_directory_of(target_);
}

void AtomicFile::fail(int error) const {
    throw InputError(target_.string() + ": cannot be written: " + std::generic_category().message(error) + "; " +
                     remedy(error));
}

}  // namespace crspf
