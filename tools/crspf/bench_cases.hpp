// What `crspf bench` measures.
#pragma once

#include <span>

namespace crspf::cli {

/// Tells Google Benchmark of all cases. Each counts its items (evaluations, scans), so that their items_per_second can
/// be compared. Worlds and maps are made when a case first needs them.
void register_bench_cases();

/// A case and the one that it is to be read against.
struct BenchRatio {
    enum class Of : bool { kRate, kTime };
    const char* measured;
    const char* reference;
    Of of;
    const char* text;  ///< "measured / reference"
    const char* unit;  ///< what the quotient counts
};
[[nodiscard]] std::span<const BenchRatio> bench_ratios();

/// How fast what a case takes comes in from the real sensor.
struct BenchRealTime {
    const char* measured;
    double per_s;
    const char* sensor;
};
[[nodiscard]] std::span<const BenchRealTime> bench_real_times();

}  // namespace crspf::cli
