#include "platform/files/read_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "platform/files/input_error.hpp"
#include "platform/files/unique_fd.hpp"

namespace crspf {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, int error) {
    throw InputError(file.string() + ": cannot be read: " + std::generic_category().message(error) +
                     "; check the path and its permissions");
}

}  // namespace

std::string read_file(const std::filesystem::path& file, std::size_t bytes_max) {
    const UniqueFd fd(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
    struct stat status {};
    if (!fd.valid() || ::fstat(fd.get(), &status) != 0) {
        fail(file, errno);
    }
    std::string content;
    // The size is a hint only: a pipe has none, and a file may grow while it is read.
    std::size_t room = S_ISREG(status.st_mode) ? static_cast<std::size_t>(status.st_size) + 1 : 65536;
    for (;;) {
        const std::size_t filled = content.size();
        if (filled > bytes_max) {
            throw InputError(file.string() + ": larger than " + std::to_string(bytes_max) +
                             " bytes, too large for a file of its kind; check that it is the right one");
        }
        content.resize(filled + std::min(room, bytes_max + 1 - filled));
        const ssize_t got = ::read(fd.get(), content.data() + filled, content.size() - filled);
        const int error = errno;
        content.resize(filled + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
        if (got == 0) {
            return content;
        }
        if (got < 0 && error != EINTR) {
            fail(file, error);
        }
        room = 65536;
    }
}

}  // namespace crspf
