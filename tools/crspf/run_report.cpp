#include "tools/crspf/run_report.hpp"

namespace crspf {

void add(LogCounts& sum, const LogCounts& part) {
    sum.lines += part.lines;
    sum.scans += part.scans;
    sum.odometry += part.odometry;
    sum.ignored_lines += part.ignored_lines;
    sum.damaged_lines += part.damaged_lines;
    sum.stamp_jumps += part.stamp_jumps;
    sum.invalid_beams += part.invalid_beams;
    sum.no_return_beams += part.no_return_beams;
    if (sum.first_damage.empty()) {
        sum.first_damage = part.first_damage;
    }
}

nlohmann::ordered_json to_json(const OdometryCounters& counters) {
    return {{"samples", counters.samples},
            {"not_finite", counters.not_finite},
            {"ran_back", counters.ran_back},
            {"gaps", counters.gaps},
            {"implausible", counters.implausible},
            {"askew", counters.askew},
            {"out_of_history", counters.out_of_history}};
}

nlohmann::ordered_json to_json(const LogCounts& counts) {
    return {{"lines", counts.lines},
            {"ignored_lines", counts.ignored_lines},
            {"damaged_lines", counts.damaged_lines},
            {"stamp_jumps", counts.stamp_jumps},
            {"invalid_beams", counts.invalid_beams},
            {"no_return_beams", counts.no_return_beams}};
}

nlohmann::ordered_json to_json(const std::vector<SourceReport>& sources) {
    nlohmann::ordered_json all = nlohmann::ordered_json::object();
    for (const SourceReport& source : sources) {
        nlohmann::ordered_json& one = all[source.name];
        one["records"] = source.records;
        for (const auto& [name, count] : source.counts) {
            one[name] = count;
        }
    }
    return all;
}

}  // namespace crspf
