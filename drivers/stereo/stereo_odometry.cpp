#include "drivers/stereo/stereo_odometry.hpp"

#include <algorithm>

#include "core/base/real.hpp"
#include "core/base/trig.hpp"
#include "drivers/stereo/camera_mounting.hpp"

namespace crspf {

namespace {

constexpr std::size_t kPointsMin = 30;
constexpr std::size_t kMatchesMin = 20;
constexpr double kMatchedMin = 0.15;  // of the points
constexpr double kFoundMin = 0.3;     // of the points, where they were expected at the right places
constexpr double kAgreeMin = 0.5;     // of the matches ...
constexpr double kAsBefore = 0.25;    // ... where they agree on the motion that was expected
// A velocity less certain than this is worth nothing beside the one before.
constexpr double kSpeedStddevMax_mps = 0.5;
constexpr double kTurnStddevMax_radps = 0.1;
// The points of a reference are followed until so few are left, or they went so far.
constexpr double kLeft = 0.6;
constexpr double kFlowMax_px = 10.0;

double flow_px(const StereoMatch& m) {
    return std::max(absolute(m.after.left_u_px - m.before.left_u_px), absolute(m.after.v_px - m.before.v_px));
}

}  // namespace

const char* name_of(Blindness blindness) {
    switch (blindness) {
        case Blindness::kSees: return "sees";
        case Blindness::kNoTexture: return "no texture";
        case Blindness::kNoMatch: return "no match";
        case Blindness::kNoAgreement: return "no agreement";
        case Blindness::kUncertain: return "uncertain";
        case Blindness::kImplausible: return "implausible";
    }
    return "";
}

StereoOdometry::StereoOdometry(const RectifiedCamera& camera, const StereoParams& params)
    : camera_(camera), P_base_camera_(camera_on_base(params.mounting)), matcher_(camera), solver_(camera) {
    cv::setNumThreads(1);
}

bool StereoOdometry::add(Stamp stamp, const StereoView& pictures, StereoMotion& out) {
    if (started_ && stamp <= last_) {
        ++counters_.ran_back;
        return false;
    }
    ++counters_.pairs;
    matcher_.load(pictures);
    out.points = static_cast<std::uint32_t>(matcher_.reference_points());
    out.matches = 0;
    out.inliers = 0;
    out.blindness = Blindness::kSees;
    if (!started_) {
        started_ = true;
        last_seen_ = stamp;
        take_reference();
        report(stamp, out);
        return true;
    }
    const double dt_s = (stamp - last_).seconds();
    if (stamp - last_ > kGap) {
        ++counters_.gaps;
        filter_.forget_velocity();
    }
    filter_.predict(dt_s);
    Egomotion seen;
    out.blindness = look(dt_s, seen, out);
    if (out.blindness == Blindness::kSees) {
        filter_.update(seen.P_before_after, seen.covariance);
        last_seen_ = stamp;
        blind_ = false;
    } else {
        go_blind(dt_s);
        if (out.blindness == Blindness::kImplausible && stamp - last_seen_ > kGap) {
            filter_.forget_velocity();  // it is so, then
        }
        if (stamp - last_seen_ > kHeldFor) {
            filter_.stop();
        }
    }
    P_first_camera_ = P_first_reference_ * filter_.P_reference_camera();
    report(stamp, out);
    if (blind_ || is_new_reference_due()) {
        take_reference();
    }
    return true;
}

void StereoOdometry::go_blind(double dt_s) {
    ++counters_.blind;
    if (blind_) {
        adrift_.predict(dt_s);
        return;
    }
    blind_ = true;
    adrift_ = filter_;
    when_lost_ = at_reference_;
}

StereoOdometry::Doubt StereoOdometry::doubt() const {
    const MotionFilter& filter = blind_ ? adrift_ : filter_;
    const Doubt& before = blind_ ? when_lost_ : at_reference_;
    const Matrix6 to_base = adjoint(P_base_camera_);
    const Matrix6 covariance = to_base * filter.pose_covariance() * to_base.transpose();
    return {.translation_m2 = before.translation_m2 + std::max(covariance(0, 0), covariance(1, 1)),
            .rotation_rad2 = before.rotation_rad2 + covariance(5, 5)};
}

bool StereoOdometry::solve(CircleMatcher::Search search, const RigidMotion& guess, Egomotion& seen) {
    matcher_.match(search, guess, matches_);
    return solver_.solve(matches_, guess, seen);
}

Blindness StereoOdometry::look(double dt_s, Egomotion& seen, StereoMotion& out) {
    if (matcher_.reference_points() < kPointsMin) {
        return Blindness::kNoTexture;
    }
    const auto points = static_cast<double>(matcher_.reference_points());
    const RigidMotion expected = filter_.P_reference_camera();
    bool solved = solve(CircleMatcher::Search::kNarrow, expected, seen);
    const auto agreed = [&] { return solved && seen.inliers >= kAgreeMin * static_cast<double>(matches_.size()); };
    if (!agreed() || static_cast<double>(matches_.size()) < kFoundMin * points) {
        ++counters_.wide;
        Egomotion roughly;
        if (solve(CircleMatcher::Search::kWide, expected, roughly)) {
            solved = solve(CircleMatcher::Search::kNarrow, roughly.P_before_after, seen);
        } else {
            solved = solve(CircleMatcher::Search::kNarrow, expected, seen);
        }
    }
    out.matches = static_cast<std::uint32_t>(matches_.size());
    out.inliers = seen.inliers;
    const auto matches = static_cast<double>(matches_.size());
    if (matches_.size() < kMatchesMin || matches < kMatchedMin * points) {
        return Blindness::kNoMatch;
    }
    const Blindness most = agreed() ? judge(seen, dt_s) : Blindness::kNoAgreement;
    if (most == Blindness::kSees) {
        return most;
    }
    // A crowd may be the most of what is seen: then those count that move as was to be expected.
    Egomotion as_expected;
    if (solver_.refine(matches_, expected, as_expected) && as_expected.inliers >= kAsBefore * matches &&
        judge(as_expected, dt_s) == Blindness::kSees) {
        seen = as_expected;
        out.inliers = seen.inliers;
        return Blindness::kSees;
    }
    return most;
}

Blindness StereoOdometry::judge(const Egomotion& seen, double dt_s) const {
    const Eigen::Array<double, 6, 1> variances = seen.covariance.diagonal().array() / square(dt_s);
    if (variances.head<3>().maxCoeff() > square(kSpeedStddevMax_mps) ||
        variances.tail<3>().maxCoeff() > square(kTurnStddevMax_radps)) {
        return Blindness::kUncertain;
    }
    return filter_.is_plausible(seen.P_before_after, seen.covariance, dt_s) ? Blindness::kSees
                                                                            : Blindness::kImplausible;
}

bool StereoOdometry::is_new_reference_due() const {
    std::vector<double> flows;
    const std::vector<bool>& inlier = solver_.inliers();
    for (std::size_t i = 0; i < matches_.size(); ++i) {
        if (inlier[i]) {
            flows.push_back(flow_px(matches_[i]));
        }
    }
    if (static_cast<double>(flows.size()) < kLeft * static_cast<double>(matcher_.reference_points())) {
        return true;
    }
    const auto middle = flows.begin() + static_cast<std::ptrdiff_t>(flows.size() / 2);
    std::nth_element(flows.begin(), middle, flows.end());
    return *middle > kFlowMax_px;
}

void StereoOdometry::take_reference() {
    ++counters_.references;
    at_reference_ = doubt();
    P_first_reference_ = P_first_camera_;
    filter_.rebase();
    matcher_.take_reference();
}

void StereoOdometry::report(Stamp stamp, StereoMotion& out) {
    const RigidMotion P_previous_base =
        P_base_camera_ * out.P_first_camera.inverse() * P_first_camera_ * P_base_camera_.inverse();
    out.sample.stamp = stamp;
    out.sample.P_previous_base = {.x_m = P_previous_base.t.x(),
                                  .y_m = P_previous_base.t.y(),
                                  .theta_rad = arc_tan2(P_previous_base.R(1, 0), P_previous_base.R(0, 0))};
    // The longer a reference is followed, the better its far end is known, too: then nothing is added.
    const Doubt now = doubt();
    out.sample.translation_variance_m2 = std::max(0.0, now.translation_m2 - told_.translation_m2);
    out.sample.rotation_variance_rad2 = std::max(0.0, now.rotation_rad2 - told_.rotation_rad2);
    out.sample.blind = blind_;
    told_.translation_m2 = std::max(told_.translation_m2, now.translation_m2);
    told_.rotation_rad2 = std::max(told_.rotation_rad2, now.rotation_rad2);
    out.P_first_camera = P_first_camera_;
    last_ = stamp;
}

}  // namespace crspf
