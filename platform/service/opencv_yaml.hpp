// The numbers and matrices of a file that OpenCV's FileStorage wrote as YAML.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace crspf {

struct YamlMatrix {
    std::uint64_t rows = 0;
    std::uint64_t cols = 0;
    std::vector<double> data;  ///< row-major, rows * cols, all finite
    std::size_t line = 0;      ///< of its key
};

/// Reads what it is asked for; all else in the file is skipped, so that strings, sequences and maps do no harm. A
/// matrix has rows, cols, dt "d" or "f", and data, in this order. Not a reader of YAML at large.
/// Throws InputError, "NAME:LINE: reason; remedy".
class OpenCvYaml {
 public:
    static constexpr std::size_t kElementsMax = 64;  ///< of a matrix

    [[nodiscard]] static bool is_one(std::string_view text) { return text.starts_with("%YAML"); }

    /// @param text must outlive this object
    /// @param name of the file, for messages
    OpenCvYaml(std::string_view text, std::string name);

    [[nodiscard]] bool has(std::string_view key) const { return entries_.contains(key); }
    /// 1 where the key is absent.
    [[nodiscard]] std::size_t line_of(std::string_view key) const;
    /// None where the key is absent.
    [[nodiscard]] std::optional<int> whole_number(std::string_view key) const;
    [[nodiscard]] std::optional<YamlMatrix> matrix(std::string_view key) const;

    [[noreturn]] void fail(std::size_t line, const std::string& reason) const;

 private:
    struct Entry {
        std::string_view text;  ///< behind the colon, with the indented lines that follow
        std::size_t line = 0;
    };

    std::string name_;
    std::map<std::string_view, Entry> entries_;
};

}  // namespace crspf
