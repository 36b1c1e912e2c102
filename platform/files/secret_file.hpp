// Secrets are in files, for a command line can be read by everybody.
#pragma once

#include <filesystem>
#include <string>

namespace crspf {

/// What is in the file but for the ends of its lines at the end. Throws InputError: not readable, larger than 4096
/// bytes, or everybody may read it.
[[nodiscard]] std::string read_secret(const std::filesystem::path& file);

}  // namespace crspf
