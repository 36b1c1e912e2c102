// The running robot service: sensors, the SLAM's modules in real-time threads of their own, and the pose on the bus.
#pragma once

#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "config/config.hpp"
#include "platform/crspfd/exchange.hpp"
#include "platform/crspfd/filter_module.hpp"
#include "platform/crspfd/map_module.hpp"
#include "platform/crspfd/map_store.hpp"
#include "platform/crspfd/odometry_module.hpp"
#include "platform/crspfd/output_module.hpp"
#include "platform/crspfd/pose_search.hpp"
#include "platform/crspfd/run_recorder.hpp"
#include "platform/crspfd/service_event.hpp"
#include "platform/crspfd/source_thread.hpp"
#include "platform/crspfd/thread_health.hpp"
#include "platform/crspfd/watch_board.hpp"
#include "platform/crspfd/watch_feed.hpp"
#include "platform/linux/realtime_thread.hpp"
#include "platform/linux/wakeup.hpp"
#include "platform/service/tile_archive.hpp"

namespace crspf {

struct ServiceOptions {
    /// Goes on without SCHED_FIFO and locked memory, and says so in its status.
    bool allow_degraded = false;
    // Tests give simulated ports. Default: those of this machine.
    std::function<std::unique_ptr<LiveSource>(const SourceConfig&, const LidarParams&)> open_source;
    std::function<std::unique_ptr<CanBus>(const PoseOutputConfig&)> open_bus;
};

/// Every method but alive() is the control thread's, an ordinary one; the real-time threads are inside.
class Service {
 public:
    /// Loads the saved map, if there is one. Throws InputError: no lidar or no odometer configured, a map that cannot
    /// be used.
    Service(const Config& config, ServiceOptions options);
    Service(const Service&) = delete;
    Service& operator=(const Service&) = delete;
    ~Service();

    /// Throws InputError where the threads cannot be what the configuration asks for.
    void start();
    /// The threads end; the map is saved. Throws InputError where it cannot be.
    void stop();

    /// To be called at least ten times a second. Sees what has changed, saves the map when it is due, looks for a robot
    /// that is lost. @return what has happened since the last call
    std::vector<ServiceEvent> tick();
    /// Puts onto the board what those who watch want to see. To be called after tick(), also where nobody does any
    /// longer.
    void show(WatchBoard& board);
    /// Whether every thread's loop has turned within the last second. After start(), from any thread.
    [[nodiscard]] bool alive() const;

    /// Version 1; docs/service.md describes it.
    [[nodiscard]] nlohmann::ordered_json status();
    [[nodiscard]] nlohmann::ordered_json pose();
    /// The map as it is now, into the store. @return its YAML file. Throws InputError.
    std::filesystem::path save_map();
    /// Where the robot is. False: earlier ones have not been taken yet.
    bool set_pose(const Pose2& P_map_base);
    /// Looks for the robot in the whole map, lost or not. @return PoseSearchState::searches when the answer is there
    std::uint64_t relocalize() { return search_->ask(); }

 private:
    static constexpr Duration kStuck{1'000'000'000};  ///< a loop that has not gone round for so long

    struct Worker {
        std::string name;
        ThreadConfig config;
        std::function<void()> turn;
        ThreadHealth health;
        RealtimeThread thread;
    };
    enum class SourceState : std::uint8_t { kStarting, kOk, kBlind, kStale, kFailed };

    void load_map();
    void plan_workers();
    void start_worker(Worker& worker);
    [[nodiscard]] GridMap copy_map();
    void refresh();
    [[nodiscard]] SourceState state_of(SourceThread& source) const;
    void watch_sources(std::vector<ServiceEvent>& events);
    void watch_pose(std::vector<ServiceEvent>& events);
    void look_for_robot(std::vector<ServiceEvent>& events);
    void save_when_due(std::vector<ServiceEvent>& events);
    static const char* name_of(SourceState state);

    Config config_;
    ServiceOptions options_;
    MapStore store_;
    TileArchive far_tiles_;

    std::unique_ptr<Exchange> exchange_;
    std::unique_ptr<OdometryModule> odometry_;
    std::unique_ptr<FilterModule> filter_;
    std::unique_ptr<MapModule> map_;
    std::unique_ptr<OutputModule> output_;
    std::unique_ptr<PoseSearch> search_;
    std::unique_ptr<WatchFeed> watch_feed_;
    Wakeup odometry_wakeup_;
    Wakeup filter_wakeup_;
    Wakeup map_wakeup_;
    std::deque<SourceThread> sources_;
    std::jthread tile_keeper_;               ///< writes far tiles to the disk and brings them back
    std::unique_ptr<RunRecorder> recorder_;  ///< nullptr: nothing is recorded
    std::deque<Worker> workers_;
    bool running_ = false;
    bool realtime_ = true;
    bool locked_ = true;

    Stamp started_;
    Stamp map_saved_;
    Stamp pose_saved_;
    Stamp planned_;       ///< the map to plan on was last written
    Stamp status_shown_;  ///< to those who watch
    bool was_lost_ = false;
    std::optional<Pose2> known_pose_;  ///< the last one that was not lost, be it of the run before
    std::vector<ServiceEvent> news_;   ///< for the next tick()
    std::string save_problem_;
    std::vector<SourceState> source_states_;
};

}  // namespace crspf
