// How much a source had to say, and what its driver counted.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <utility>

namespace crspf {

/// By name, in the order in which they are shown. No heap: a real-time thread fills it in. More than kMax are left out.
class SourceCounts {
 public:
    using Count = std::pair<const char*, std::uint64_t>;
    static constexpr std::size_t kMax = 24;

    SourceCounts() = default;
    SourceCounts(std::initializer_list<Count> counts) { append(counts); }
    void append(std::initializer_list<Count> counts) {
        const std::size_t fit = std::min(counts.size(), kMax - size_);
        std::copy_n(counts.begin(), fit, counts_.begin() + static_cast<std::ptrdiff_t>(size_));
        size_ += fit;
    }

    [[nodiscard]] Count* begin() { return counts_.data(); }
    [[nodiscard]] Count* end() { return counts_.data() + size_; }
    [[nodiscard]] const Count* begin() const { return counts_.data(); }
    [[nodiscard]] const Count* end() const { return counts_.data() + size_; }
    [[nodiscard]] std::size_t size() const { return size_; }

 private:
    std::size_t size_ = 0;
    std::array<Count, kMax> counts_{};
};

struct SourceReport {
    std::string name;
    std::uint64_t records = 0;
    SourceCounts counts;
};

/// "lidar: 293 records, foreign 293": what is not 0.
[[nodiscard]] std::string text_of(const SourceReport& source);

}  // namespace crspf
