#include "tools/experiments/report/verdicts.hpp"

#include <fmt/format.h>

#include <cmath>

namespace crspf::experiments {

const char* name_of(Verdict verdict) {
    switch (verdict) {
        case Verdict::kHolds: return "holds";
        case Verdict::kPartly: return "partly";
        case Verdict::kDoesNotHold: return "does not hold";
        case Verdict::kNotMeasured: return "not measured";
    }
    return "";
}

std::string reason_of(const Claim& claim) {
    const bool owed = claim.verdict == Verdict::kPartly || claim.verdict == Verdict::kDoesNotHold;
    return claim.reason.empty() && owed ? "not found yet" : claim.reason;
}

Tally tally_of(std::span<const Section> sections) {
    Tally tally;
    for (const Section& section : sections) {
        for (const Claim& claim : section.findings.claims) {
            switch (claim.verdict) {
                case Verdict::kHolds: ++tally.holds; break;
                case Verdict::kPartly: ++tally.partly; break;
                case Verdict::kDoesNotHold: ++tally.does_not_hold; break;
                case Verdict::kNotMeasured: ++tally.not_measured; break;
            }
        }
    }
    return tally;
}

std::string text_of(const Tally& tally) {
    return fmt::format("{} {}: {} {}, {} partly, {} {} not hold, {} not measured", tally.all(),
                       tally.all() == 1 ? "claim" : "claims", tally.holds, tally.holds == 1 ? "holds" : "hold",
                       tally.partly, tally.does_not_hold, tally.does_not_hold == 1 ? "does" : "do", tally.not_measured);
}

std::string duration_text(double seconds) {
    constexpr double kFine_s = 10.0;
    constexpr long kMinute_s = 60;
    if (seconds < kFine_s) {
        return fmt::format("{:.1f} s", seconds);
    }
    const long whole = std::lround(seconds);
    return whole < 2 * kMinute_s ? fmt::format("{} s", whole)
                                 : fmt::format("{} min {} s", whole / kMinute_s, whole % kMinute_s);
}

}  // namespace crspf::experiments
