// Where the public recordings lie that some tests need; they are not part of the repository.
#pragma once

#include <cstdlib>
#include <filesystem>

namespace crspf::test {

inline std::filesystem::path recording(const char* name) {
    const char* const folder = std::getenv("CRSPF_DATA");
    return std::filesystem::path(folder != nullptr ? folder : CRSPF_DATA_DEFAULT) / name;
}

}  // namespace crspf::test

/// Ends the test, saying why, where a recording is absent.
#define CRSPF_NEED_RECORDING(path)                                                          \
    if (!std::filesystem::exists(path)) {                                                   \
        WARN("skipped: " << (path).string() << " is absent; set CRSPF_DATA to its folder"); \
        return;                                                                             \
    }
