// What a channel keeps of its messages, and when the next one is due.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <utility>

#include "tools/view/channels.hpp"

namespace crspf::view {

/// The last messages of a channel, numbered from 1. A cursor is the number of the last one that a reader had.
class KeptMessages {
 public:
    explicit KeptMessages(std::size_t kept_max) : kept_max_(kept_max) {}

    void push(std::shared_ptr<const Message> message) {
        messages_.push_back(std::move(message));
        ++newest_;
        if (messages_.size() > kept_max_) {
            messages_.pop_front();
        }
    }
    void forget() { messages_.clear(); }

    [[nodiscard]] std::shared_ptr<const Message> next(std::uint64_t& cursor) const {
        const std::uint64_t before_oldest = newest_ - messages_.size();
        cursor = std::max(cursor, before_oldest);
        if (cursor >= newest_) {
            return nullptr;
        }
        return *(messages_.end() - static_cast<std::ptrdiff_t>(newest_ - cursor++));
    }

 private:
    std::size_t kept_max_;
    std::deque<std::shared_ptr<const Message>> messages_;
    std::uint64_t newest_ = 0;
};

/// When a thing was done last that is to be done once a second, by the stamps of what happens.
class OnceASecond {
 public:
    static constexpr std::int64_t kPeriod_ns = 1'000'000'000;
    static constexpr std::int64_t kEarly_ns = 100'000'000;  ///< a second of the feed's may be a little less

    [[nodiscard]] bool due(std::int64_t now_ns) const {
        return !done_ || now_ns < last_ns_ || now_ns - last_ns_ >= kPeriod_ns - kEarly_ns;
    }
    void done(std::int64_t now_ns) {
        done_ = true;
        last_ns_ = now_ns;
    }

 private:
    bool done_ = false;
    std::int64_t last_ns_ = 0;
};

}  // namespace crspf::view
