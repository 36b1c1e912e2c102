#include "tools/view/metrics.hpp"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/view/status_parts.hpp"

namespace crspf::view {
namespace {

using Json = nlohmann::ordered_json;
using Labels = std::vector<std::pair<std::string_view, std::string_view>>;

constexpr double kMicro = 1e-6;
constexpr double kMilli = 1e-3;

/// A number or a truth of the status at a JSON pointer; an error's text that stands there counts as one.
std::optional<double> value_at(const Json& status, const std::string& pointer) {
    const Json::json_pointer at(pointer);
    if (!status.is_structured() || !status.contains(at)) {
        return std::nullopt;
    }
    const Json& value = status.at(at);
    if (value.is_boolean()) {
        return value.get<bool>() ? 1.0 : 0.0;
    }
    if (value.is_string()) {
        return value.get_ref<const std::string&>().empty() ? 0.0 : 1.0;
    }
    return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
}

std::string escaped(std::string_view value) {
    std::string out;
    for (const char c : value) {
        if (c == '\n') {
            out += "\\n";
            continue;
        }
        if (c == '\\' || c == '"') {
            out += '\\';
        }
        out += c;
    }
    return out;
}

/// Samples of one metric stand together, below what it means.
class Page {
 public:
    void about(std::string_view name, std::string_view type, std::string_view help) {
        head_ = fmt::format("# HELP {0} {1}\n# TYPE {0} {2}\n", name, help, type);
        name_ = name;
    }
    void sample(std::optional<double> value, const Labels& labels = {}) {
        if (!value) {
            return;
        }
        text_ += std::exchange(head_, {}) + name_;
        for (std::size_t i = 0; i < labels.size(); ++i) {
            text_ += fmt::format("{}{}=\"{}\"", i == 0 ? "{" : ",", labels[i].first, escaped(labels[i].second));
        }
        text_ += fmt::format("{} {}\n", labels.empty() ? "" : "}", *value);
    }
    [[nodiscard]] std::string take() { return std::move(text_); }

