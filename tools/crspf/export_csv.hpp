// What the filter made of each scan, as a table: a line a scan, the first names the columns.
#pragma once

#include <filesystem>

#include "core/slam/localizer.hpp"
#include "platform/files/atomic_file.hpp"
#include "tools/crspf/run_player.hpp"

namespace crspf {

/// Each throws InputError for a file that cannot be written.
class CsvExport {
 public:
    explicit CsvExport(const std::filesystem::path& file);
    /// A scan that `player` has just played.
    void add(const RunPlayer& player, const ScanResult& result);
    /// The last call.
    void finish() { file_.commit(); }

 private:
    AtomicFile file_;
};

}  // namespace crspf
