// The guard proves the absence of heap calls elsewhere, so each way to the heap is planted here and must be seen.
#include <malloc.h>

#include <Eigen/Core>
#include <atomic>
#include <catch2/catch.hpp>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <thread>
#include <vector>

#include "tests/support/heap_guard.hpp"

// malloc and free themselves are what is tested, and a failed REQUIRE may leave a block behind.
// NOLINTBEGIN(cppcoreguidelines-no-malloc,cppcoreguidelines-owning-memory,clang-analyzer-unix.Malloc): see above

namespace {

using crspf::test::HeapGuard;

/// Tells the compiler that `object` is used, so that it cannot drop a pair of allocation and release.
template <typename T>
void keep(T& object) {
    asm volatile("" : : "g"(&object) : "memory");
}

bool guard_missing() {
    if (HeapGuard::available()) {
        return false;
    }
    WARN("skipped: a sanitizer owns malloc in this build, heap calls cannot be counted");
    return true;
}

template <typename Action>
std::uint64_t heap_calls_of(Action action) {
    const HeapGuard guard;
    action();
    return guard.calls();
}

}  // namespace

TEST_CASE("code off the heap counts nothing", "[heap_guard]") {
    const std::uint64_t calls = heap_calls_of([] {
        Eigen::Matrix3d product = Eigen::Matrix3d::Identity() * Eigen::Matrix3d::Constant(2.0);
        keep(product);
    });
    REQUIRE(calls == 0);
}

TEST_CASE("each function of the malloc family is counted", "[heap_guard]") {
    if (guard_missing()) {
        return;
    }
    const auto allocated_and_freed = [](auto allocate) {
        return heap_calls_of([&] {
            void* block = allocate();
            keep(block);
            std::free(block);
        });
    };
    REQUIRE(allocated_and_freed([] { return std::malloc(32); }) == 2);
    REQUIRE(allocated_and_freed([] { return std::calloc(4, 8); }) == 2);
    REQUIRE(allocated_and_freed([] { return std::realloc(nullptr, 32); }) == 2);
    REQUIRE(allocated_and_freed([] { return std::aligned_alloc(64, 64); }) == 2);
    REQUIRE(allocated_and_freed([] { return memalign(64, 64); }) == 2);
    REQUIRE(allocated_and_freed([] { return valloc(64); }) == 2);
    REQUIRE(allocated_and_freed([] { return pvalloc(64); }) == 2);
    REQUIRE(allocated_and_freed([] {
                void* block = nullptr;
                return posix_memalign(&block, 64, 64) == 0 ? block : nullptr;
            }) == 2);
}

TEST_CASE("what C++ builds on the heap is counted", "[heap_guard]") {
    if (guard_missing()) {
        return;
    }
    SECTION("new and delete") {
        REQUIRE(heap_calls_of([] {
                    auto number = std::make_unique<int>(7);
                    keep(*number);
                }) == 2);
    }
    SECTION("a type aligned beyond malloc's word") {
        struct alignas(64) CacheLine {
            int value = 0;
        };
        REQUIRE(heap_calls_of([] {
                    auto line = std::make_unique<CacheLine>();
                    keep(*line);
                }) == 2);
    }
    SECTION("a container") {
        REQUIRE(heap_calls_of([] {
                    std::vector<int> numbers(100);
                    keep(numbers);
                }) == 2);
    }
    SECTION("Eigen's dynamic matrix, which does not pass through operator new") {
        REQUIRE(heap_calls_of([] {
                    Eigen::MatrixXd matrix = Eigen::MatrixXd::Ones(8, 8);
                    keep(matrix);
                }) >= 2);  // the null pointer that resize() frees is optimised away, or not
    }
}

TEST_CASE("guards nest", "[heap_guard]") {
    if (guard_missing()) {
        return;
    }
    const HeapGuard outer;
    void* block = std::malloc(16);
    keep(block);
    const HeapGuard inner;
    std::free(block);
    const std::uint64_t inner_calls = inner.calls();
    const std::uint64_t outer_calls = outer.calls();
    REQUIRE(inner_calls == 1);
    REQUIRE(outer_calls == 2);
}

TEST_CASE("calls of another thread are not counted", "[heap_guard]") {
    if (guard_missing()) {
        return;
    }
    std::uint64_t theirs = 0;
    std::uint64_t ours = 0;
    // The thread itself is made before the guard and joined after it: both allocate here.
    std::atomic<int> turn{0};
    std::thread other([&] {
        while (turn.load() == 0) {
            std::this_thread::yield();
        }
        theirs = heap_calls_of([] {
            std::vector<int> numbers(100);
            keep(numbers);
        });
        turn.store(2);
    });
    {
        const HeapGuard guard;
        turn.store(1);
        while (turn.load() != 2) {
            std::this_thread::yield();
        }
        ours = guard.calls();
    }
    other.join();
    REQUIRE(theirs == 2);
    REQUIRE(ours == 0);
}

TEST_CASE("the replaced family keeps malloc's contract", "[heap_guard]") {
    if (guard_missing()) {
        return;
    }
    void* block = nullptr;
    REQUIRE(posix_memalign(&block, 3, 64) == EINVAL);
    REQUIRE(posix_memalign(&block, 256, 64) == 0);
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): the address as a number
    REQUIRE(reinterpret_cast<std::uintptr_t>(block) % 256 == 0);
    std::free(block);
    block = std::realloc(std::malloc(8), 4096);
    REQUIRE(block != nullptr);
    REQUIRE(malloc_usable_size(block) >= 4096);
    std::free(block);
}

// NOLINTEND(cppcoreguidelines-no-malloc,cppcoreguidelines-owning-memory,clang-analyzer-unix.Malloc)
