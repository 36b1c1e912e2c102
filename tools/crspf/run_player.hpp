// A recorded run, played by the pipeline sample by sample: for whoever wants to look on.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/slam/pipeline.hpp"
#include "platform/capture/journal.hpp"
#include "platform/capture/log_reader.hpp"
#include "platform/files/input_error.hpp"
#include "platform/service/open_run.hpp"
#include "platform/service/tile_archive.hpp"
#include "tools/crspf/replay_job.hpp"

namespace crspf {

/// As the service that was recorded was timed.
[[nodiscard]] ScanTiming timing_of(const JournalEntry& live);

/// One owner. The job's rate, progress and on_result are its caller's affair.
class RunPlayer {
 public:
    /// Throws InputError: a log that cannot be read, a map that cannot be loaded.
    explicit RunPlayer(const ReplayJob& job);

    /// The next sample, its stamps on one time line over all logs; nullptr at the end. Throws InputError.
    [[nodiscard]] const LogEvent* next();
    /// Plays the sample that next() gave. A result where it was a scan.
    std::optional<ScanResult> play();

    /// Of what play() gave last: the recorded stamp of the pose [s], and the processor time of the core [s], odometry
    /// since the scan before included.
    [[nodiscard]] double recorded_stamp_s() const { return recorded_stamp_s_; }
    [[nodiscard]] double core_s() const { return core_s_; }
    /// How far the reading has come, 0 to 1.
    [[nodiscard]] double share() const;

    [[nodiscard]] const Config& config() const { return run_.config; }
    [[nodiscard]] const Pipeline& pipeline() const { return *pipeline_; }
    [[nodiscard]] TileArchive& far_tiles() { return *far_tiles_; }
    /// Summed over the logs so far.
    [[nodiscard]] LogCounts counts() const;
    [[nodiscard]] std::vector<SourceReport> sources() const;
    /// Why nothing could be played, where there was no scan.
    [[nodiscard]] InputError without_scans() const;

    /// Once it is at its end.
    [[nodiscard]] std::unique_ptr<Pipeline> take_pipeline() { return std::move(pipeline_); }
    [[nodiscard]] std::unique_ptr<TileArchive> take_far_tiles() { return std::move(far_tiles_); }

 private:
    void load_map(const ReplayJob& job);
    void end_part();

    Run run_;
    std::vector<std::filesystem::path> logs_;
    std::unique_ptr<Pipeline> pipeline_;
    std::unique_ptr<TileArchive> far_tiles_;
    TileRings* tile_rings_;
    std::unique_ptr<LogEvent> event_;
    std::size_t part_ = 0;
    Duration origin_;  ///< each log's time line starts at 0: they are laid end to end
    Stamp newest_;
    bool scan_played_ = false;
    double since_scan_s_ = 0.0;
    double core_s_ = 0.0;
    double recorded_stamp_s_ = 0.0;
    LogCounts counts_;  ///< of the parts that have ended
    std::vector<SourceReport> sources_;
};

}  // namespace crspf
