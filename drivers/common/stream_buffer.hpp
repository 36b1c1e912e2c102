// The bytes of a stream that a parser has received and not yet used.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace crspf {

/// No heap; append() moves what is pending to the front, all else is constant time. One owner.
template <std::size_t Capacity>
class StreamBuffer {
 public:
    /// Takes as many of `bytes` as fit; returns how many. Invalidates pending().
    std::size_t append(std::span<const std::uint8_t> bytes) {
        const auto at = [this](std::size_t i) { return buffer_.begin() + static_cast<std::ptrdiff_t>(i); };
        if (begin_ > 0) {
            std::copy(at(begin_), at(end_), buffer_.begin());
            end_ -= begin_;
            begin_ = 0;
        }
        const std::size_t n = std::min(bytes.size(), Capacity - end_);
        std::copy_n(bytes.begin(), n, at(end_));
        end_ += n;
        return n;
    }
    [[nodiscard]] std::span<const std::uint8_t> pending() const {
        return std::span(buffer_).subspan(begin_, end_ - begin_);
    }
    /// At most as many as are pending.
    void consume(std::size_t n) { begin_ += n; }
    void clear() { begin_ = end_ = 0; }

 private:
    std::array<std::uint8_t, Capacity> buffer_{};
    std::size_t begin_ = 0;
    std::size_t end_ = 0;
};

}  // namespace crspf
