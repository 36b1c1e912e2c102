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

nlohmann::ordered_json to_json(const OdometryCounters& o) {
    return {{"samples", o.samples},
            {"not_finite", o.not_finite},
            {"ran_back", o.ran_back},
            {"gaps", o.gaps},
            {"implausible", o.implausible},
            {"askew", o.askew},
            {"out_of_history", o.out_of_history}};
}

nlohmann::ordered_json to_json(const LogCounts& log) {
    return {{"lines", log.lines},
            {"ignored_lines", log.ignored_lines},
            {"damaged_lines", log.damaged_lines},
            {"stamp_jumps", log.stamp_jumps},
            {"invalid_beams", log.invalid_beams},
            {"no_return_beams", log.no_return_beams}};
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
