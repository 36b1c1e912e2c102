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
constexpr double kFlowMax_px = 0.0;

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
        P_first_camera_ = P_first_reference_ * filter_.P_reference_camera();
        if (is_new_reference_due()) {
            report(stamp, out);
            take_reference();
            return true;
        }
    } else {
        ++counters_.blind;
        if (!blind_) {
            adrift_ = filter_;
            blind_ = true;
        } else {
            adrift_.predict(dt_s);
        }
        P_first_camera_ = P_first_reference_ * filter_.P_reference_camera();
        if (stamp - last_seen_ > kHeldFor) {
            filter_.stop();
            adrift_.stop();
        }
        report(stamp, out);
        take_reference();
        return true;
    }
    report(stamp, out);
    return true;
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
    if (!agreed()) {
        return Blindness::kNoAgreement;
    }
    const Eigen::Array<double, 6, 1> variances = seen.covariance.diagonal().array() / square(dt_s);
    if (variances.head<3>().maxCoeff() > square(kSpeedStddevMax_mps) ||
        variances.tail<3>().maxCoeff() > square(kTurnStddevMax_radps)) {
        return Blindness::kUncertain;
    }
    if (!filter_.is_plausible(seen.P_before_after, seen.covariance, dt_s)) {
        return Blindness::kImplausible;
    }
    return Blindness::kSees;
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
    known_ += filter_.pose_covariance();
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
    out.P_first_camera = P_first_camera_;
    last_ = stamp;
}

}  // namespace crspf
