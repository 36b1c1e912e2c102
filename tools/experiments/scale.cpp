// How processor time and memory grow with the beams of a scan, the particles, the mapped land and the way driven.
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>

#include "tools/crspf/map_copies.hpp"
#include "tools/experiments/experiment.hpp"
#include "tools/experiments/runs.hpp"
#include "tools/sim/lidar_model.hpp"
#include "tools/sim/scene.hpp"

namespace crspf::experiments {
namespace {

constexpr double kMiB = 1024.0 * 1024.0;

/// What of the core's state is in memory: pages that were never touched are not.
double resident_mib(const Pipeline& pipeline) {
    const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): pages are counted by address
    const auto begin = reinterpret_cast<std::uintptr_t>(&pipeline) / page * page;
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): as above
    const auto end = reinterpret_cast<std::uintptr_t>(&pipeline) + sizeof(Pipeline);
    std::vector<unsigned char> in_memory((end - begin + page - 1) / page);
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast,performance-no-int-to-ptr): as above
    if (::mincore(reinterpret_cast<void*>(begin), end - begin, in_memory.data()) != 0) {
        return 0.0;
    }
    const auto resident =
        std::count_if(in_memory.begin(), in_memory.end(), [](unsigned char c) { return (c & 1U) != 0; });
    return static_cast<double>(resident) * static_cast<double>(page) / kMiB;
}

/// p of the law y = c x^p, by least squares of the logarithms.
double growth_power(const std::vector<double>& x, const std::vector<double>& y) {
    const auto n = static_cast<double>(x.size());
    double mean_x = 0.0;
    double mean_y = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        mean_x += std::log(x[i]) / n;
        mean_y += std::log(y[i]) / n;
    }
    double xy = 0.0;
    double xx = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        xy += (std::log(x[i]) - mean_x) * (std::log(y[i]) - mean_y);
        xx += (std::log(x[i]) - mean_x) * (std::log(x[i]) - mean_x);
    }
    return xy / xx;
}

/// A measured dependence.
struct Growth {
    const char* of = "";
    const char* unit = "";
    std::vector<double> x;
    std::vector<double> scan_ms;
    std::vector<double> resident_mib;

    [[nodiscard]] double power() const { return growth_power(x, scan_ms); }
    void add(double at, double ms, double mib) {
        x.push_back(at);
        scan_ms.push_back(ms);
        resident_mib.push_back(mib);
    }
};

sim::SampleDrive in_office(const sim::LidarModel& lidar) {
    sim::SimulationParams params = urg_robot(1);
    params.lidar = lidar;
    params.duration_s = 60.0;
    return sim::record_drive(sim::make_scene("office"), params);
}

Growth by_beams() {
    Growth growth{.of = "beams", .unit = "beams a scan", .x = {}, .scan_ms = {}, .resident_mib = {}};
    for (const std::uint32_t beams : {180U, 360U, 720U, 1080U, 1440U, 2000U}) {
        const sim::SampleDrive drive = in_office(sim::all_round_lidar(beams));
        const Played played = play(drive, params_for(drive, 1));
        growth.add(beams, median_of(played.scan_ms), resident_mib(*played.pipeline));
    }
    return growth;
}

Growth by_particles() {
    Growth growth{.of = "particles", .unit = "particles", .x = {}, .scan_ms = {}, .resident_mib = {}};
    const sim::SampleDrive drive = in_office(sim::all_round_lidar(720));
    for (const std::uint32_t particles : {30U, 100U, 300U, 1000U, 3000U}) {
        SlamParams params = params_for(drive, 1);
        params.particle_filter.feedback = false;  // always the largest number
        params.particle_filter.particles_min = particles;
        params.particle_filter.particles_max = particles;
        params.particle_filter.evaluations_max = 5 * particles + 200;
        const Played played = play(drive, params);
        growth.add(particles, median_of(played.scan_ms), resident_mib(*played.pipeline));
    }
    return growth;
}

