#include "drivers/stereo/corners.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "core/base/real.hpp"

namespace crspf {

namespace {

constexpr int kBlock_px = 5;  // over which the changes are summed

/// cornerMinEigenVal returns the mean square of the change over two pixels, in the weakest direction, in units of the
/// full scale.
float strength_of(double contrast) {
    constexpr double kFullScale = 255.0;
    return static_cast<float>(square(2.0 * contrast / kFullScale));
}

}  // namespace

void CornerFinder::find(const cv::Mat& picture, std::vector<cv::Point2f>& out) {
    out.clear();
    const int margin = params_.margin_px;
    if (picture.cols <= 2 * margin || picture.rows <= 2 * margin) {
        return;
    }
    cv::cornerMinEigenVal(picture, strength_, kBlock_px, 3);
    for (int y = margin; y < picture.rows - margin; y += params_.bucket_px) {
        for (int x = margin; x < picture.cols - margin; x += params_.bucket_px) {
            choose({x, y, std::min(params_.bucket_px, picture.cols - margin - x),
                    std::min(params_.bucket_px, picture.rows - margin - y)},
                   out);
        }
    }
}

void CornerFinder::choose(const cv::Rect& bucket, std::vector<cv::Point2f>& out) {
    const float least = strength_of(params_.contrast);
    candidates_.clear();
    for (int y = bucket.y; y < bucket.y + bucket.height; ++y) {
        const float* const above = strength_.ptr<float>(y - 1);
        const float* const row = strength_.ptr<float>(y);
        const float* const below = strength_.ptr<float>(y + 1);
        for (int x = bucket.x; x < bucket.x + bucket.width; ++x) {
            const float s = row[x];
            if (s > least && s >= row[x - 1] && s > row[x + 1] && s >= above[x] && s > below[x]) {
                candidates_.push_back({s, x, y});
            }
        }
    }
    std::sort(candidates_.begin(), candidates_.end(), [](const Corner& a, const Corner& b) {
        return a.strength != b.strength ? a.strength > b.strength : a.y != b.y ? a.y < b.y : a.x < b.x;
    });
    const std::size_t before = out.size();
    const auto apart = static_cast<float>(params_.apart_px);
    for (const Corner& c : candidates_) {
        if (out.size() - before == static_cast<std::size_t>(params_.per_bucket)) {
            break;
        }
        const cv::Point2f place(static_cast<float>(c.x), static_cast<float>(c.y));
        const auto near = [&](const cv::Point2f& other) {
            return std::max(std::abs(other.x - place.x), std::abs(other.y - place.y)) < apart;
        };
        if (std::none_of(out.begin() + static_cast<std::ptrdiff_t>(before), out.end(), near)) {
            out.push_back(place);
        }
    }
}

}  // namespace crspf
