#include "platform/files/secret_file.hpp"

#include <cstddef>
#include <system_error>

#include "platform/files/input_error.hpp"
#include "platform/files/read_file.hpp"

namespace crspf {

std::string read_secret(const std::filesystem::path& file) {
    constexpr std::size_t kFileMax = 4096;
    std::string secret = read_file(file, kFileMax);
    std::error_code ignored;
    if ((std::filesystem::status(file, ignored).permissions() & std::filesystem::perms::others_read) !=
        std::filesystem::perms::none) {
        throw InputError(file.string() + ": everybody can read this secret; chmod o-r " + file.string());
    }
    secret.erase(secret.find_last_not_of("\r\n") + 1);
    return secret;
}

}  // namespace crspf
