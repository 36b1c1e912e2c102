#include "platform/capture/log_reader.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "platform/capture/carmen_line.hpp"
#include "platform/capture/line_source.hpp"
#include "platform/capture/timeline.hpp"
#include "platform/capture/urg_dat_line.hpp"
#include "platform/files/input_error.hpp"

namespace crspf {
namespace {

// Between two samples of odometry no robot drives so far: a counter wrapped, or the odometry was set anew.
constexpr double kMotionMax_m = 10.0;

/// What both formats have in common: lines in, at most an odometry event and then a scan out of each, and the counts.
class LineLogReader : public LogReader {
 public:
    explicit LineLogReader(LineSource source) : source_(std::move(source)) {}

    bool next(LogEvent& event) final {
        if (std::exchange(scan_pending_, false)) {
            deliver_scan(event);
            return true;
        }
        LineSource::Line line;
        while (source_.next(line)) {
            counts_.lines = source_.line_number();
            if (line.too_long) {
                count_damage("longer than " + std::to_string(LineSource::kLineMax) + " bytes");
            } else if (read_line(line.text, event)) {
                return true;
            }
        }
        return false;
    }

    [[nodiscard]] const LogCounts& counts() const final { return counts_; }
    [[nodiscard]] double progress() const final { return source_.progress(); }

 protected:
    /// Fills `event` and returns true where the line gives one. A scan behind an odometry event stays in scan_, with
    /// scan_pending_ set.
    virtual bool read_line(std::string_view text, LogEvent& event) = 0;

    void place(Timeline::Source source, double recorded_s) {
        recorded_s_ = recorded_s;
        stamp_ = timeline_.place(source, recorded_s);
        counts_.stamp_jumps = timeline_.jumps();
    }

    /// Where the line that was read last stands on the repaired time line.
    [[nodiscard]] Stamp stamp() const { return stamp_; }

    void count_ignored() { ++counts_.ignored_lines; }

    void count_damage(const std::string& reason) {
        if (counts_.damaged_lines++ == 0) {
            counts_.first_damage = source_.name() + ":" + std::to_string(source_.line_number()) + ": " + reason;
        }
    }

    void deliver_motion(const Pose2& P_previous_base, LogEvent& event) {
        event.kind = LogEvent::Kind::kMotion;
        event.recorded_stamp_s = recorded_s_;
        event.motion = {.stamp = stamp_, .P_previous_base = P_previous_base};
        ++counts_.odometry;
    }

    void deliver_wheels(double left_m, double right_m, LogEvent& event) {
        event.kind = LogEvent::Kind::kDifferential;
        event.recorded_stamp_s = recorded_s_;
        event.differential = {.stamp = stamp_, .left_m = left_m, .right_m = right_m};
        ++counts_.odometry;
    }

    void deliver_scan(LogEvent& event) {
        event.kind = LogEvent::Kind::kScan;
        event.recorded_stamp_s = recorded_s_;
        event.scan = scan_;
        event.scan.stamp = stamp_ + (scan_.stamp - Stamp{});
        const std::span beams = std::span(scan_.beam).first(scan_.count);
        counts_.invalid_beams += static_cast<std::uint64_t>(std::count(beams.begin(), beams.end(), Beam::kInvalid));
        counts_.no_return_beams += static_cast<std::uint64_t>(std::count(beams.begin(), beams.end(), Beam::kNoReturn));
        ++counts_.scans;
    }

    Scan scan_;
    bool scan_pending_ = false;

 private:
    LineSource source_;
    Timeline timeline_;
    LogCounts counts_;
    double recorded_s_ = 0.0;  ///< of the line that was read last
    Stamp stamp_;              ///< the same on the repaired time line
};

class CarmenReader final : public LineLogReader {
 public:
    CarmenReader(LineSource source, const LidarParams& lidar) : LineLogReader(std::move(source)), lidar_(lidar) {}

    [[nodiscard]] const char* format() const override { return "carmen"; }

 private:
    bool read_line(std::string_view text, LogEvent& event) override {
        const CarmenLine line = parse_carmen_line(text, lidar_, scan_);
        switch (line.kind) {
            case CarmenLine::Kind::kIgnored: count_ignored(); return false;
            case CarmenLine::Kind::kDamaged: count_damage(line.damage); return false;
            case CarmenLine::Kind::kRangeLimit:
                lidar_.range_max_m = std::min(lidar_.range_max_m, line.range_limit_m);
                return false;
            case CarmenLine::Kind::kOdometry: place(Timeline::Source::kOdometry, line.stamp_s); break;
            case CarmenLine::Kind::kFrontLaser:
            case CarmenLine::Kind::kRobotLaser: place(Timeline::Source::kScan, line.stamp_s); break;
        }
        const bool has_scan = line.kind != CarmenLine::Kind::kOdometry;
        if (const std::optional<Pose2> motion = motion_to(line.P_odom_base)) {
            deliver_motion(*motion, event);
            scan_pending_ = has_scan;
            return true;
        }
        if (has_scan) {
            deliver_scan(event);
        }
        return has_scan;
    }

