// Where a picture can be told from itself moved: places to follow, spread over it.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace crspf {

/// Bounds of the choice. [px] of the picture that is given.
struct CornerParams {
    int bucket_px = 40;
    int per_bucket = 4;
    int apart_px = 7;
    int margin_px = 8;  ///< from the edge
    /// Grey levels a pixel by which the picture changes in its weakest direction: above a camera's noise.
    double contrast = 2.0;
};

/// The strongest corners (least eigenvalue, Shi and Tomasi 1994) of each bucket, row by row of buckets. Keeps its
/// buffers.
class CornerFinder {
 public:
    explicit CornerFinder(const CornerParams& params) : params_(params) {}

    /// @param picture 8 bit gray  @param out replaced
    void find(const cv::Mat& picture, std::vector<cv::Point2f>& out);

 private:
    struct Corner {
        float strength;
        int x;
        int y;
    };
    void choose(const cv::Rect& bucket, std::vector<cv::Point2f>& out);

    CornerParams params_;
    cv::Mat strength_;
    std::vector<Corner> candidates_;
};

}  // namespace crspf
