#include "core/slam/pipeline.hpp"

namespace crspf {

ScanResult Pipeline::on_scan(const Scan& scan, const ScanTiming& timing) {
    follow(timing);
    const ScanResult result = localizer_.on_scan(scan);
    draw(result, timing);
    return result;
}

std::optional<ScanResult> Pipeline::on_cloud(const Cloud& cloud, const ScanTiming& timing) {
    follow(timing);
    const std::optional<ScanResult> result = localizer_.on_cloud(cloud);
    if (result) {
        draw(*result, timing);
    }
    return result;
}

void Pipeline::follow(const ScanTiming& timing) {
    for (const ChangeList* changes = nullptr; followed_ < timing.changes && (changes = changes_.front()) != nullptr;
         ++followed_) {
        localizer_.follow(changes->view());
        changes_.pop();
    }
}

void Pipeline::draw(const ScanResult& result, const ScanTiming& timing) {
    if (ChangeList* const changes = result.to_draw && timing.draw ? changes_.claim() : nullptr) {
        const std::uint64_t refused_before = changes->refused();
        changes->clear();
        map_update_.draw(localizer_.points(), result.P_map_base, result.result, *changes);
        changes_refused_ += changes->refused() - refused_before;
        changes_.commit();
    }
}

void Pipeline::set_cell(Cell cell, Evidence evidence) {
    if (ChangeList* const changes = changes_.claim()) {  // before the first scan it is empty
        changes->clear();
        map_update_.set(cell, evidence, *changes);
        localizer_.follow(changes->view());
    }
}

}  // namespace crspf
