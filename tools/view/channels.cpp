#include "tools/view/channels.hpp"

#include <cstddef>
#include <utility>

#include "tools/view/channel_schemas.hpp"
#include "tools/view/diagnostics.hpp"
#include "tools/view/kept_messages.hpp"
#include "tools/view/messages.hpp"
#include "tools/view/path_keeper.hpp"
#include "tools/view/tile_store.hpp"

namespace crspf::view {
namespace {

constexpr std::size_t kScansKept = 600;
constexpr std::size_t kLogLinesKept = 200;

std::size_t kept_of(Topic topic) {
    switch (topic) {
        case Topic::kMatch: return kScansKept;
        case Topic::kLog: return kLogLinesKept;
        case Topic::kTf:
        case Topic::kPose:
        case Topic::kPath:
        case Topic::kScan:
        case Topic::kMap:
        case Topic::kMapTiles:
        case Topic::kStatus:
        case Topic::kDiagnostics: break;
    }
    return 1;
}

}  // namespace

struct Channels::State {
    State() {
        for (std::size_t i = 0; i < kTopics; ++i) {
            kept.emplace_back(kept_of(static_cast<Topic>(i)));
        }
    }

    void push(Topic topic, std::int64_t stamp_ns, const Json& data) {
        kept[static_cast<std::size_t>(topic)].push(message_of(stamp_ns, data));
    }
    std::shared_ptr<const Message> next_kept(Topic topic, std::uint64_t& cursor) {
        return kept[static_cast<std::size_t>(topic)].next(cursor);
    }

    void take(const ScanEvent& scan);
    void take(const TilesEvent& event);
    void take(const StatusEvent& status);
    void take(const LogLine& line);
    void take(const AwayEvent& event);

    std::shared_ptr<const Message> next_path(std::uint64_t& cursor);
    std::shared_ptr<const Message> next_map(std::uint64_t& cursor);
    std::shared_ptr<const Message> next_tiles(std::uint64_t& cursor);

    std::vector<ChannelInfo> table = channel_table();
    std::vector<KeptMessages> kept;  ///< by Topic
    bool begun = false;              ///< something with a stamp has happened; before that there is no time to tell
    std::int64_t now_ns = 0;         ///< stamp of what happened last
    std::int64_t scan_ns = 0;        ///< of the last scan
    bool away = false;               ///< nothing comes for a while: what waits for its second goes out

    PathKeeper path;
    bool path_changed = false;
    OnceASecond path_sent;

    TileStore tiles;
    std::uint64_t map_shown = 0;  ///< version of the tiles in the last picture
    OnceASecond map_sent;
    /// The last message of /map/tiles: readers that keep up ask for the same one.
    struct {
        std::uint64_t version = 0;
        std::uint64_t from = 0;
        std::uint64_t to = 0;
        std::shared_ptr<const Message> message;
    } tiles_made;

    OnceASecond diagnosed;
};

void Channels::State::take(const ScanEvent& scan) {
    if (scan.stamp_ns <
        scan_ns - OnceASecond::kPeriod_ns) {  // played again from an earlier place, or the clock was set
        path.clear();
        kept[static_cast<std::size_t>(Topic::kMatch)].forget();
    }
    now_ns = scan_ns = scan.stamp_ns;
    begun = true;
    away = false;
    push(Topic::kTf, scan.stamp_ns, tf_message(scan));
    push(Topic::kPose, scan.stamp_ns, pose_message(scan));
    push(Topic::kMatch, scan.stamp_ns, match_message(scan));
    if (!scan.points.empty()) {
        push(Topic::kScan, scan.stamp_ns, scan_message(scan));
    }
    path_changed = path.add(scan.P_map_base) || path_changed;
}

void Channels::State::take(const TilesEvent& event) {
    if (event.fresh) {
        path.clear();
        path_changed = true;
    }
    tiles.take(event);
}

void Channels::State::take(const StatusEvent& status) {
    now_ns = status.stamp_ns;
    begun = true;
    away = false;
    push(Topic::kStatus, status.stamp_ns, status_message(status));
    if (diagnosed.due(now_ns)) {
        diagnosed.done(now_ns);
        push(Topic::kDiagnostics, status.stamp_ns, diagnostics_of(status));
    }
}

void Channels::State::take(const LogLine& line) {
    push(Topic::kLog, line.stamp_ns, log_message(line));
}

void Channels::State::take(const AwayEvent& event) {
    away = event.away;
    push(Topic::kStatus, now_ns, {{"timestamp", time_of(now_ns)}, {"away", event.away}, {"why", event.why}});
}

std::shared_ptr<const Message> Channels::State::next_path(std::uint64_t& cursor) {
    if (begun && path_changed && (away || path_sent.due(now_ns))) {
        path_changed = false;
        path_sent.done(now_ns);
        push(Topic::kPath, now_ns, path_message(now_ns, path.poses()));
    }
    return next_kept(Topic::kPath, cursor);
}

std::shared_ptr<const Message> Channels::State::next_map(std::uint64_t& cursor) {
    if (begun && map_shown != tiles.version() && !tiles.empty() && (away || map_sent.due(now_ns))) {
        map_shown = tiles.version();
        map_sent.done(now_ns);
        push(Topic::kMap, now_ns, map_message(now_ns, tiles.picture()));
    }
    return next_kept(Topic::kMap, cursor);
}

std::shared_ptr<const Message> Channels::State::next_tiles(std::uint64_t& cursor) {
    if (!begun || cursor >= tiles.version()) {
        return nullptr;
    }
    if (tiles_made.message == nullptr || tiles_made.version != tiles.version() || tiles_made.from != cursor) {
        std::uint64_t to = cursor;
        const Json data = tiles.changes_since(to, now_ns);
        tiles_made = {.version = tiles.version(), .from = cursor, .to = to, .message = message_of(now_ns, data)};
    }
    cursor = tiles_made.to;
    return tiles_made.message;
}

Channels::Channels() : state_(std::make_unique<State>()) {}
Channels::~Channels() = default;

const std::vector<ChannelInfo>& Channels::all() const {
    return state_->table;
}

void Channels::take(const RunEvent& event) {
    std::visit([this](const auto& what) { state_->take(what); }, event);
}

std::shared_ptr<const Message> Channels::next(Id channel, std::uint64_t& cursor) {
    switch (static_cast<Topic>(channel)) {
        case Topic::kPath: return state_->next_path(cursor);
        case Topic::kMap: return state_->next_map(cursor);
        case Topic::kMapTiles: return state_->next_tiles(cursor);
        case Topic::kTf:
        case Topic::kPose:
        case Topic::kScan:
        case Topic::kMatch:
        case Topic::kStatus:
        case Topic::kDiagnostics:
        case Topic::kLog: break;
    }
    return state_->next_kept(static_cast<Topic>(channel), cursor);
}

}  // namespace crspf::view
