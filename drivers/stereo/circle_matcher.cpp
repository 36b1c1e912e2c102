#include "drivers/stereo/circle_matcher.hpp"

#include <algorithm>
#include <cmath>  // abs
#include <cstdint>
#include <limits>
#include <numeric>
#include <opencv2/video/tracking.hpp>
#include <utility>

#include "core/base/real.hpp"

namespace crspf {

namespace {

constexpr int kLevels = 3;  // beside the picture itself
constexpr int kNarrowLevels = 1;
constexpr std::size_t kHalfSize = 2;  // its place in a pyramid: behind the picture and its derivatives
constexpr std::size_t kWideEvery = 3;
constexpr int kRounds = 12;
constexpr double kSettled_px = 0.02;
constexpr double kNearest_m = 0.3;
constexpr double kLeastEigen = 1e-4;

// The patch by which a place is sought in the other picture's row, half each way.
constexpr int kPatchX = 5;
constexpr int kPatchY = 4;
// What noise adds to the difference of two patches that are the same. [grey levels a pixel]
constexpr double kNoise = 2.0;
constexpr double kPatchNoise = kNoise * (2 * kPatchX + 1) * (2 * kPatchY + 1);

cv::Point2f point(double x, double y) {
    return {static_cast<float>(x), static_cast<float>(y)};
}

}  // namespace

CircleMatcher::CircleMatcher(const RectifiedCamera& camera, const CircleParams& params)
    : camera_(camera), params_(params), finder_(params.corners) {}

void CircleMatcher::build(const GrayView& picture, Pyramid& out) const {
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-const-cast): OpenCV takes no const pixels, and leaves them as they are
    const cv::Mat view(picture.height, picture.width, CV_8UC1, const_cast<std::uint8_t*>(picture.pixels),
                       picture.stride);
    cv::buildOpticalFlowPyramid(view, out, {params_.window_px, params_.window_px}, kLevels, true,
                                cv::BORDER_REFLECT_101, cv::BORDER_CONSTANT, false);
}

void CircleMatcher::load(const StereoView& pictures) {
    build(pictures.left, now_.left);
    build(pictures.right, now_.right);
}

void CircleMatcher::compare_along_row(const cv::Mat& with, cv::Point at_half) {
    const cv::Mat& left = reference_.left[kHalfSize];
    const double widest_px = std::min(0.5 * camera_.focal_px * camera_.baseline_m / kNearest_m, 0.5 * left.cols);
    const int last = std::min(at_half.x - kPatchX, static_cast<int>(widest_px));
    differences_.assign(static_cast<std::size_t>(std::max(0, last + 1)), 0);
    for (int dy = -kPatchY; dy <= kPatchY; ++dy) {
        const std::uint8_t* const patch = left.ptr<std::uint8_t>(at_half.y + dy) + at_half.x;
        const std::uint8_t* const row = with.ptr<std::uint8_t>(at_half.y + dy) + at_half.x - last;
        for (int dx = -kPatchX; dx <= kPatchX; ++dx) {
            // Pixel by pixel of the patch, all places at once: a loop that compilers make vectors of.
            const int pixel = patch[dx];
            const std::uint8_t* const other = row + dx;
            for (std::size_t i = 0; i < differences_.size(); ++i) {
                const int off = std::abs(int{other[i]} - pixel);
                differences_[i] = static_cast<std::uint16_t>(differences_[i] + off);
            }
        }
    }
    std::reverse(differences_.begin(), differences_.end());
}

template <class Visit>
void CircleMatcher::for_each_valley(const Visit& visit) const {
    const std::vector<std::uint16_t>& v = differences_;
    for (std::size_t d = 0; d < v.size(); ++d) {
        const bool first = d == 0;
        const bool last = d + 1 == v.size();
        if ((first || v[d - 1] > v[d]) && (last || v[d + 1] >= v[d])) {
            // Between two pixels the difference is less than at either: how much less, the slopes to both sides tell.
            visit(d, first || last ? v[d] : v[d] - 0.5 * std::abs(int{v[d - 1]} - int{v[d + 1]}));
        }
    }
}

bool CircleMatcher::repeats_itself(cv::Point at_half) {
    compare_along_row(reference_.left[kHalfSize], at_half);
    const double usual = std::accumulate(differences_.begin(), differences_.end(), 0.0) /
                         static_cast<double>(std::max<std::size_t>(1, differences_.size()));
    bool repeats = false;
    for_each_valley([&](std::size_t d, double fit) { repeats = repeats || (d > 0 && fit < params_.alike * usual); });
    return repeats;
}

bool CircleMatcher::find_disparity(cv::Point at_half, int& disparity_half_px) {
    if (repeats_itself(at_half)) {
        return false;
    }
    compare_along_row(reference_.right[kHalfSize], at_half);
    double best = std::numeric_limits<double>::infinity();
    double second = best;
    for_each_valley([&](std::size_t d, double fit) {
        if (fit < best) {
            second = best;
            best = fit;
            disparity_half_px = static_cast<int>(d);
        } else {
            second = std::min(second, fit);
        }
    });
    return second > params_.unique * best + (params_.unique - 1.0) * kPatchNoise;
}

