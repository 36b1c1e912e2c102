// How a thread is doing, written by itself and read by anybody.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/base/time.hpp"

namespace crspf {

/// Times in buckets an eighth of a power of two wide, whole microseconds at the lower end. One writer. No heap,
/// wait-free.
class TimeHistogram {
 public:
    static constexpr std::size_t kBuckets = 240;

    void add(Duration time) {
        const std::size_t bucket = bucket_of(static_cast<std::uint64_t>(time.ns > 0 ? time.ns / 1000 : 0));
        bump(counts_[bucket < kBuckets ? bucket : kBuckets - 1]);
        if (time.ns > max_ns_.load(std::memory_order_relaxed)) {
            max_ns_.store(time.ns, std::memory_order_relaxed);
        }
    }

    [[nodiscard]] std::uint64_t count(std::size_t bucket) const {
        return counts_[bucket].load(std::memory_order_relaxed);
    }
    /// The times [us] that are counted in a bucket: from `begin_of`, below `end_of`; the last one has all beyond, too.
    static constexpr std::uint64_t end_of(std::size_t bucket) {
        const std::size_t shift = bucket < kParts ? 0 : bucket / kParts - 1;
        return std::uint64_t{bucket - kParts * shift + 1} << shift;
    }
    static constexpr std::uint64_t begin_of(std::size_t bucket) { return bucket == 0 ? 0 : end_of(bucket - 1); }
    [[nodiscard]] Duration max() const { return {max_ns_.load(std::memory_order_relaxed)}; }
    /// The upper bound of the bucket below which `share` of the times are; 0 where there are none.
    [[nodiscard]] Duration below(double share) const {
        std::uint64_t all = 0;
        for (const auto& c : counts_) {
            all += c.load(std::memory_order_relaxed);
        }
        std::uint64_t sum = 0;
        for (std::size_t i = 0; i < kBuckets && all > 0; ++i) {
            sum += count(i);
            if (static_cast<double>(sum) >= share * static_cast<double>(all)) {
                return {static_cast<std::int64_t>(end_of(i)) * 1000};
            }
        }
        return {};
    }

    /// Of a counter with one writer.
    static void bump(std::atomic<std::uint64_t>& counter) {
        counter.store(counter.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
    }

 private:
    static constexpr unsigned kParts = 8;  // of a power of two
    static constexpr unsigned kPartBits = 3;

    static constexpr unsigned bucket_of(std::uint64_t microseconds) {
        if (microseconds < kParts) {
            return static_cast<unsigned>(microseconds);
        }
        const auto shift = static_cast<unsigned>(std::bit_width(microseconds)) - 1 - kPartBits;
        return kParts * shift + static_cast<unsigned>(microseconds >> shift);
    }

    std::array<std::atomic<std::uint64_t>, kBuckets> counts_{};
    std::atomic<std::int64_t> max_ns_{0};
};

class ThreadHealth {
 public:
    /// Its loop has gone round. To be told at least ten times a second.
    void turned(Stamp now) { last_turn_ns_.store(now.ns, std::memory_order_relaxed); }
    /// It has done its work in `time`.
    void worked(Duration time, Duration deadline) {
        times_.add(time);
        if (time > deadline) {
            TimeHistogram::bump(misses_);
        }
    }

    [[nodiscard]] Stamp last_turn() const { return {last_turn_ns_.load(std::memory_order_relaxed)}; }
    [[nodiscard]] std::uint64_t misses() const { return misses_.load(std::memory_order_relaxed); }
    [[nodiscard]] const TimeHistogram& times() const { return times_; }

 private:
    std::atomic<std::int64_t> last_turn_ns_{0};
    std::atomic<std::uint64_t> misses_{0};
    TimeHistogram times_;
};

}  // namespace crspf
