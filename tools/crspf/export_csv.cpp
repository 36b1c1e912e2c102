#include "tools/crspf/export_csv.hpp"

#include <array>
#include <string>
#include <utility>

#include "core/base/trig.hpp"
#include "tools/crspf/export_text.hpp"

namespace crspf {
namespace {

using Column = std::pair<const char*, double>;

auto columns_of(const Pipeline& slam, const ScanResult& r) {
    const Covariance3& c = r.shape.covariance;
    const auto flag = [](bool set) { return set ? 1.0 : 0.0; };
    return std::to_array<Column>({{"x_m", r.P_map_base.x_m},
                                  {"y_m", r.P_map_base.y_m},
                                  {"heading_deg", degrees(r.P_map_base.theta_rad)},
                                  {"odometry_x_m", r.P_map_observed.x_m},
                                  {"odometry_y_m", r.P_map_observed.y_m},
                                  {"odometry_heading_deg", degrees(r.P_map_observed.theta_rad)},
                                  {"M", r.M},
                                  {"m", r.m},
                                  {"matched", flag(r.matched)},
                                  {"result", flag(r.result)},
                                  {"draw", flag(r.draw)},
                                  {"to_draw", flag(r.to_draw)},
                                  {"lost", flag(r.lost)},
                                  {"rays", r.rays},
                                  {"critical_rays", r.critical_rays},
                                  {"evaluations", r.evaluations},
                                  {"range_m", r.range_m},
                                  {"range_deg", degrees(r.range_rad)},
                                  {"covariance_xx_m2", c.xx},
                                  {"covariance_xy_m2", c.xy},
                                  {"covariance_yy_m2", c.yy},
                                  {"covariance_xt_m_rad", c.xt},
                                  {"covariance_yt_m_rad", c.yt},
                                  {"covariance_tt_rad2", c.tt},
                                  {"degenerate", flag(r.shape.degenerate)},
                                  {"weakest_x", r.shape.weakest_x},
                                  {"weakest_y", r.shape.weakest_y},
                                  {"weakest_ratio", r.shape.weakest_ratio},
                                  {"map_tiles", static_cast<double>(slam.map().tiles())},
                                  {"map_drawn", static_cast<double>(slam.map_counters().drawn)}});
}

}  // namespace

CsvExport::CsvExport(const std::filesystem::path& file) : file_(file) {}

void CsvExport::add(const RunPlayer& player, const ScanResult& result) {
    const auto columns = columns_of(player.pipeline(), result);
    std::string text;
    if (player.pipeline().counters().scans == 1) {
        text = "stamp_s";
        for (const auto& [name, value] : columns) {
            text.append(",").append(name);
        }
        text += ",core_ms\n";
    }
    append_fixed(text, player.recorded_stamp_s(), 6);
    for (const auto& [name, value] : columns) {
        text += ',';
        append_digits(text, value);
    }
    text += ',';
    append_fixed(text, 1e3 * player.core_s(), 3);
    text += '\n';
    file_.write(text);
}

}  // namespace crspf