    /// The motion since the odometry before; none for the first one and for one that cannot be believed. None either
    /// for a line that is older than newer odometry before it: that has told of this motion already.
    std::optional<Pose2> motion_to(const std::optional<Pose2>& P_odom_base) {
        if (!P_odom_base) {
            count_damage("the odometry is not finite");
            return std::nullopt;
        }
        if (P_odom_base_ && stamp() < odometry_stamp_) {
            return std::nullopt;
        }
        odometry_stamp_ = stamp();
        const std::optional<Pose2> P_odom_previous = std::exchange(P_odom_base_, P_odom_base);
        if (!P_odom_previous) {
            return std::nullopt;
        }
        const Pose2 motion = inverse(*P_odom_previous) * *P_odom_base;
        const double distance_m = std::hypot(motion.x_m, motion.y_m);
        if (!(distance_m <= kMotionMax_m)) {
            count_damage("the odometry jumps by " + std::to_string(distance_m) + " m");
            return std::nullopt;
        }
        return motion;
    }

    LidarParams lidar_;  ///< its range_max_m falls as the log says
    std::optional<Pose2> P_odom_base_;
    Stamp odometry_stamp_;  ///< of P_odom_base_, on the repaired time line
};

class UrgDatReader final : public LineLogReader {
 public:
    UrgDatReader(LineSource source, const LidarParams& lidar, const WheelEncoderParams& wheels)
        : LineLogReader(std::move(source)),
          lidar_(lidar),
          metres_per_count_(2.0 * kPi * wheels.wheel_radius_m / wheels.counts_per_turn) {}

    [[nodiscard]] const char* format() const override { return "urg-dat"; }

 private:
    struct Counts {
        double left;
        double right;
    };

    bool read_line(std::string_view text, LogEvent& event) override {
        const UrgDatLine line = parse_urg_dat_line(text, lidar_, scan_);
        if (line.fields == 0) {
            count_ignored();
            return false;
        }
        if (!line.damage.empty()) {
            count_damage(line.damage);
            return false;
        }
        if (!fields_agree(line.fields)) {
            count_damage(std::to_string(line.fields) + " fields, unlike the lines before: cut off");
            return false;
        }
        place(Timeline::Source::kOdometry, line.stamp_s);
        const std::optional<Counts> before = std::exchange(counts_before_, Counts{line.left_counts, line.right_counts});
        if (before) {
            const double left_m = (line.left_counts - before->left) * metres_per_count_;
            const double right_m = (line.right_counts - before->right) * metres_per_count_;
            if (std::abs(left_m) <= kMotionMax_m && std::abs(right_m) <= kMotionMax_m) {
                deliver_wheels(left_m, right_m, event);
                scan_pending_ = true;
                return true;
            }
            count_damage("the encoders jump by " + std::to_string(left_m) + " m and " + std::to_string(right_m) + " m");
        }
        deliver_scan(event);
        return true;
    }

    /// The format does not say how many ranges a line holds. A line that has another number of fields than the last
    /// good one is taken as cut off, unless the line before it had the same: then the log has changed.
    bool fields_agree(std::size_t fields) {
        const std::size_t before = std::exchange(fields_before_, fields);
        if (fields_good_ == 0 || fields == before) {
            fields_good_ = fields;
        }
        return fields == fields_good_;
    }

    LidarParams lidar_;
    double metres_per_count_;
    std::optional<Counts> counts_before_;
    std::size_t fields_good_ = 0;
    std::size_t fields_before_ = 0;
};

}  // namespace

Stamp stamp_of(const LogEvent& event) {
    switch (event.kind) {
        case LogEvent::Kind::kDifferential: return event.differential.stamp;
        case LogEvent::Kind::kAckermann: return event.ackermann.stamp;
        case LogEvent::Kind::kImu: return event.imu.stamp;
        case LogEvent::Kind::kScan: return event.scan.stamp;
        case LogEvent::Kind::kCloud: return event.cloud->stamp[0];
        case LogEvent::Kind::kPlace: return event.place.stamp;
        case LogEvent::Kind::kMotion: break;
    }
    return event.motion.stamp;
}

void shift(LogEvent& event, Duration by) {
    const auto put_off = [by](Stamp& stamp) { stamp = stamp + by; };
    switch (event.kind) {
        case LogEvent::Kind::kDifferential: put_off(event.differential.stamp); break;
        case LogEvent::Kind::kAckermann: put_off(event.ackermann.stamp); break;
        case LogEvent::Kind::kImu: put_off(event.imu.stamp); break;
        case LogEvent::Kind::kScan: put_off(event.scan.stamp); break;
        case LogEvent::Kind::kCloud: std::for_each_n(event.cloud->stamp.begin(), event.cloud->columns, put_off); break;
        case LogEvent::Kind::kPlace: put_off(event.place.stamp); break;
        case LogEvent::Kind::kMotion: put_off(event.motion.stamp); break;
    }
}

std::unique_ptr<LogReader> open_log(const std::filesystem::path& file, const LidarParams& lidar,
                                    const WheelEncoderParams& wheels) {
    LineSource source(file);
    for (std::string_view rest = source.peek(); !rest.empty();) {
        const std::size_t end = rest.find('\n');
        const std::string_view line = rest.substr(0, end);
        rest.remove_prefix(end == rest.npos ? rest.size() : end + 1);
        if (looks_like_carmen(line)) {
            return std::make_unique<CarmenReader>(std::move(source), lidar);
        }
        if (looks_like_urg_dat(line)) {
            return std::make_unique<UrgDatReader>(std::move(source), lidar, wheels);
        }
    }
    throw InputError(source.name() +
                     ": neither a CARMEN log (FLASER, ROBOTLASER1, ODOM lines) nor a URG-04LX .dat log; give one of "
                     "these, plain or compressed");
}

}  // namespace crspf
