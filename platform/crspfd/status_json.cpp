#include "platform/crspfd/status_json.hpp"

namespace crspf {

nlohmann::ordered_json filter_json(const LocalizerCounters& counters, const ScanResult& last) {
    return {{"scans", counters.scans},
            {"matched", counters.matched},
            {"lost", counters.lost},
            {"degenerate", counters.degenerate},
            {"stood", counters.stood},
            {"key_frames", counters.key_frames},
            {"too_few_rays", counters.too_few_rays},
            {"outside_map", counters.outside_map},
            {"rays", last.rays},
            {"critical_rays", last.critical_rays},
            {"evaluations", last.evaluations}};
}

nlohmann::ordered_json analyser_json(const AnalyserParams& analyser) {
    return {{"result_on", analyser.result_on},
            {"result_off", analyser.result_off},
            {"draw_on", analyser.draw_on},
            {"draw_off", analyser.draw_off}};
}

}  // namespace crspf