 private:
    std::string name_;
    std::string head_;  ///< until the first sample
    std::string text_;
};

struct Scalar {
    const char* name = "";
    const char* pointer = "";
    const char* help = "";
    double unit = 1.0;  ///< factor to the metric's unit
};

constexpr std::array<Scalar, 15> kGauges{{
    {"crspf_uptime_seconds", "/uptime_s", "Since the service started."},
    {"crspf_pose_lost", "/pose/lost", "1: the pose is not to be steered by."},
    {"crspf_pose_degenerate", "/pose/degenerate", "1: some direction is not seen."},
    {"crspf_pose_age_seconds", "/pose/age_ms", "Age of the scan that the pose rests on.", kMilli},
    {"crspf_pose_x_meters", "/pose/x_m", "Of base_link in the map frame."},
    {"crspf_pose_y_meters", "/pose/y_m", "Of base_link in the map frame."},
    {"crspf_pose_heading_degrees", "/pose/heading_deg", "Of base_link in the map frame."},
    {"crspf_match_value", "/pose/M", "M, the filtered match value (11)."},
    {"crspf_match_result", "/pose/result", "1: Result of (12), the scans match well."},
    {"crspf_map_tiles", "/map/tiles", "Tiles of the map in memory."},
    {"crspf_map_tiles_max", "/map/tiles_max", "Tiles that there is room for."},
    {"crspf_map_problem", "/map/problem", "1: the map cannot be saved."},
    {"crspf_odometry_blind_seconds", "/odometry/blind_s", "So long has the odometer seen nothing."},
    {"crspf_realtime", "/realtime/sched_fifo", "1: the threads have real-time priorities."},
    {"crspf_process_resident_max_bytes", "/process/rss_max_kib", "Most memory that was resident.", 1024.0},
}};

constexpr std::array<Scalar, 29> kCounters{{
    {"crspf_scans_total", "/filter/scans", "Scans that the filter has seen."},
    {"crspf_scans_matched_total", "/filter/matched", "Of these matched."},
    {"crspf_scans_skipped_total", "/filter/skipped", "Scans that came faster than they were matched."},
    {"crspf_scans_undrawn_total", "/filter/undrawn", "Scans that the map's thread had no room for."},
    {"crspf_scans_lost_total", "/filter/lost", "Scans while the robot was lost."},
    {"crspf_scans_degenerate_total", "/filter/degenerate", "Scans that saw nothing along some direction."},
    {"crspf_scans_too_few_rays_total", "/filter/too_few_rays", "Scans with too few rays to match."},
    {"crspf_scans_outside_map_total", "/filter/outside_map", "Scans outside the map's extent."},
    {"crspf_scans_drawn_total", "/map/drawn", "Scans drawn into the map."},
    {"crspf_map_refused_total", "/map/refused", "Writes that the map had no room for."},
    {"crspf_map_tiles_lost_total", "/map/tiles_lost", "Far tiles that could not be read back."},
    {"crspf_odometry_samples_total", "/odometry/samples", "Samples of the odometer."},
    {"crspf_odometry_not_finite_total", "/odometry/not_finite", "Samples that were no numbers."},
    {"crspf_odometry_ran_back_total", "/odometry/ran_back", "Samples whose stamps ran back."},
    {"crspf_odometry_gaps_total", "/odometry/gaps", "Gaps between samples."},
    {"crspf_odometry_implausible_total", "/odometry/implausible", "Samples that no such robot can make."},
    {"crspf_odometry_lost_to_full_rings_total", "/odometry/lost_to_full_rings", "Samples that a ring had no room for."},
    {"crspf_poses_total", "/output/poses", "Poses for the bus."},
    {"crspf_poses_lost_total", "/output/lost", "Of these marked lost."},
    {"crspf_poses_jumps_total", "/output/jumps", "Corrections taken at once."},
    {"crspf_poses_unsent_total", "/output/unsent", "Poses that the bus did not take."},
    {"crspf_bus_offs_total", "/output/bus_offs", "Times that the bus was off."},
    {"crspf_bus_send_timeouts_total", "/output/send_timeouts", "Frames that nobody acknowledged."},
    {"crspf_bus_queue_full_total", "/output/queue_full", "Frames that the queue had no room for."},
    {"crspf_relocalizations_total", "/relocalization/searches", "Searches for the robot in the whole map."},
    {"crspf_relocalizations_found_total", "/relocalization/found", "Of these with a place found."},
    {"crspf_recording_lost_total", "/recording/lost", "What the recorder could not write."},
    {"crspf_process_cpu_seconds_total", "/process/cpu_s", "Processor time of the service."},
    {"crspf_process_major_faults_total", "/process/major_faults", "Page faults that waited for the disk."},
}};

template <std::size_t N>
void add_scalars(Page& page, const std::array<Scalar, N>& scalars, std::string_view type, const Json& status) {
    for (const Scalar& scalar : scalars) {
        page.about(scalar.name, type, scalar.help);
        if (const auto value = value_at(status, scalar.pointer)) {
            page.sample(*value * scalar.unit);
        }
    }
}

const Json& list_at(const Json& status, const char* key) {
    static const Json none = Json::array();
    const Json& found = part_of(status, key);
    return found.is_array() ? found : none;
}

/// One number of each element of a list that has a name.
void add_each(Page& page, const Json& list, std::string_view label, const std::string& pointer, double unit = 1.0,
              const Labels& more = {}) {
    for (const Json& each : list) {
        const std::string name = text_at(each, "name");
        Labels labels{{label, name}};
        labels.insert(labels.end(), more.begin(), more.end());
        if (const auto value = value_at(each, pointer)) {
            page.sample(*value * unit, labels);
        }
    }
}

void add_threads(Page& page, const Json& threads) {
    page.about("crspf_thread_latency_seconds", "gauge", "A thread's reaction: so many of them were quicker.");
    add_each(page, threads, "thread", "/median_below_us", kMicro, {{"quantile", "0.5"}});
    add_each(page, threads, "thread", "/p999_below_us", kMicro, {{"quantile", "0.999"}});
    page.about("crspf_thread_latency_max_seconds", "gauge", "The slowest reaction.");
    add_each(page, threads, "thread", "/max_us", kMicro);
    page.about("crspf_thread_deadline_seconds", "gauge", "Beyond it a reaction is a miss.");
    add_each(page, threads, "thread", "/deadline_us", kMicro);
    page.about("crspf_thread_misses_total", "counter", "Deadlines missed.");
    add_each(page, threads, "thread", "/misses");
    page.about("crspf_thread_alive", "gauge", "1: its loop has turned within a second.");
    add_each(page, threads, "thread", "/alive");
}

void add_sources(Page& page, const Json& sources) {
    page.about("crspf_source_state", "gauge", "1 for the state that a source is in.");
    for (const Json& source : sources) {
        const std::string name = text_at(source, "name");
        const std::string state = text_at(source, "state");
        for (const char* each : {"starting", "ok", "blind", "stale", "failed"}) {
            page.sample(state == each ? 1.0 : 0.0, {{"source", name}, {"state", each}});
        }
    }
    page.about("crspf_source_samples_total", "counter", "Samples of a source.");
    add_each(page, sources, "source", "/samples");
    page.about("crspf_source_age_seconds", "gauge", "Since its last sample.");
    add_each(page, sources, "source", "/age_ms", kMilli);
    page.about("crspf_source_events_total", "counter", "What a source's driver counts.");
    for (const Json& source : sources) {
        const auto counts = source.is_object() ? source.find("counts") : source.end();
        if (counts == source.end() || !counts->is_object()) {
            continue;
        }
        const std::string name = text_at(source, "name");
        for (const auto& [what, count] : counts->items()) {
            if (count.is_number()) {
                page.sample(count.get<double>(), {{"source", name}, {"event", what}});
            }
        }
    }
}

/// Only where there is one: a robot without a bus has none that is down.
void add_bus(Page& page, const Json& status) {
    page.about("crspf_output_bus_open", "gauge", "1: poses get onto the bus.");
    if (!text_at(part_of(status, "output"), "interface").empty()) {
        page.sample(value_at(status, "/output/bus_open"));
    }
}

void add_view(Page& page, const MetricsInput& input) {
    const auto add = [&page](std::string_view name, std::string_view type, std::string_view help, std::uint64_t value) {
        page.about(name, type, help);
        page.sample(static_cast<double>(value));
    };
    add("crspf_view_peers", "gauge", "Viewers now.", input.web.peers);
    add("crspf_view_connections", "gauge", "TCP connections now.", input.web.connections);
    add("crspf_view_peers_total", "counter", "Viewers that ever came.", input.hub.peers);
    add("crspf_view_messages_total", "counter", "Messages of channels given to viewers.", input.hub.messages);
    add("crspf_view_calls_total", "counter", "Actions that viewers asked for.", input.hub.calls);
    add("crspf_view_mistakes_total", "counter", "What viewers sent that was not understood or granted.",
        input.hub.mistakes);
    add("crspf_view_cut_off_total", "counter", "Viewers cut off for too much of that.", input.hub.cut_off);
    add("crspf_view_requests_total", "counter", "Requests of HTTP.", input.web.requests);
    add("crspf_view_refused_total", "counter", "Refused for host, origin or token.", input.web.refused);
    add("crspf_view_full_total", "counter", "Refused since there were as many as there may be.", input.web.full);
}

}  // namespace

std::string metrics_text(const MetricsInput& input) {
    Page page;
    page.about("crspf_up", "gauge", "1: the service is there, or a recording is played.");
    page.sample(input.up ? 1.0 : 0.0);
    if (input.up) {  // an old status would pass for a new one
        add_scalars(page, kGauges, "gauge", input.status);
        add_scalars(page, kCounters, "counter", input.status);
        add_bus(page, input.status);
        add_threads(page, list_at(input.status, "threads"));
        add_sources(page, list_at(input.status, "sources"));
    }
    add_view(page, input);
    return page.take();
}

}  // namespace crspf::view