template <class Keep>
void CircleMatcher::keep(const Keep& good) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < travellers_.size(); ++i) {
        if (good(i, travellers_[i])) {
            travellers_[kept] = travellers_[i];
            to_[kept] = to_[i];
            ++kept;
        }
    }
    travellers_.resize(kept);
    to_.resize(kept);
}

void CircleMatcher::follow(const Pyramid& from, const Pyramid& to, int levels) {
    if (travellers_.empty()) {
        return;
    }
    cv::calcOpticalFlowPyrLK(from, to, from_, to_, found_, error_, {params_.window_px, params_.window_px}, levels,
                             {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, kRounds, kSettled_px},
                             cv::OPTFLOW_USE_INITIAL_FLOW, kLeastEigen);
    keep([this](std::size_t i, const Traveller&) { return found_[i] != 0; });
}

std::size_t CircleMatcher::take_reference() {
    std::swap(now_, reference_);
    finder_.find(reference_.left[kHalfSize], corners_);
    travellers_.clear();
    from_.clear();
    to_.clear();
    for (const cv::Point2f& corner : corners_) {
        const cv::Point at_half(static_cast<int>(corner.x), static_cast<int>(corner.y));
        int disparity_half_px = 0;
        if (find_disparity(at_half, disparity_half_px)) {
            const cv::Point2f at = 2.0F * corner;
            from_.push_back(at);
            to_.emplace_back(at.x - 2.0F * static_cast<float>(disparity_half_px), at.y);
            travellers_.push_back({.before = {.left_u_px = static_cast<double>(at.x),
                                              .right_u_px = 0.0,
                                              .v_px = static_cast<double>(at.y)},
                                   .guess = {},
                                   .after = {}});
        }
    }
    follow(reference_.left, reference_.right, kNarrowLevels);
    reference_points_.clear();
    for (std::size_t i = 0; i < travellers_.size(); ++i) {
        StereoPoint seen = travellers_[i].before;
        seen.right_u_px = static_cast<double>(to_[i].x);
        const double off_px = static_cast<double>(to_[i].y) - seen.v_px;
        if (absolute(off_px) < params_.row_px && seen.disparity_px() > params_.disparity_px) {
            reference_points_.push_back(seen);
            reference_points_.back().v_px += 0.5 * off_px;
        }
    }
    return reference_points_.size();
}

void CircleMatcher::match(Search search, const RigidMotion& P_reference_now, std::vector<StereoMatch>& out) {
    out.clear();
    const bool wide = search == Search::kWide;
    const int levels = wide ? kLevels : kNarrowLevels;
    const RigidMotion P_now_reference = P_reference_now.inverse();
    travellers_.clear();
    from_.clear();
    to_.clear();
    for (std::size_t i = 0; i < reference_points_.size(); i += wide ? kWideEvery : 1) {
        const StereoPoint& seen = reference_points_[i];
        const Eigen::Vector3d p = P_now_reference * point_of(camera_, seen);
        if (p.z() < kNearest_m) {
            continue;
        }
        const StereoPoint guess = seen_at(camera_, p);
        if (guess.v_px < 0.0 || guess.v_px >= camera_.height || guess.right_u_px < 0.0 ||
            guess.left_u_px >= camera_.width) {
            continue;
        }
        travellers_.push_back({.before = seen, .guess = guess, .after = guess});
        from_.push_back(point(seen.right_u_px, seen.v_px));
        to_.push_back(point(guess.right_u_px, guess.v_px));
    }
    follow(reference_.right, now_.right, levels);

    const auto begin_leg = [this](const auto& goal) {
        from_ = to_;
        for (std::size_t i = 0; i < travellers_.size(); ++i) {
            to_[i] = goal(i, travellers_[i]);
        }
    };
    begin_leg([this](std::size_t i, Traveller& t) {
        t.after.right_u_px = static_cast<double>(from_[i].x);
        t.after.v_px = static_cast<double>(from_[i].y);
        return point(t.after.right_u_px + t.guess.disparity_px(), t.after.v_px);
    });
    follow(now_.right, now_.left, levels);
    keep([this](std::size_t i, Traveller& t) {
        const double off_px = static_cast<double>(to_[i].y) - t.after.v_px;
        t.after.left_u_px = static_cast<double>(to_[i].x);
        t.after.v_px += 0.5 * off_px;
        return absolute(off_px) < params_.row_px && t.after.disparity_px() > params_.disparity_px;
    });
    begin_leg([](std::size_t, const Traveller& t) { return point(t.before.left_u_px, t.before.v_px); });
    follow(now_.left, reference_.left, levels);
    const double home_px = wide ? 2.0 * params_.home_px : params_.home_px;
    keep([&](std::size_t i, const Traveller& t) {
        return absolute(static_cast<double>(to_[i].x) - t.before.left_u_px) < home_px &&
               absolute(static_cast<double>(to_[i].y) - t.before.v_px) < home_px;
    });
    for (const Traveller& t : travellers_) {
        out.push_back({.before = t.before, .after = t.after});
    }
}

}  // namespace crspf
