// Files that a test makes and leaves no trace of.
#pragma once

#include <archive.h>
#include <archive_entry.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace crspf::test {

/// A directory of its own, removed with all it holds.
class Scratch {
 public:
    Scratch() {
        static std::atomic<int> made = 0;
        directory_ = std::filesystem::temp_directory_path() /
                     ("crspf_test_" + std::to_string(getpid()) + "_" + std::to_string(made++));
        std::filesystem::create_directory(directory_);
    }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;
    ~Scratch() {
        std::error_code ignored;
        std::filesystem::remove_all(directory_, ignored);
    }

    [[nodiscard]] const std::filesystem::path& directory() const { return directory_; }
    [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return directory_ / name; }

    std::filesystem::path file(const std::string& name, std::string_view content) const {
        std::filesystem::path path = directory_ / name;
        std::ofstream stream(path, std::ios::binary);
        stream << content;
        stream.close();
        REQUIRE(stream.good());
        return path;
    }

    [[nodiscard]] std::vector<std::string> names() const {
        std::vector<std::string> found;
        for (const auto& entry : std::filesystem::directory_iterator(directory_)) {
            found.push_back(entry.path().filename().string());
        }
        std::sort(found.begin(), found.end());
        return found;
    }

 private:
    std::filesystem::path directory_;
};

inline std::string content_of(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    REQUIRE(stream.good());
    std::ostringstream content;
    content << stream.rdbuf();
    return content.str();
}

/// What xz, gzip, bzip2 or zstd make of the content.
inline std::string compressed(const std::string& content, const char* filter) {
    std::string out(content.size() + 65536, '\0');
    std::size_t used = 0;
    archive* const a = archive_write_new();
    REQUIRE(archive_write_set_format_raw(a) == ARCHIVE_OK);
    REQUIRE(archive_write_add_filter_by_name(a, filter) == ARCHIVE_OK);
    archive_write_set_bytes_in_last_block(a, 1);
    REQUIRE(archive_write_open_memory(a, out.data(), out.size(), &used) == ARCHIVE_OK);
    archive_entry* const entry = archive_entry_new();
    archive_entry_set_filetype(entry, AE_IFREG);
    REQUIRE(archive_write_header(a, entry) == ARCHIVE_OK);
    REQUIRE(archive_write_data(a, content.data(), content.size()) == static_cast<la_ssize_t>(content.size()));
    REQUIRE(archive_write_close(a) == ARCHIVE_OK);
    archive_entry_free(entry);
    archive_write_free(a);
    out.resize(used);
    return out;
}

}  // namespace crspf::test
