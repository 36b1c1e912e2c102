#include "tools/crspf/top_screen.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tools/view/troubles.hpp"

namespace crspf::cli {
namespace {

using Json = nlohmann::ordered_json;

/// Of the match value: (10) cannot give more.
constexpr double kMatchMax = 2975.0;
constexpr std::size_t kBar = 40;

double number(const Json& value) {
    return value.is_number() ? value.get<double>() : 0.0;
}

const char* text(const Json& value) {
    return value.is_string() ? value.get_ref<const std::string&>().c_str() : "";
}

/// Shows two statuses' difference as events a second.
class Rates {
 public:
    Rates(const Json& status, const Json& before) : status_(status), before_(before) {
        if (!before.is_null()) {
            seconds_ = number(status.at("uptime_s")) - number(before.at("uptime_s"));
        }
    }
    [[nodiscard]] double of(const char* pointer) const {
        if (!(seconds_ > 0.0)) {  // none before, or the service was restarted between the two
            return 0.0;
        }
        const Json::json_pointer at(pointer);
        return before_.contains(at) ? (number(status_.at(at)) - number(before_.at(at))) / seconds_ : 0.0;
    }

 private:
    const Json& status_;
    const Json& before_;
    double seconds_ = 0.0;
};

/// M on its scale, with the thresholds of (12) as marks: `####..|...|....`
std::string match_bar(double M, const Json& analyser) {
    std::string bar(kBar, '.');
    const auto at = [](double value) {
        return static_cast<std::size_t>(std::clamp(value / kMatchMax, 0.0, 1.0) * (kBar - 1));
    };
    std::fill_n(bar.begin(), at(M) + (M > 0.0 ? 1 : 0), '#');
    for (const char* threshold : {"result_off", "result_on"}) {
        bar[at(number(analyser.at(threshold)))] = '|';
    }
    return bar;
}

/// What troubles_of() finds, in a line.
std::string troubles_line(const Json& status) {
    const Json found = view::troubles_of(status);
    std::string out;
    for (const auto& [name, value] : found.items()) {
        out += (out.empty() ? "" : ", ") + name + " " + (value.is_string() ? value.get<std::string>() : value.dump());
    }
    return out.empty() ? "none" : out;
}

}  // namespace

std::vector<std::string> top_screen(const Json& status, const Json& before, std::size_t columns) {
    const Rates rates(status, before);
    const Json& pose = status.at("pose");
    const auto flag = [&pose](const char* name) { return pose.at(name).get<bool>() ? name : ""; };
    std::vector<std::string> out;
    out.push_back(fmt::format("crspfd  up {:.0f} s  cpu {:.1f} %  memory {:.0f} MiB{}{}", number(status.at("uptime_s")),
                              100.0 * rates.of("/process/cpu_s"),
                              number(status.at("process").at("rss_max_kib")) / 1024.0,
                              status.at("realtime").at("sched_fifo").get<bool>() ? "" : "  NOT REAL TIME",
                              status.at("realtime").at("memory_locked").get<bool>() ? "" : "  MEMORY NOT LOCKED"));
    out.emplace_back();
    out.push_back(fmt::format(
        "pose    x {:.3f} m  y {:.3f} m  heading {:.2f} deg  {:.3f} m/s  {:.1f} deg/s  age {:.0f} ms  {} {}",
        number(pose.at("x_m")), number(pose.at("y_m")), number(pose.at("heading_deg")), number(pose.at("speed_mps")),
        number(pose.at("yaw_rate_degps")), number(pose.at("age_ms")), pose.at("lost").get<bool>() ? "LOST" : "",
        flag("degenerate")));
    const Json& analyser = status.at("analyser");
    out.push_back(fmt::format("M       {} {:.0f}  result on {:.0f} off {:.0f}, draw on {:.0f} off {:.0f}  {}",
                              match_bar(number(pose.at("M")), analyser), number(pose.at("M")),
                              number(analyser.at("result_on")), number(analyser.at("result_off")),
                              number(analyser.at("draw_on")), number(analyser.at("draw_off")), flag("result")));
    out.push_back(fmt::format("rates   {:.1f} scans/s  {:.1f} drawn/s  {:.1f} odometry/s  {:.1f} poses/s",
                              rates.of("/filter/scans"), rates.of("/map/drawn"), rates.of("/odometry/samples"),
                              rates.of("/output/poses")));
    out.push_back(
        fmt::format("scan    {:.0f} rays, {:.0f} of them critical, {:.0f} evaluations; map {:.0f} of {:.0f} tiles",
                    number(status.at("filter").at("rays")), number(status.at("filter").at("critical_rays")),
                    number(status.at("filter").at("evaluations")), number(status.at("map").at("tiles")),
                    number(status.at("map").at("tiles_max"))));
    out.emplace_back();
    out.push_back(fmt::format("{:<16} {:>4} {:<5} {:>12} {:>12} {:>12} {:>12} {:>8}", "THREAD", "PRIO", "",
                              "median us <", "99.9 % us <", "max us", "deadline us", "misses"));
    for (const Json& thread : status.at("threads")) {
        out.push_back(fmt::format("{:<16} {:4.0f} {:<5} {:12.0f} {:12.0f} {:12.0f} {:12.0f} {:8.0f}",
                                  text(thread.at("name")), number(thread.at("priority")),
                                  thread.at("alive").get<bool>() ? "" : "STUCK", number(thread.at("median_below_us")),
                                  number(thread.at("p999_below_us")), number(thread.at("max_us")),
                                  number(thread.at("deadline_us")), number(thread.at("misses"))));
    }
    out.emplace_back();
    out.push_back(fmt::format("{:<16} {:<8} {:>10} {:>10}  {}", "SENSOR", "STATE", "samples/s", "age ms", "SAYS"));
    for (std::size_t i = 0; i < status.at("sources").size(); ++i) {
        const Json& source = status.at("sources")[i];
        const std::string samples = "/sources/" + std::to_string(i) + "/samples";
        out.push_back(fmt::format("{:<16} {:<8} {:10.1f} {:10.0f}  {}", text(source.at("name")),
                                  text(source.at("state")), rates.of(samples.c_str()), number(source.at("age_ms")),
                                  text(source.at("says"))));
    }
    out.emplace_back();
    out.push_back("troubles  " + troubles_line(status));
    if (const Json& search = status.at("relocalization"); number(search.at("searches")) > 0.0) {
        out.push_back(fmt::format("looked for the robot {:.0f} times; the last: ", number(search.at("searches"))) +
                      text(search.at("last")));
    }
    for (std::string& each : out) {
        each = each.substr(0, columns);
    }
    return out;
}

}  // namespace crspf::cli
