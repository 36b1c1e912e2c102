// A robot that stands in a room for a day, its hours played as fast as the modules go: nothing may move, and nothing
// may grow. Status 1 where something did.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <memory>

#include "platform/crspfd/filter_module.hpp"
#include "platform/crspfd/map_module.hpp"
#include "platform/crspfd/odometry_module.hpp"
#include "tests/support/live_robot.hpp"
#include "tests/support/resident.hpp"
#include "tools/sim/random.hpp"

using namespace crspf;

namespace {

constexpr double kNoise_m = 0.01;  // of the URG-04LX
constexpr double kLimit_m = 0.02;
constexpr double kLimit_deg = 0.2;
constexpr int kWheelsPerScan = 5;
constexpr double kGrowth_mib = 0.5;

class Robot {
 public:
    Robot() {
        const ScipSensor sensor = test::urg_04lx();
        true_.angle_increment_rad = 2.0 * kPi / sensor.ares;
        true_.angle_min_rad = -true_.angle_increment_rad * (sensor.afrt - sensor.amin);
        true_.count = sensor.amax - sensor.amin + 1;
        for (std::uint32_t i = 0; i < true_.count; ++i) {
            true_.range_m[i] = static_cast<float>(
                test::range_m({}, true_.angle_min_rad + static_cast<double>(i) * true_.angle_increment_rad));
            true_.beam[i] = Beam::kHit;
        }
        params_.lidar.range_max_m = 5.6;
        params_.odometry.wheel_span_m = test::kSpan_m;
        odometry_ = std::make_unique<OdometryModule>(params_.odometry, *exchange_);
        filter_ = std::make_unique<FilterModule>(params_, *exchange_);
        map_ = std::make_unique<MapModule>(params_, *exchange_);
    }

    /// A scan, and the wheels' samples up to it.
    void live(Duration period) {
        for (int i = 0; i < kWheelsPerScan; ++i) {
            now_ = now_ + Duration{period.ns / kWheelsPerScan};
            static_cast<void>(exchange_->motions.push({.sample = DifferentialSample{.stamp = now_}, .received = now_}));
            odometry_->turn(now_);
        }
        ReceivedScan& slot = exchange_->scan.slot();
        slot.received = now_;
        slot.scan = true_;
        slot.scan.stamp = now_;
        for (std::uint32_t i = 0; i < true_.count; ++i) {
            slot.scan.range_m[i] += static_cast<float>(kNoise_m * noise_.normal());
        }
        exchange_->scan.publish();
        filter_->turn([this] { return now_; });
        while (map_->turn()) {
        }
        odometry_->turn(now_);
        exchange_->odometry.for_control.update();
        exchange_->filter.for_control.update();
    }

    [[nodiscard]] Pose2 pose() const {
        const OdometryState& odometry = exchange_->odometry.for_control.value();
        return odometry.P_map_odom * odometry.P_odom_base;
    }
    [[nodiscard]] const LocalizerCounters& counters() const { return exchange_->filter.for_control.value().counters; }

 private:
    SlamParams params_;
    Scan true_;
    Stamp now_;
    sim::Random noise_{1, sim::RandomStream::kTest};
    std::unique_ptr<Exchange> exchange_ = std::make_unique<Exchange>();
    std::unique_ptr<OdometryModule> odometry_;
    std::unique_ptr<FilterModule> filter_;
    std::unique_ptr<MapModule> map_;
};

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("A robot that stands for hours, played as fast as it goes.", "soak_standing");
    double hours = 24.0;
    app.add_option("--hours", hours, "how long it stands")->check(CLI::PositiveNumber);
    CLI11_PARSE(app, argc, argv);

    constexpr Duration kPeriod{100'000'000};
    const auto scans_per_hour = static_cast<std::uint64_t>(3600.0 / kPeriod.seconds());
    const auto scans = static_cast<std::uint64_t>(hours * static_cast<double>(scans_per_hour));
    Robot robot;
    double worst_m = 0.0;
    double worst_deg = 0.0;
    double settled_mib = 0.0;
    for (std::uint64_t scan = 1; scan <= scans; ++scan) {
        robot.live(kPeriod);
        const Pose2 P = robot.pose();
        worst_m = std::max(worst_m, std::hypot(P.x_m, P.y_m));
        worst_deg = std::max(worst_deg, std::abs(degrees(P.theta_rad)));
        if (scan % scans_per_hour == 0 || scan == scans) {
            settled_mib = settled_mib == 0.0 ? test::resident_mib() : settled_mib;
            std::printf("%5.1f h  at %+.1f %+.1f mm %+.3f deg, worst %.1f mm %.3f deg, lost %llu, resident %.1f MiB\n",
                        static_cast<double>(scan) / static_cast<double>(scans_per_hour), 1000.0 * P.x_m, 1000.0 * P.y_m,
                        degrees(P.theta_rad), 1000.0 * worst_m, worst_deg,
                        static_cast<unsigned long long>(robot.counters().lost), test::resident_mib());
            std::fflush(stdout);
        }
    }
    const bool well = worst_m <= kLimit_m && worst_deg <= kLimit_deg && robot.counters().lost == 0 &&
                      test::resident_mib() - settled_mib < kGrowth_mib;
    std::puts(well ? "soak: all is well" : "soak: FAILED");
    return well ? 0 : 1;
} catch (const std::exception& e) {
    std::fprintf(stderr, "soak: %s\n", e.what());
    return 1;
}
