// A whole file in memory, with a bound on how much.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace crspf {

/// Throws InputError for a path that cannot be read and for a file of more than `bytes_max`.
[[nodiscard]] std::string read_file(const std::filesystem::path& file, std::size_t bytes_max);

}  // namespace crspf
