// A robot's topics at a broker (docs/mqtt.md): of what happens the message that is to go out next. Nothing waits in a
// queue: of pose and health the newest is kept, of the map a number up to which the broker has it, of the log a few
// lines.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "core/base/time.hpp"
#include "tools/mqtt/pace.hpp"
#include "tools/mqtt/publication.hpp"
#include "tools/mqtt/robot_health.hpp"
#include "tools/view/run_events.hpp"
#include "tools/view/tile_store.hpp"

namespace crspf::mqtt {

struct TopicOptions {
    std::string prefix = "crspf";
    std::string robot;
    double pose_hz = 2.0;
    std::string version;  ///< of crspf
};

/// An instant by both clocks.
struct Moment {
    Stamp now;
    std::int64_t utc_ns = 0;  ///< [ns] UTC since 1970
};

/// Not thread-safe: one owner.
class RobotTopics {
 public:
    static constexpr Duration kHealthPeriod{10'000'000'000};  ///< where nothing changes
    static constexpr Duration kHealthMin{1'000'000'000};      ///< however often it changes
    static constexpr Duration kMapPeriod{2'000'000'000};      ///< between two looks at what has changed
    static constexpr std::size_t kLogMax = 50;                ///< lines that wait for a broker

    /// Lines of the log before `begun` are old news. Throws InputError for a prefix or a name that cannot be a topic's.
    RobotTopics(TopicOptions options, Moment begun);
    RobotTopics(const RobotTopics&) = delete;
    RobotTopics& operator=(const RobotTopics&) = delete;
    ~RobotTopics() = default;

    /// Retained; "false" is the will, too.
    [[nodiscard]] Publication online(bool yes) const;

    void take(const view::RunEvent& event, Moment moment);
    /// A new connection: the broker may have forgotten everything.
    void begin();
    /// What is to go out next, if anything is. Constant time but for a tile's compression.
    [[nodiscard]] std::optional<Publication> next(Moment moment);

 private:
    using TileName = std::pair<std::int32_t, std::int32_t>;  ///< column, row

    void take_log(const view::LogLine& line);
    [[nodiscard]] std::string topic(const std::string& leaf) const;
    [[nodiscard]] Publication kept(const std::string& leaf, const nlohmann::ordered_json& payload) const;
    [[nodiscard]] std::optional<Publication> next_health(Moment moment);
    [[nodiscard]] std::optional<Publication> next_pose(Stamp now);
    [[nodiscard]] std::optional<Publication> next_log();
    [[nodiscard]] std::optional<Publication> next_map(Stamp now);
    [[nodiscard]] std::optional<Publication> next_old_tile();

    TopicOptions options_;
    bool online_told_ = false;

    RobotHealth health_;
    nlohmann::ordered_json gist_told_;
    Pace health_pace_{kHealthPeriod};
    Pace health_change_pace_{kHealthMin};

    nlohmann::ordered_json pose_;  ///< null: the newest has gone out
    Pace pose_pace_;

    std::deque<nlohmann::ordered_json> log_;
    std::int64_t log_ns_;  ///< stamp of the last line that was taken: a service that is back tells all of its log again
    std::uint64_t log_lost_ = 0;

    view::TileStore tiles_;
    std::int64_t map_id_ = 0;
    std::uint64_t reader_ = 0;       ///< number of the change up to which the broker has the map
    std::uint64_t reads_until_ = 0;  ///< of the last one in this look
    Pace map_pace_{kMapPeriod};
    std::set<TileName> at_broker_;
    std::set<TileName> old_;  ///< at the broker, of a map before, or of another connection
};

}  // namespace crspf::mqtt
