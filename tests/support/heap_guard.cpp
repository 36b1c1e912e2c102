#include "tests/support/heap_guard.hpp"

#include <sys/prctl.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define CRSPF_SANITIZER_OWNS_MALLOC
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define CRSPF_SANITIZER_OWNS_MALLOC
#endif
#if defined(__GLIBC__) && !defined(CRSPF_SANITIZER_OWNS_MALLOC)
#define CRSPF_COUNTS_HEAP_CALLS
#endif

namespace {

// Constant initialisation and no destructor: malloc runs before any constructor and after the last destructor.
// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables): malloc has nowhere else to count
constinit thread_local std::uint64_t heap_calls = 0;

// Of the one HeapWatch.
using ThreadName = std::array<char, 16>;
// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables): as above
constinit std::array<ThreadName, crspf::test::HeapWatch::kNames> watched_names{};
constinit std::atomic<std::size_t> watched{0};  // how many of them; written last
constinit std::atomic<std::uint64_t> watched_calls{0};
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

[[maybe_unused]] void count_heap_call() {
    ++heap_calls;
    const std::size_t count = watched.load(std::memory_order_acquire);
    if (count > 0) {
        ThreadName name{};
        ::prctl(PR_GET_NAME, name.data());
        const auto names = std::span(watched_names).first(count);
        if (std::find(names.begin(), names.end(), name) != names.end()) {
            watched_calls.fetch_add(1, std::memory_order_relaxed);
        }
    }
}

}  // namespace

#ifdef CRSPF_COUNTS_HEAP_CALLS

extern "C" {
// glibc's own entry points below the public names.
// NOLINTBEGIN(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp,readability-identifier-naming): glibc's names
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void __libc_free(void* block);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void* __libc_valloc(std::size_t size);
void* __libc_pvalloc(std::size_t size);
// NOLINTEND(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp,readability-identifier-naming)

// NOLINTBEGIN(readability-inconsistent-declaration-parameter-name): glibc's parameters have reserved names
void* malloc(std::size_t size) noexcept {
    count_heap_call();
    return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) noexcept {
    count_heap_call();
    return __libc_calloc(count, size);
}

void* realloc(void* block, std::size_t size) noexcept {
    count_heap_call();
    return __libc_realloc(block, size);
}

void free(void* block) noexcept {
    count_heap_call();
    __libc_free(block);
}

void* memalign(std::size_t alignment, std::size_t size) noexcept {
    count_heap_call();
    return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
    count_heap_call();
    return __libc_memalign(alignment, size);
}

int posix_memalign(void** block, std::size_t alignment, std::size_t size) noexcept {
    count_heap_call();
    if (alignment % sizeof(void*) != 0 || (alignment & (alignment - 1)) != 0 || alignment == 0) {
        return EINVAL;
    }
    void* const memory = __libc_memalign(alignment, size);
    if (memory == nullptr) {
        return ENOMEM;
    }
    *block = memory;
    return 0;
}

void* valloc(std::size_t size) noexcept {
    count_heap_call();
    return __libc_valloc(size);
}

void* pvalloc(std::size_t size) noexcept {
    count_heap_call();
    return __libc_pvalloc(size);
}
// NOLINTEND(readability-inconsistent-declaration-parameter-name)
}  // extern "C"

#endif

namespace crspf::test {

HeapGuard::HeapGuard() : calls_at_start_(heap_calls) {}

std::uint64_t HeapGuard::calls() const {
    return heap_calls - calls_at_start_;
}

HeapWatch::HeapWatch(std::span<const std::string_view> names) {
    const std::size_t count = std::min(names.size(), kNames);
    for (std::size_t i = 0; i < count; ++i) {
        watched_names[i] = {};
        names[i].copy(watched_names[i].data(), watched_names[i].size() - 1);
    }
    watched_calls = 0;
    watched.store(count, std::memory_order_release);
}

HeapWatch::~HeapWatch() {
    watched = 0;
}

std::uint64_t HeapWatch::calls() const {
    return watched_calls;
}

bool HeapGuard::available() {
#ifdef CRSPF_COUNTS_HEAP_CALLS
    return true;
#else
    return false;
#endif
}

}  // namespace crspf::test
