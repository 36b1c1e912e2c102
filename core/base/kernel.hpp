// Inner loops that are compiled for more than one kind of processor.
#pragma once

#include <cstdint>

namespace crspf {

/// All kernels of a loop give the same bits; the choice is for tests and measurements.
enum class Kernel : std::uint8_t { kFastest, kPortable };

/// Whether to run the loop that is compiled for AVX2. Wait-free.
[[nodiscard]] inline bool takes_avx2([[maybe_unused]] Kernel kernel) {
#if defined(__x86_64__)
    return kernel == Kernel::kFastest && static_cast<bool>(__builtin_cpu_supports("avx2"));
#else
    return false;
#endif
}

}  // namespace crspf
