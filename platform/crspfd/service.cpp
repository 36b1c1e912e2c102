#include "platform/crspfd/service.hpp"

#include <algorithm>
#include <cstring>
#include <map>
#include <utility>

#include "platform/files/input_error.hpp"
#include "platform/files/planning_map.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "platform/linux/socketcan.hpp"
#include "platform/service/map_image.hpp"

namespace crspf {

namespace {

constexpr Duration kTurn{100'000'000};         ///< each loop goes round at least so often
constexpr Duration kLidarStale{500'000'000};   ///< five scans of the slowest lidar
constexpr Duration kFailed{3'000'000'000};     ///< without a sample
constexpr Duration kCopyMax{5'000'000'000};    ///< that copying the map may take
constexpr Duration kPoseSaved{5'000'000'000};  ///< between two savings of the pose
constexpr Duration kTileKeeperTurn{50'000'000};

std::unique_ptr<CanBus> open_can(const PoseOutputConfig& config) {
    // Nothing is wanted from the bus but its errors: a filter that only our own frames would pass.
    return std::make_unique<SocketCan>(
        config.can, std::vector<CanFilter>{{.id = config.base_id, .mask = 0x7FF, .extended = false}});
}

void require_source(const Config& config, bool lidar, const std::string& what) {
    if (std::none_of(config.sources.begin(), config.sources.end(), [lidar](const SourceConfig& source) {
            return is_lidar(source.driver) == lidar && !source.record_only;
        })) {
        throw InputError("no " + what + " is configured; give --config with a [source.NAME] table for it, as in " +
                         "config/examples");
    }
}

}  // namespace

Service::Service(const Config& config, ServiceOptions options)
    : config_(config),
      options_(std::move(options)),
      store_(config.service.state_directory),
      far_tiles_(config.service.state_directory),
      exchange_(std::make_unique<Exchange>()) {
    require_source(config_, true, "lidar");
    require_source(config_, false, "odometer");
    config_.slam.localize_only = config_.service.localize_only;
    if (std::any_of(config_.sources.begin(), config_.sources.end(), gives_clouds)) {
        exchange_->cloud = std::make_unique<LatestValue<ReceivedCloud>>();
    }
    odometry_ = std::make_unique<OdometryModule>(config_.slam.odometry, *exchange_);
    filter_ = std::make_unique<FilterModule>(config_.slam, *exchange_);
    map_ = std::make_unique<MapModule>(config_.slam, *exchange_);
    std::unique_ptr<CanBus> bus;
    if (!config_.pose_output.can.empty()) {
        bus = options_.open_bus ? options_.open_bus(config_.pose_output) : open_can(config_.pose_output);
    }
    output_ = std::make_unique<OutputModule>(config_.pose_output, *exchange_, std::move(bus));
    search_ = std::make_unique<PoseSearch>(*exchange_, config_.service.relocalize);
    watch_feed_ = std::make_unique<WatchFeed>(*exchange_, far_tiles_, config_.slam);
    for (const SourceConfig& source : config_.sources) {
        const LidarParams& lidar = config_.slam.lidar;
        sources_.emplace_back(source,
                              options_.open_source ? options_.open_source(source, lidar) : open_live(source, lidar),
                              *exchange_, odometry_wakeup_, filter_wakeup_);
    }
    if (!config_.service.record_directory.empty()) {
        recorder_ = std::make_unique<RunRecorder>(config_, sources_, *exchange_);
    }
    source_states_.assign(sources_.size(), SourceState::kStarting);
    load_map();
    plan_workers();
}

Service::~Service() {
    for (Worker& worker : workers_) {
        worker.thread.join();
    }
}

void Service::load_map() {
    const std::optional<MapStore::Saved> saved = store_.load();
    if (!saved) {
        if (config_.service.localize_only) {
            throw InputError(config_.service.state_directory +
                             ": no map is saved there to localise on; map first, with [service] localize_only = false");
        }
        return;
    }
    const auto changes = std::make_unique<ChangeList>();
    for (const TileRecord& tile : tiles_of(saved->map, saved->yaml.string(), config_.slam.map.resolution_m,
                                           saved->P_map_base.value_or(Pose2{}))) {
        if (map_->map().tiles() == capacity::kTilesKept) {
            far_tiles_.keep(tile.cell, tile.cells);
            continue;
        }
        changes->clear();
        map_->load(tile, *changes);
        filter_->follow(*changes);
    }
    map_->show();
    known_pose_ = saved->P_map_base;
    if (known_pose_) {
        filter_->set_pose(*known_pose_);
    } else if (map_->map().tiles() > 0) {  // on an empty one there is nothing to be found again
        filter_->forget_pose();
    }
    if (!saved->warning.empty()) {
        news_.push_back({.bad = true, .text = saved->warning + "; the map saved before it is used"});
    }
}

void Service::plan_workers() {
    const ThreadsConfig& threads = config_.threads;
    const auto plan = [this](const std::string& name, const ThreadConfig& config) -> Worker& {
        Worker& worker = workers_.emplace_back();
        worker.name = name;
        worker.config = config;
        return worker;
    };
    const auto deadline_of = [](const Worker& worker) {
        return Duration::from_seconds(1e-3 * worker.config.deadline_ms);
    };
    for (SourceThread& source : sources_) {
        Worker& worker = plan("rx-" + source.config().name, threads.receive);
        worker.turn = [&worker, &source, deadline = deadline_of(worker)] { source.turn(worker.health, deadline); };
    }
    {
        Worker& worker = plan("odometry", threads.odometry);
        worker.turn = [this, &worker, deadline = deadline_of(worker)] {
            odometry_wakeup_.wait_until(monotonic_now() + kTurn);
            const Stamp now = monotonic_now();
            worker.health.turned(now);
            if (odometry_->turn(now)) {
                worker.health.worked(odometry_->latency(), deadline);
            }
        };
    }
    {
        Worker& worker = plan("filter", threads.filter);
        worker.turn = [this, &worker, deadline = deadline_of(worker)] {
            filter_wakeup_.wait_until(monotonic_now() + kTurn);
            worker.health.turned(monotonic_now());
            if (filter_->turn(monotonic_now)) {
                worker.health.worked(filter_->latency(), deadline);
            }
            odometry_wakeup_.notify();
            map_wakeup_.notify();
        };
    }
    {
        Worker& worker = plan("map", threads.map);
        worker.turn = [this, &worker, deadline = deadline_of(worker)] {
            map_wakeup_.wait_until(monotonic_now() + kTurn);
            for (bool more = true; more;) {
                const Stamp begin = monotonic_now();
                worker.health.turned(begin);
                more = map_->turn();
                if (more) {
                    worker.health.worked(monotonic_now() - begin, deadline);
                }
            }
        };
    }
    {
        Worker& worker = plan("output", threads.output);
        worker.turn = [this, &worker, next = Stamp{}, deadline = deadline_of(worker)]() mutable {
            const Duration period = output_->period();
            const Stamp before = monotonic_now();
            next = next + period;
            if (next + period < before) {
                next = before;  // the first turn, or the machine has slept
            }
            sleep_until(next);
            const Stamp now = monotonic_now();
            worker.health.turned(now);
            worker.health.worked(now - next, deadline);
            output_->turn(now);
        };
    }
}

void Service::start_worker(Worker& worker) {
    constexpr std::size_t kNameMax = 15;
    ThreadParams params{
        .name = worker.name.substr(0, kNameMax), .priority = worker.config.priority, .cpus = worker.config.cpus};
    const auto body = [&worker](const std::atomic<bool>& stop) {
        while (!stop.load(std::memory_order_relaxed)) {
            worker.turn();
        }
    };
    worker.health.turned(monotonic_now());
    int error = worker.thread.start(params, body);
    if (error == EPERM && options_.allow_degraded) {
        realtime_ = false;
        params.priority = 0;
        error = worker.thread.start(params, body);
    }
    if (error == EPERM) {
        throw InputError("thread " + worker.name + ": SCHED_FIFO priority " + std::to_string(params.priority) +
                         " is not allowed; give LimitRTPRIO= or CAP_SYS_NICE, or --allow-degraded");
    }
    if (error != 0) {
        throw InputError("thread " + worker.name + ": cannot be started: " + ::strerrordesc_np(error) +
                         "; look at its priority and cpus in [threads]");
    }
}

void Service::start() {
    started_ = map_saved_ = pose_saved_ = planned_ = monotonic_now();
    if (const int error = lock_memory(); error != 0) {
        locked_ = false;
        if (!options_.allow_degraded) {
            throw InputError(std::string("memory cannot be locked: ") + ::strerrordesc_np(error) +
                             "; give LimitMEMLOCK=infinity or CAP_IPC_LOCK, or --allow-degraded");
        }
    }
    if (recorder_ != nullptr) {
        recorder_->start();
    }
    tile_keeper_ = std::jthread([this](const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            far_tiles_.turn(exchange_->far_tiles);
            sleep_until(monotonic_now() + kTileKeeperTurn);
        }
    });
    for (Worker& worker : workers_) {
        start_worker(worker);
    }
    running_ = true;
}

void Service::stop() {
    if (!std::exchange(running_, false)) {
        return;
    }
    for (Worker& worker : workers_) {
        worker.thread.request_stop();
    }
    for (Worker& worker : workers_) {
        worker.thread.join();
    }
    recorder_.reset();
    tile_keeper_ = {};
    far_tiles_.turn(exchange_->far_tiles);
    refresh();
    if (!config_.service.localize_only) {
        save_map();
    } else if (known_pose_) {
        store_.save_pose(*known_pose_);
    }
}

bool Service::alive() const {
    const Stamp now = monotonic_now();
    return std::all_of(workers_.begin(), workers_.end(),
                       [now](const Worker& worker) { return now - worker.health.last_turn() < kStuck; });
}

std::vector<ServiceEvent> Service::tick() {
    std::vector<ServiceEvent> events = std::exchange(news_, {});
    refresh();
    watch_sources(events);
    watch_pose(events);
    look_for_robot(events);
    save_when_due(events);
    return events;
}

void Service::refresh() {
    exchange_->odometry.for_control.update();
    exchange_->filter.for_control.update();
    exchange_->map.update();
    output_->state.update();
    if (const PoseReport& report = output_->state.value().report; output_->state.number() > 0 && !report.lost) {
        known_pose_ = report.P_map_base;
    }
}

Service::SourceState Service::state_of(SourceThread& source) const {
    const Stamp last = source.last_sample();
    const Stamp now = monotonic_now();
    if (last <= Stamp{}) {
        return now - started_ < kFailed ? SourceState::kStarting : SourceState::kFailed;
    }
    const Duration stale =
        is_lidar(source.config().driver) ? kLidarStale : Duration::from_seconds(config_.pose_output.odometry_stale_s);
    return now - last > kFailed            ? SourceState::kFailed
           : now - last > stale            ? SourceState::kStale
           : source.report().blind > stale ? SourceState::kBlind
                                           : SourceState::kOk;
}

const char* Service::name_of(SourceState state) {
    switch (state) {
        case SourceState::kStarting: return "starting";
        case SourceState::kOk: return "ok";
        case SourceState::kBlind: return "blind";
        case SourceState::kStale: return "stale";
        case SourceState::kFailed: break;
    }
    return "failed";
}

void Service::watch_sources(std::vector<ServiceEvent>& events) {
    for (std::size_t i = 0; i < sources_.size(); ++i) {
        SourceThread& source = sources_[i];
        const SourceState state = state_of(source);
        if (state != source_states_[i]) {
            source_states_[i] = state;
            events.push_back({.bad = state != SourceState::kOk,
                              .text = "source " + source.config().name + ": " + name_of(state) + ": " +
                                      std::string(source.report().state.view())});
        }
    }
}

void Service::watch_pose(std::vector<ServiceEvent>& events) {
    const bool lost = output_->state.value().report.lost;
    if (output_->state.number() > 0 && lost != was_lost_) {
        was_lost_ = lost;
        events.push_back({.bad = lost, .text = lost ? "the pose is lost" : "the pose is known"});
    }
}

void Service::look_for_robot(std::vector<ServiceEvent>& events) {
    const bool lost = exchange_->filter.for_control.value().result.lost;
    const std::optional<FilterCommand> found = search_->turn(
        monotonic_now(), lost, [this] { return copy_map(); }, events);
    if (found) {
        static_cast<void>(
            exchange_->commands.push(*found));  // a full ring: the robot stays lost, and is looked for again
        filter_wakeup_.notify();
    }
}

void Service::save_when_due(std::vector<ServiceEvent>& events) {
    const Stamp now = monotonic_now();
    try {
        const double every_s = config_.service.save_every_s;
        if (!config_.service.localize_only && every_s > 0.0 && (now - map_saved_).seconds() >= every_s) {
            map_saved_ = pose_saved_ = now;
            events.push_back({.bad = false, .text = "map saved: " + save_map().string()});
            save_problem_.clear();
        } else if (now - pose_saved_ >= kPoseSaved && known_pose_) {
            pose_saved_ = now;
            store_.save_pose(*known_pose_);
            save_problem_.clear();
        }
        const double planning_s = config_.service.planning_every_s;
        if (planning_s > 0.0 && (now - planned_).seconds() >= planning_s) {
            planned_ = now;
            write_grid_map(planning_map(copy_map()), store_.directory() / "planning");
        }
    } catch (const InputError& e) {
        if (save_problem_ != e.what()) {
            save_problem_ = e.what();
            events.push_back({.bad = true, .text = save_problem_});
        }
    }
}

GridMap Service::copy_map() {
    std::map<std::pair<std::int32_t, std::int32_t>, TileCells> tiles;
    const std::uint32_t wanted = exchange_->copies_wanted.fetch_add(1, std::memory_order_release) + 1;
    const Stamp deadline = monotonic_now() + kCopyMax;
    for (bool last = false; !last;) {
        map_wakeup_.notify();
        const TileCopy* const copy = exchange_->tiles.front();
        if (copy == nullptr) {
            if (monotonic_now() > deadline) {
                throw InputError("the map thread does not answer; is the machine overloaded? See crspf ctl status");
            }
            sleep_until(monotonic_now() + Duration{1'000'000});
            continue;
        }
        const bool ours = copy->copy == wanted;  // not what is left of one that was given up
        if (ours && !copy->empty) {
            tiles[{copy->corner.y, copy->corner.x}] = copy->tile.cells;
        }
        last = ours && copy->last;
        exchange_->tiles.pop();
    }
    far_tiles_.turn(exchange_->far_tiles);  // what was sent away meanwhile is not missed
    return export_map(
        [this, &tiles](const TileVisitor& visit) {
            far_tiles_.for_each_tile(visit);
            for (const auto& [corner, cells] : tiles) {
                visit({.x = corner.second, .y = corner.first}, cells);
            }
        },
        config_.slam.map.resolution_m);
}

std::filesystem::path Service::save_map() {
    const GridMap map = running_ ? copy_map() : export_map(map_->map(), config_.slam.map.resolution_m, &far_tiles_);
    refresh();
    return store_.save(map, known_pose_);
}

bool Service::set_pose(const Pose2& P_map_base) {
    const bool taken = exchange_->commands.push({.P_map_base = P_map_base});
    filter_wakeup_.notify();
    return taken;
}

}  // namespace crspf
