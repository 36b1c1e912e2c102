#include "tools/crspf/run_player.hpp"

#include <algorithm>
#include <ctime>
#include <string_view>
#include <utility>

#include "platform/service/map_image.hpp"
#include "tools/crspf/run_report.hpp"

namespace crspf {
namespace {

double thread_time_s() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

std::unique_ptr<Pipeline> make_pipeline(const Config& config, const ReplayJob& job) {
    SlamParams params = config.slam;
    params.localize_only = job.localize.has_value();
    return std::make_unique<Pipeline>(params, job.kernel);
}

std::optional<ScanResult> feed(const LogEvent& event, Pipeline& slam) {
    const ScanTiming timing = event.live ? timing_of(*event.live) : ScanTiming{};
    switch (event.kind) {
        case LogEvent::Kind::kMotion: slam.on_motion(event.motion); break;
        case LogEvent::Kind::kDifferential: slam.on_wheel(event.differential); break;
        case LogEvent::Kind::kAckermann: slam.on_wheel(event.ackermann); break;
        case LogEvent::Kind::kImu: slam.on_imu(event.imu); break;
        case LogEvent::Kind::kPlace: slam.set_pose(event.place.P_map_base); break;
        case LogEvent::Kind::kScan: return slam.on_scan(event.scan, timing);
        case LogEvent::Kind::kCloud: return slam.on_cloud(*event.cloud, timing);
    }
    return std::nullopt;
}

}  // namespace

ScanTiming timing_of(const JournalEntry& live) {
    return {.changes = live.changes,
            .update = live.updated,
            .tiles = ScanTiming::Tiles{.tidy = live.tidy, .tiles = live.tiles}};
}

RunPlayer::RunPlayer(const ReplayJob& job)
    : run_(open_run(job.logs, job.config)),
      logs_(job.logs),
      pipeline_(make_pipeline(run_.config, job)),
      far_tiles_(std::make_unique<TileArchive>(std::filesystem::temp_directory_path())),
      tile_rings_(&pipeline_->add_tile_keeper()),
      event_(std::make_unique<LogEvent>()) {
    if (job.localize) {
        load_map(job);
    }
    if (job.initial_pose) {
        pipeline_->set_pose(*job.initial_pose);
    }
}

void RunPlayer::load_map(const ReplayJob& job) {
    for (const TileRecord& tile : tiles_of(read_grid_map(*job.localize), job.localize->string(),
                                           run_.config.slam.map.resolution_m, job.initial_pose.value_or(Pose2{}))) {
        if (pipeline_->map().tiles() < capacity::kTilesKept) {
            pipeline_->load(tile);
        } else {
            far_tiles_->keep(tile.cell, tile.cells);
        }
    }
}

const LogEvent* RunPlayer::next() {
    if (std::exchange(scan_played_, false)) {
        far_tiles_->turn(*tile_rings_);
    }
    for (; part_ < run_.parts.size(); end_part()) {
        if (run_.parts[part_]->next(*event_)) {
            shift(*event_, origin_);
            newest_ = std::max(newest_, stamp_of(*event_));
            return event_.get();
        }
    }
    return nullptr;
}

void RunPlayer::end_part() {
    const std::unique_ptr<LogReader> log = std::move(run_.parts[part_++]);
    add(counts_, log->counts());
    for (SourceReport& source : log->sources()) {
        sources_.push_back(std::move(source));
    }
    origin_ = newest_ - Stamp{};
}

std::optional<ScanResult> RunPlayer::play() {
    const double start_s = thread_time_s();
    std::optional<ScanResult> result = feed(*event_, *pipeline_);
    since_scan_s_ += thread_time_s() - start_s;
    if (result) {
        scan_played_ = true;
        core_s_ = std::exchange(since_scan_s_, 0.0);
        // Of a revolution the pose is that of its scan's beam 0, which is measured last.
        recorded_stamp_s_ = event_->recorded_stamp_s + (result->stamp - stamp_of(*event_)).seconds();
    }
    return result;
}

double RunPlayer::share() const {
    const double within = part_ < run_.parts.size() ? run_.parts[part_]->progress() : 0.0;
    return (static_cast<double>(part_) + within) / static_cast<double>(std::max<std::size_t>(run_.parts.size(), 1));
}

LogCounts RunPlayer::counts() const {
    LogCounts sum = counts_;
    if (part_ < run_.parts.size()) {
        add(sum, run_.parts[part_]->counts());
    }
    return sum;
}

std::vector<SourceReport> RunPlayer::sources() const {
    std::vector<SourceReport> all = sources_;
    if (part_ < run_.parts.size()) {
        for (SourceReport& source : run_.parts[part_]->sources()) {
            all.push_back(std::move(source));
        }
    }
    return all;
}

InputError RunPlayer::without_scans() const {
    std::string what = logs_.empty() ? "no log given" : logs_.back().string() + ": no usable scan in it";
    const LogCounts log = counts();
    if (!log.first_damage.empty()) {
        what += "; first of " + std::to_string(log.damaged_lines) + " damaged lines: " + log.first_damage;
    }
    for (const SourceReport& source : sources()) {
        what += "; " + text_of(source);
        if (std::any_of(source.counts.begin(), source.counts.end(), [](const auto& entry) {
                return std::string_view(entry.first) == "foreign" && entry.second > 0;
            })) {
            what += ", which is datagrams from another than its `address`: crspf inspect lists who sent them";
        }
    }
    InputError error(what + "; is it a CARMEN log, a URG-04LX .dat or a recording of a lidar?");
    return error;
}

}  // namespace crspf