/// Drives through an office in a map that holds so many copies of it beside the drive.
Growth by_land() {
    Growth growth{.of = "land", .unit = "offices in the map", .x = {}, .scan_ms = {}, .resident_mib = {}};
    const sim::SampleDrive drive = in_office(sim::all_round_lidar(720));
    const Played office = play(drive, params_for(drive, 1));
    for (const std::int32_t offices : {1, 2, 4, 8, 16}) {
        const auto pipeline = std::make_unique<Pipeline>(params_for(drive, 1));
        load_copies(office.pipeline->map(), offices - 1, *pipeline);
        growth.add(offices, median_of(play_to(*pipeline, drive).scan_ms), resident_mib(*pipeline));
    }
    return growth;
}

/// A long way, and what was off on it.
struct LongWay {
    Growth growth{.of = "way", .unit = "km driven", .x = {}, .scan_ms = {}, .resident_mib = {}};
    std::vector<double> off_m;  ///< largest in each kilometre
};

/// Laps of the campus by a planar lidar, 2 km each.
LongWay by_way(double length_m, const std::function<void(double)>& progress) {
    sim::SimulationParams params;
    params.lidar = sim::lidar_model("lms5xx");
    params.lidar.scan_rate_hz = 10.0;
    params.robot = sim::car();
    params.robot.odom_scale_error = 0.01;
    params.odometry_rate_hz = 20.0;
    params.distance_m = length_m;
    SlamParams slam;
    slam.lidar = sim::told_lidar(params);
    slam.map.resolution_m = params.robot.map_resolution_m;
    slam.odometry.wheel_span_m = params.robot.wheel_span_m;
    const auto pipeline = std::make_unique<Pipeline>(slam);

    LongWay way;
    std::vector<Pose2> poses;
    std::vector<double> scan_ms;
    std::vector<std::pair<std::size_t, double>> kilometres;  // scans until its end, memory then
    double driven_m = 0.0;
    Pose2 before;
    const sim::SampleDrive facts =
        sim::stream_drive(sim::make_scene("campus"), params, [&](const sim::SampleDrive::Step& step) {
            const double start_s = thread_time_s();
            for (const MotionSample& motion : step.motions) {
                pipeline->on_motion(motion);
            }
            const ScanResult result = pipeline->on_scan(step.scan);
            scan_ms.push_back(1e3 * (thread_time_s() - start_s));
            poses.push_back(result.P_map_base);
            driven_m += std::hypot(result.P_map_base.x_m - before.x_m, result.P_map_base.y_m - before.y_m);
            before = result.P_map_base;
            if (driven_m >= 1e3 * static_cast<double>(kilometres.size() + 1)) {
                kilometres.emplace_back(poses.size(), resident_mib(*pipeline));
                progress(driven_m / length_m);
            }
        });
    std::size_t from = 0;
    for (const auto& [until, mib] : kilometres) {
        const std::vector<double> ms(scan_ms.begin() + static_cast<std::ptrdiff_t>(from),
                                     scan_ms.begin() + static_cast<std::ptrdiff_t>(until));
        way.growth.add(static_cast<double>(way.growth.x.size() + 1), median_of(ms), mib);
        double off_m = 0.0;
        for (std::size_t i = from; i < until; ++i) {
            off_m = std::max(off_m, std::hypot(poses[i].x_m - facts.truth[i].x_m, poses[i].y_m - facts.truth[i].y_m));
        }
        way.off_m.push_back(off_m);
        from = until;
    }
    return way;
}

nlohmann::ordered_json to_json(const Growth& growth) {
    return {{"unit", growth.unit},
            {"x", growth.x},
            {"scan_ms_median", growth.scan_ms},
            {"core_resident_mib", growth.resident_mib},
            {"power", growth.power()}};
}

}  // namespace

