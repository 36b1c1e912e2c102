// A queue of fixed size from one thread to another: one of the two ways in which threads exchange anything here
// (the other: latest_value.hpp).
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace crspf {

/// Single producer, single consumer. What does not fit is rejected and counted: the producer never waits, the consumer
/// never sees an item twice or out of order. Items live in place, so that large ones are filled without a copy.
/// Every method: wait-free, no heap, no throw. N must be a power of two. @tparam T is assigned to, never destroyed.
template <class T, std::size_t N>
class SpscRing {
 public:
    static_assert(N > 0 && (N & (N - 1)) == 0);
    static constexpr std::size_t kCapacity = N;

    // Producer's.

    /// Whether claim() would be rejected.
    [[nodiscard]] bool full() const {
        // Acquire: see claim().
        return tail_.load(std::memory_order_relaxed) - head_.load(std::memory_order_acquire) == N;
    }
    /// The slot to fill, then commit(); nullptr, counted in rejected(), where the ring is full.
    [[nodiscard]] T* claim() {
        const std::uint32_t tail = tail_.load(std::memory_order_relaxed);
        // Acquire, with the release of pop(): the consumer has done with the slot.
        if (tail - head_.load(std::memory_order_acquire) == N) {
            rejected_.store(rejected_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
            return nullptr;
        }
        return &slots_[tail & kMask];
    }
    /// Hands over the claimed slot.
    void commit() {
        // Release, with the acquire of front(): the consumer sees what was filled in.
        tail_.store(tail_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
    }
    /// False, counted, where the ring is full.
    bool push(const T& item) {
        T* const slot = claim();
        if (slot == nullptr) {
            return false;
        }
        *slot = item;
        commit();
        return true;
    }

    // Consumer's.

    /// The oldest item, valid until pop(); nullptr where there is none.
    [[nodiscard]] const T* front() const {
        const std::uint32_t head = head_.load(std::memory_order_relaxed);
        // Acquire, with the release of commit().
        return tail_.load(std::memory_order_acquire) == head ? nullptr : &slots_[head & kMask];
    }
    /// Only after front() gave an item.
    void pop() {
        // Release, with the acquire of claim().
        head_.store(head_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
    }
    bool pop(T& item) {
        const T* const oldest = front();
        if (oldest == nullptr) {
            return false;
        }
        item = *oldest;
        pop();
        return true;
    }

    // Anybody's.

    /// Items in the ring, as of some moment during the call.
    [[nodiscard]] std::size_t size() const {
        const std::uint32_t head = head_.load(std::memory_order_acquire);
        return tail_.load(std::memory_order_acquire) - head;
    }
    /// Items handed over since the start, modulo 2^32.
    [[nodiscard]] std::uint32_t committed() const {
        // Acquire, with the release of commit(): whoever hears of the number may tell the consumer that they are there.
        return tail_.load(std::memory_order_acquire);
    }
    /// Never reset.
    [[nodiscard]] std::uint64_t rejected() const { return rejected_.load(std::memory_order_relaxed); }

 private:
    static constexpr std::uint32_t kMask = N - 1;

    alignas(64) std::atomic<std::uint32_t> head_{0};  ///< the consumer's
    alignas(64) std::atomic<std::uint32_t> tail_{0};  ///< the producer's
    std::atomic<std::uint64_t> rejected_{0};          ///< the producer's
    alignas(64) std::array<T, N> slots_{};
};

}  // namespace crspf
