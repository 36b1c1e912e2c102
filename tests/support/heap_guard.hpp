// Proof that a stretch of code, or a thread, stays off the heap: counts calls of the malloc family.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace crspf::test {

/// Counts from its construction on. It sees malloc, calloc, realloc, free, aligned_alloc, posix_memalign, memalign,
/// valloc and pvalloc, hence also operator new and delete, the standard containers and Eigen's dynamic matrices, which
/// a hook on operator new alone would miss. Calls of other threads do not count. Guards may nest.
///
///     const HeapGuard guard;
///     filter.update(scan);
///     const std::uint64_t calls = guard.calls();  // before any REQUIRE: Catch2 itself allocates
///     REQUIRE(calls == 0);
///
/// The counting stands in heap_guard.cpp, which defines malloc and its family for every executable that links it.
class HeapGuard {
 public:
    HeapGuard();
    HeapGuard(const HeapGuard&) = delete;
    HeapGuard& operator=(const HeapGuard&) = delete;
    ~HeapGuard() = default;

    /// Calls since construction, to be asked in the thread that constructed the guard. Always 0 where not available().
    [[nodiscard]] std::uint64_t calls() const;

    /// False where a sanitizer owns malloc, and outside glibc: a test then says so and proves nothing.
    [[nodiscard]] static bool available();

 private:
    std::uint64_t calls_at_start_;
};

/// Counts the calls of whole threads, known by their names, while it lives. One at a time.
class HeapWatch {
 public:
    static constexpr std::size_t kNames = 8;

    /// @param names of threads, at most kNames, each of at most 15 characters
    explicit HeapWatch(std::span<const std::string_view> names);
    HeapWatch(const HeapWatch&) = delete;
    HeapWatch& operator=(const HeapWatch&) = delete;
    ~HeapWatch();

    [[nodiscard]] std::uint64_t calls() const;
};

}  // namespace crspf::test
