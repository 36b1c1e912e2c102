#include "tools/crspf/export_mcap.hpp"

#include <cstddef>
#include <variant>

namespace crspf {

using view::Topic;

McapExport::McapExport(const std::filesystem::path& file, const Config& config)
    : writer_(file, channels_.all()), events_(config) {}

void McapExport::on_scan(const RunPlayer& player, const ScanResult& result) {
    events_.on_scan(player, result, [this](const view::RunEvent& event) { take(event); });
}

void McapExport::take(const view::RunEvent& event) {
    channels_.take(event);
    const auto* const scan = std::get_if<view::ScanEvent>(&event);
    const bool wholes = scan != nullptr && (!wholes_ns_ || scan->stamp_ns - *wholes_ns_ >= kWholesEvery_ns);
    if (wholes) {
        wholes_ns_ = scan->stamp_ns;
    }
    write_what_is_new(wholes);
}

void McapExport::write_what_is_new(bool wholes) {
    for (std::size_t i = 0; i < view::kTopics; ++i) {
        const auto topic = static_cast<Topic>(i);
        if (!wholes && (topic == Topic::kMap || topic == Topic::kPath)) {
            continue;
        }
        while (const auto message = channels_.next(i, cursors_.at(i))) {
            writer_.write(i, *message);
        }
    }
}

void McapExport::finish(RunPlayer& player) {
    events_.on_end(player, [this](const view::RunEvent& event) { take(event); });
    channels_.take(view::AwayEvent{.away = true, .why = "the recording has ended"});
    write_what_is_new(true);
    writer_.finish();
}

}  // namespace crspf
