#include "core/slam/pipeline.hpp"

namespace crspf {

ScanResult Pipeline::on_scan(const Scan& scan) {
    localizer_.follow(changes_.view());
    const ScanResult result = localizer_.on_scan(scan);
    changes_.clear();
    if (result.to_draw) {
        map_update_.draw(localizer_.points(), result.P_map_base, result.result, changes_);
    }
    return result;
}

void Pipeline::set_cell(Cell cell, Evidence evidence) {
    changes_.clear();
    map_update_.set(cell, evidence, changes_);
    localizer_.follow(changes_.view());
    changes_.clear();
}

}  // namespace crspf
