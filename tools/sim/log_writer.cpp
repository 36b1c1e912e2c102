#include "tools/sim/log_writer.hpp"

#include <array>
#include <charconv>
#include <utility>

namespace crspf::sim {
namespace {

void append(std::string& out, std::int64_t value) {
    std::array<char, 24> text{};
    out.append(text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr);
}

void append_fixed(std::string& out, double value, int decimals) {
    std::array<char, 400> text{};  // the largest double has 309 digits before the point
    out.append(text.data(),
               std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, decimals).ptr);
}

/// `value` thousandths or millionths, all digits: "12.345".
void append_scaled(std::string& out, std::int64_t value, int decimals) {
    std::int64_t unit = 1;
    for (int i = 0; i < decimals; ++i) {
        unit *= 10;
    }
    append(out, value / unit);
    out += '.';
    const std::string fraction = std::to_string(value % unit);
    out.append(static_cast<std::size_t>(decimals) - fraction.size(), '0');
    out += fraction;
}

class CarmenWriter final : public LogWriter {
 public:
    CarmenWriter(LidarModel lidar, const Pose2& P_base_lidar) : lidar_(std::move(lidar)), P_base_lidar_(P_base_lidar) {}

    void odometry(const OdometryRecord& record, std::string& out) override {
        begin(out);
        out += "ODOM";
        append_numbers(out, {record.P_odom_base.x_m, record.P_odom_base.y_m, record.P_odom_base.theta_rad,
                             record.speed_mps, record.turn_rate_radps, 0.0});
        append_stamp(out, record.stamp_us);
        newest_ = record;
    }

    void scan(const ScanRecord& record, std::string& out) override {
        begin(out);
        out += "ROBOTLASER1 0";
        append_numbers(out, {lidar_.angle_min_rad, lidar_.increment_rad * (lidar_.beams - 1), lidar_.increment_rad,
                             lidar_.range_max_m, lidar_.noise_m});
        out += " 0 ";
        append(out, static_cast<std::int64_t>(record.range_mm.size()));
        for (const int range_mm : record.range_mm) {
            out += ' ';
            append_scaled(out, range_mm, 3);
        }
        out += " 0";
        const Pose2 P_odom_lidar = newest_.P_odom_base * P_base_lidar_;
        append_numbers(out, {P_odom_lidar.x_m, P_odom_lidar.y_m, P_odom_lidar.theta_rad, newest_.P_odom_base.x_m,
                             newest_.P_odom_base.y_m, newest_.P_odom_base.theta_rad, newest_.speed_mps,
                             newest_.turn_rate_radps, 0.0, 0.0, 0.0});
        append_stamp(out, record.stamp_us);
    }

 private:
    void begin(std::string& out) {
        if (begun_) {
            return;
        }
        begun_ = true;
        out += "# CARMEN log file, simulated by crspf sim; m, rad, s\n";
        out += "PARAM robot_frontlaser_offset ";
        append_fixed(out, P_base_lidar_.x_m, 4);
        append_stamp(out, 0);
        out += "PARAM laser_front_laser_max ";
        append_fixed(out, lidar_.range_max_m, 3);
        append_stamp(out, 0);
    }

    static void append_numbers(std::string& out, std::initializer_list<double> values) {
        for (const double value : values) {
            out += ' ';
            append_fixed(out, value, 8);
        }
    }

    static void append_stamp(std::string& out, std::int64_t stamp_us) {
        out += ' ';
        append_scaled(out, stamp_us, 6);
        out += " sim ";
        append_scaled(out, stamp_us, 6);
        out += '\n';
    }

    LidarModel lidar_;
    Pose2 P_base_lidar_;
    OdometryRecord newest_;
    bool begun_ = false;
};

class UrgDatWriter final : public LogWriter {
 public:
    void odometry(const OdometryRecord& /*record*/, std::string& /*text*/) override {}

    void scan(const ScanRecord& record, std::string& out) override {
        constexpr int kUnused = 20;
        append(out, record.stamp_us);
        out += " 0 ";
        append(out, record.counts.left);
        out += ' ';
        append(out, record.counts.right);
        for (int i = 0; i < kUnused; ++i) {
            out += " 0";
        }
        for (const int range_mm : record.range_mm) {
            out += ' ';
            append(out, range_mm);
        }
        out += '\n';
    }
};

}  // namespace

std::unique_ptr<LogWriter> carmen_writer(const LidarModel& lidar, const Pose2& P_base_lidar) {
    return std::make_unique<CarmenWriter>(lidar, P_base_lidar);
}

std::unique_ptr<LogWriter> urg_dat_writer() {
    return std::make_unique<UrgDatWriter>();
}

}  // namespace crspf::sim
