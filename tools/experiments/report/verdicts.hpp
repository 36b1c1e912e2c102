// What became of the paper's claims, in words and numbers.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "tools/experiments/report/report.hpp"

namespace crspf::experiments {

/// "holds", "partly", "does not hold", "not measured".
[[nodiscard]] const char* name_of(Verdict verdict);

/// The claim's, or that it is missing where one is owed: what does not hold, or only partly, has one.
[[nodiscard]] std::string reason_of(const Claim& claim);

struct Tally {
    std::size_t holds = 0;
    std::size_t partly = 0;
    std::size_t does_not_hold = 0;
    std::size_t not_measured = 0;

    [[nodiscard]] std::size_t all() const { return holds + partly + does_not_hold + not_measured; }
};

[[nodiscard]] Tally tally_of(std::span<const Section> sections);

/// "9 claims: 6 hold, 2 partly, 1 does not hold, 0 not measured".
[[nodiscard]] std::string text_of(const Tally& tally);

/// "9.3 s", "12 min 5 s".
[[nodiscard]] std::string duration_text(double seconds);

}  // namespace crspf::experiments
