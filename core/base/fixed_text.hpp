// Text without a heap, for what real-time threads have to say to people.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace crspf {

/// Up to N - 1 characters; what is longer is cut. No heap, no throw.
template <std::size_t N>
class FixedText {
 public:
    FixedText() = default;
    explicit FixedText(std::string_view text) { append(text); }

    FixedText& append(std::string_view text) {
        const std::size_t room = N - 1 - size_;
        text = text.substr(0, room);
        for (const char c : text) {
            characters_[size_++] = c;
        }
        characters_[size_] = 0;
        return *this;
    }

    [[nodiscard]] std::string_view view() const { return {characters_.data(), size_}; }
    [[nodiscard]] bool empty() const { return size_ == 0; }

 private:
    std::size_t size_ = 0;
    std::array<char, N> characters_{};
};

}  // namespace crspf