Findings scale(const Context& context) {
    constexpr double kWay_m = 50e3;
    std::array<Growth, 3> growths;
    LongWay way;
    in_parallel(
        2, [](double) {},
        [&](std::size_t task) {
            if (task == 0) {
                way = by_way(kWay_m, context.progress);
            } else {
                growths = {by_beams(), by_particles(), by_land()};
            }
        });
    Findings findings;
    findings.blocks.emplace_back(Paragraph{
        "Processor time of the core for a scan, the median of a drive, and the pages of the core's state that are in "
        "memory. "
        "The power p is that of the law time = c x^p fitted to the points: 1 is proportional, 0 is no growth. Beams, "
        "particles and land: a lidar that looks all round to 10 m in the office; way: 50 km of campus, 25 laps, by a "
        "SICK "
        "LMS5xx at 10 Hz in cells of 5 cm."});
    Table table{
        .caption = "Growth.",
        .head = {"with", "from", "to", "time a scan [ms], from", "to", "power p", "core in memory [MiB], from", "to"},
        .rows = {}};
    std::vector<const Growth*> all{growths.data(), &growths[1], &growths[2], &way.growth};
    for (const Growth* growth : all) {
        table.rows.push_back({growth->unit, text_of(growth->x.front(), 0), text_of(growth->x.back(), 0),
                              text_of(growth->scan_ms.front(), 3), text_of(growth->scan_ms.back(), 3),
                              text_of(growth->power(), 2), text_of(growth->resident_mib.front(), 1),
                              text_of(growth->resident_mib.back(), 1)});
        findings.figures[growth->of] = to_json(*growth);
    }
    findings.figures["way"]["largest_error_m"] = way.off_m;
    findings.blocks.emplace_back(std::move(table));
    for (const Growth* growth : all) {
        const bool by_way = growth == &way.growth;
        findings.blocks.emplace_back(Chart{.caption = std::string("Time a scan against ") + growth->unit + ".",
                                           .x_label = growth->unit,
                                           .y_label = "time a scan [ms]",
                                           .series = {{.name = "median", .x = growth->x, .y = growth->scan_ms}},
                                           .log_x = !by_way,
                                           .log_y = !by_way});
    }
    findings.blocks.emplace_back(
        Chart{.caption = "50 km of campus: the core's pages in memory, and the largest error of each "
                         "kilometre.",
              .x_label = "driven [km]",
              .y_label = "memory [MiB], error [cm]",
              .series = {{.name = "memory [MiB]", .x = way.growth.x, .y = way.growth.resident_mib},
                         {.name = "error [cm]", .x = way.growth.x, .y = [&] {
                              std::vector<double> cm = way.off_m;
                              std::for_each(cm.begin(), cm.end(), [](double& v) { v *= 100.0; });
                              return cm;
                          }()}}});
    const double later_mib = way.growth.resident_mib.back() - way.growth.resident_mib[2];
    const double worst_m = *std::max_element(way.off_m.begin(), way.off_m.end());
    findings.claims.push_back(
        {.paper = "Efficient in small and large environments, in real time (abstract).",
         .measured = "The time of a scan does not grow with the land (power " + text_of(growths[2].power(), 2) +
                     ") nor with the way (power " + text_of(way.growth.power(), 2) +
                     " over 50 km), and grows with the power " + text_of(growths[0].power(), 2) + " of the beams and " +
                     text_of(growths[1].power(), 2) +
                     " of the particles. From the third kilometre to the fiftieth the core takes " +
                     text_of(later_mib, 1) + " MiB more; the largest error is " + text_of(worst_m, 2) + " m.",
         .verdict = std::abs(growths[2].power()) < 0.1 && std::abs(way.growth.power()) < 0.1 && later_mib < 1.0
                        ? Verdict::kHolds
                        : Verdict::kPartly,
         .reason = "Memory and time are as claimed only where this says so."});
    findings.claims.back().reason = findings.claims.back().verdict == Verdict::kHolds
                                        ? ""
                                        : "Time or memory grows with land or way: see the charts.";
    findings.headlines.push_back(
        {.run =
             "a scan's time by power of: beams; particles; mapped land; way to 50 km (1: proportional, 0: no growth)",
         .result = text_of(growths[0].power(), 2) + "; " + text_of(growths[1].power(), 2) + "; " +
                   text_of(growths[2].power(), 2) + "; " + text_of(way.growth.power(), 2)});
    return findings;
}

}  // namespace crspf::experiments
