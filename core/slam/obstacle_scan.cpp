#include "core/slam/obstacle_scan.hpp"

#include <algorithm>

#include "core/base/real.hpp"
#include "core/base/trig.hpp"

namespace crspf {
namespace {

constexpr double kTurn_rad = 2.0 * kPi;
// [m^2] Farther than any laser reaches: nothing came back, or the vehicle's own body did.
constexpr float kNowhere = 4e12F;
constexpr float kBody = 2e12F;
/// Columns that are levelled alike: within a millisecond a vehicle does not tilt.
constexpr std::uint32_t kColumnsAtOnce = 16;
/// Within 30 degrees of the vertical.
constexpr float kUpright = 0.577F;

using Matrix = std::array<double, 9>;  // row by row

/// Turns about x, then about y.
Matrix tilt(SinCos pitch, SinCos roll) {
    return {pitch.cos,
            pitch.sin * roll.sin,
            pitch.sin * roll.cos,  //
            0.0,
            roll.cos,
            -roll.sin,  //
            -pitch.sin,
            pitch.cos * roll.sin,
            pitch.cos * roll.cos};
}

Matrix product(const Matrix& a, const Matrix& b) {
    Matrix out{};
    for (std::size_t row = 0; row < 9; row += 3) {
        for (std::size_t column = 0; column < 3; ++column) {
            out[row + column] = a[row] * b[column] + a[row + 1] * b[column + 3] + a[row + 2] * b[column + 6];
        }
    }
    return out;
}

Vector3 applied(const Matrix& m, const Vector3& v) {
    return {.x = m[0] * v.x + m[1] * v.y + m[2] * v.z,
            .y = m[3] * v.x + m[4] * v.y + m[5] * v.z,
            .z = m[6] * v.x + m[7] * v.y + m[8] * v.z};
}

ObstacleParams bounded(ObstacleParams params) {
    params.beams = std::clamp<std::uint32_t>(params.beams, 1, capacity::kSectors);
    return params;
}

/// [rad] in [-pi, pi], within 1e-5: a sector's thousandth. Choices are sums with a part taken once or not at all,
/// without which compilers do not vectorise the loop round it.
inline float direction_of(float y, float x) {
    const float ax = __builtin_fabsf(x);
    const float ay = __builtin_fabsf(y);
    const float steep = ay > ax ? 1.0F : 0.0F;
    const float behind = x < 0.0F ? 1.0F : 0.0F;
    const float t = (ay < ax ? ay : ax) / ((ay < ax ? ax : ay) + 1e-30F);
    const float s = t * t;
    // Hastings' polynomial for the arc tangent on [0, 1].
    const float octant =
        t * (0.99997726F +
             s * (-0.33262347F + s * (0.19354346F + s * (-0.11643287F + s * (0.05265332F - s * 0.01172120F)))));
    const float quadrant = octant + steep * (static_cast<float>(0.5 * kPi) - 2.0F * octant);
    const float half = quadrant + behind * (static_cast<float>(kPi) - 2.0F * quadrant);
    return __builtin_copysignf(half, y);
}

}  // namespace

ObstacleScanner::ObstacleScanner(const ObstacleParams& params, const LidarParams& lidar)
    : params_(bounded(params)),
      lidar_(lidar),
      sector_rad_(kTurn_rad / params_.beams),
      yaw_(sin_cos(lidar.P_base_lidar.theta_rad)) {
    const SinCos slope = sin_cos(params.slope_rad);
    ground_slope_ = static_cast<float>(slope.sin / slope.cos);
    const Pose2& at = lidar.P_base_lidar;
    const double body_x_m = std::max(absolute(params.body_x_min_m - at.x_m), absolute(params.body_x_max_m - at.x_m));
    const double body_y_m = params.body_half_width_m + absolute(at.y_m);
    const double body_z_m = params.lidar_height_m;
    const bool has_body = params.body_x_max_m > params.body_x_min_m && params.body_half_width_m > 0.0;
    body_m2_ = has_body ? static_cast<float>(square(body_x_m) + square(body_y_m) + square(body_z_m)) : 0.0F;
    const SinCos roll = sin_cos(params.lidar_roll_rad);
    const SinCos pitch = sin_cos(params.lidar_pitch_rad);
    mounting_ = product({yaw_.cos, -yaw_.sin, 0.0, yaw_.sin, yaw_.cos, 0.0, 0.0, 0.0, 1.0}, tilt(pitch, roll));
}

bool ObstacleScanner::scan(const Cloud& cloud, const AttitudeHistory& attitude, Scan& out) {
    out.count = 0;
    const double s_per_rad = cloud.seconds_per_radian();
    if (!(s_per_rad > 0.0)) {
        return false;
    }
    lasers_ = std::min(cloud.lasers, static_cast<std::uint32_t>(capacity::kCloudLasers));
    for (std::uint32_t i = 0; i < lasers_; ++i) {
        rank_[cloud.upward[i] % capacity::kCloudLasers] = static_cast<std::uint8_t>(i);
    }
    cut_rad_ = wrap_angle(cloud.cut_rad);
    for (std::uint32_t sector = 0; sector < params_.beams; ++sector) {
        std::fill_n(seen_[sector].begin(), lasers_,
                    Seen{.nearest = {.squared = kNowhere}, .middle = {.squared = kNowhere}, .off_middle = 1.0F});
    }
    const Duration late = Duration::from_seconds(lidar_.stamp_offset_s);
    for (std::uint32_t column = 0; column < cloud.columns; ++column) {
        if (column % kColumnsAtOnce == 0) {
            level(attitude.up_at(cloud.stamp[column] + late));
        }
        if (cloud.measured[column]) {
            gather(cloud, column);
        }
    }
    out.count = params_.beams;
    out.angle_increment_rad = sector_rad_;
    // Beam 0 lies half a sector before the cut, seen in the sense of the sensor's turn: it is measured last.
    out.angle_min_rad = wrap_angle(-cut_rad_ + 0.5 * sector_rad_);
    out.time_per_beam_s = -s_per_rad * sector_rad_;
    const double first_after_cut_rad = wrap_angle(cloud.azimuth_rad[0] - cut_rad_);
    out.stamp = cloud.stamp[0] + late +
                Duration::from_seconds(s_per_rad * (kTurn_rad - 0.5 * sector_rad_ - first_after_cut_rad));
    for (std::uint32_t sector = 0; sector < params_.beams; ++sector) {
        by_nearest_[sector] = walk(seen_[sector], &Seen::nearest);
        by_middle_[sector] = walk(seen_[sector], &Seen::middle);
    }
    for (std::uint32_t sector = 0; sector < params_.beams; ++sector) {
        tell(sector, out);
    }
    return true;
}

/// Turns the vehicle upright about base_link, which is on the ground, and looks from above the lidar's place there.
void ObstacleScanner::level(const Vector3& up) {
    const double across = square_root(square(up.y) + square(up.z));
    const bool known = across > 0.5;  // it lies on its side: nothing can be said
    const SinCos pitch{.sin = known ? -up.x : 0.0, .cos = known ? across : 1.0};
    const SinCos roll{.sin = known ? up.y / across : 0.0, .cos = known ? up.z / across : 1.0};
    const Matrix upright = tilt(pitch, roll);
    // Back into the lidar's direction: a Scan's angles are counted from there.
    const Matrix from_base{yaw_.cos, yaw_.sin, 0.0, -yaw_.sin, yaw_.cos, 0.0, 0.0, 0.0, 1.0};
    const Matrix levelled = product(from_base, upright);
    const Matrix rotation = product(levelled, mounting_);
    std::transform(rotation.begin(), rotation.end(), rotation_.begin(), [](double v) { return static_cast<float>(v); });
    const Vector3 lidar_m{.x = lidar_.P_base_lidar.x_m, .y = lidar_.P_base_lidar.y_m, .z = params_.lidar_height_m};
    const Vector3 place_m{.x = lidar_m.x, .y = lidar_m.y, .z = 0.0};
    const Vector3 origin_m = applied(levelled, lidar_m) - applied(from_base, place_m);
    origin_m_ = {static_cast<float>(origin_m.x), static_cast<float>(origin_m.y), static_cast<float>(origin_m.z)};
}

void ObstacleScanner::gather(const Cloud& cloud, std::uint32_t column) {
    const std::size_t first = cloud.at(column, 0);
    const auto cut_rad = static_cast<float>(cut_rad_);
    const auto per_sector = static_cast<float>(1.0 / sector_rad_);
    const auto sectors = static_cast<float>(params_.beams);
    const auto& m = rotation_;
    const auto& o = origin_m_;
    for (std::uint32_t i = 0; i < lasers_; ++i) {
        const float x_m = cloud.x_m[first + i];
        const float y_m = cloud.y_m[first + i];
        const float z_m = cloud.z_m[first + i];
        const float upright_x_m = m[0] * x_m + m[1] * y_m + m[2] * z_m + o[0];
        const float upright_y_m = m[3] * x_m + m[4] * y_m + m[5] * z_m + o[1];
        z_m_[i] = m[6] * x_m + m[7] * y_m + m[8] * z_m + o[2];
        squared_[i] = upright_x_m * upright_x_m + upright_y_m * upright_y_m;
        // Counter-clockwise from the cut: at first in [-1, 1] turns.
        const float turned = (direction_of(upright_y_m, upright_x_m) + cut_rad) * per_sector;
        const float positive = turned + (turned < 0.0F ? sectors : 0.0F);
        sector_[i] = positive - (positive >= sectors ? sectors : 0.0F);
    }
    for (std::uint32_t i = 0; i < lasers_; ++i) {
        if (cloud.beam[first + i] != Beam::kHit) {
            continue;
        }
        const bool body = is_body(cloud.x_m[first + i], cloud.y_m[first + i], cloud.z_m[first + i]);
        const Point point{.squared = body ? kBody : squared_[i], .z_m = z_m_[i]};
        const std::uint32_t sector = std::min(static_cast<std::uint32_t>(sector_[i]), params_.beams - 1);
        Seen& seen = seen_[sector][rank_[i]];
        const float off = __builtin_fabsf(sector_[i] - static_cast<float>(sector) - 0.5F);
        // Written either way: what a branch would decide cannot be foreseen.
        seen.nearest = point.squared < seen.nearest.squared ? point : seen.nearest;
        seen.middle = off < seen.off_middle ? point : seen.middle;
        seen.off_middle = std::min(off, seen.off_middle);
    }
}

bool ObstacleScanner::is_body(float x_m, float y_m, float z_m) const {
    if (x_m * x_m + y_m * y_m + z_m * z_m >= body_m2_) {
        return false;
    }
    const Vector3 seen_m{.x = static_cast<double>(x_m), .y = static_cast<double>(y_m), .z = static_cast<double>(z_m)};
    const Vector3 from_lidar_m = applied(mounting_, seen_m);
    const double base_x_m = lidar_.P_base_lidar.x_m + from_lidar_m.x;
    const double base_y_m = lidar_.P_base_lidar.y_m + from_lidar_m.y;
    return base_x_m > params_.body_x_min_m && base_x_m < params_.body_x_max_m &&
           absolute(base_y_m) < params_.body_half_width_m;
}

ObstacleScanner::Walked ObstacleScanner::walk(const Sector& sector, Point Seen::*which) const {
    const auto step_m = static_cast<float>(params_.height_step_m);
    const auto top_m = static_cast<float>(params_.vehicle_height_m);
    const auto farthest_m = static_cast<float>(params_.range_max_m);
    const float none_m = farthest_m + 1.0F;
    float obstacle_m = none_m;
    float ground_m = 0.0F;
    bool gap = false;
    // What lies lowest under a slope through it; at first the ground below the vehicle.
    float least_z_m = 0.0F;
    float least = 0.0F;
    // Far off a single laser meets a wall below the vehicle's height: no steep step from the ground so much nearer.
    // That the next laser meets it, too, right above, tells it from a hillside.
    bool raised = false;
    float raised_z_m = 0.0F;
    float raised_m = 0.0F;
    for (std::uint32_t k = 0; k < lasers_; ++k) {
        const auto [squared, z_m] = sector[k].*which;
        if (squared == kBody) {
            continue;
        }
        const float range_m = square_root(squared);
        const float fall_m = range_m * ground_slope_;
        // Lower than any slope goes down lies nothing but mirror images.
        if (squared == kNowhere || z_m > top_m || z_m < -fall_m - step_m) {
            const bool above = raised && squared != kNowhere && z_m > top_m;
            if (above && __builtin_fabsf(range_m - raised_m) < kUpright * (z_m - raised_z_m)) {
                obstacle_m = std::min(obstacle_m, raised_m);
            }
            raised = false;
            gap = true;
            continue;
        }
        const float under = z_m - fall_m;
        if (z_m - least_z_m > step_m && under > least) {
            obstacle_m = std::min(obstacle_m, range_m);
            raised = false;
            gap = true;
            continue;
        }
        raised = z_m - least_z_m > step_m;
        raised_z_m = z_m;
        raised_m = range_m;
        if (!gap) {
            ground_m = std::max(ground_m, range_m);
        }
        if (under < least) {
            least = under;
            least_z_m = z_m;
        }
    }
    return {.obstacle_m = obstacle_m, .ground_m = ground_m};
}

/// The nearest point of a wall that is passed along lies at its sector's side: told for the middle, far walls would
/// lean in from both sides, by 9 cm at 20 m. And where a wall begins within a sector, but not before its middle, it
/// would seem to begin too early, the more so the farther it is: driving on, the vehicle would seem to be slower than
/// it is. What has no neighbours is a pole, and is told wherever it stands in its sector.
void ObstacleScanner::tell(std::uint32_t sector, Scan& out) const {
    constexpr float kSame_m = 0.3F;  // of one thing, from one sector to the next ...
    constexpr float kSame = 0.03F;   // ... and by the range, for a wall that is passed along
    const auto farthest_m = static_cast<float>(params_.range_max_m);
    Walked walked = by_nearest_[sector];
    const auto has_it = [&](std::uint32_t other) {
        return __builtin_fabsf(by_middle_[other].obstacle_m - walked.obstacle_m) < kSame_m + kSame * walked.obstacle_m;
    };
    const std::uint32_t last = params_.beams - 1;
    if (walked.obstacle_m < farthest_m &&
        (has_it(sector) || has_it(sector == 0 ? last : sector - 1) || has_it(sector == last ? 0 : sector + 1))) {
        walked = by_middle_[sector];
    }
    if (walked.obstacle_m < farthest_m) {
        out.beam[sector] = Beam::kHit;
        out.range_m[sector] = walked.obstacle_m;
    } else {
        out.beam[sector] = walked.ground_m > 0.0F ? Beam::kClear : Beam::kInvalid;
        out.range_m[sector] = std::min(walked.ground_m, farthest_m);
    }
}

}  // namespace crspf
