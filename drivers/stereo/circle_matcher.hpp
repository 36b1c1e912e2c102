// Points followed in a circle through the pictures of two moments (paper 3.2): left before -> right before -> right
// after -> left after -> left before. Who does not come home is left out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "core/base/gray_image.hpp"
#include "drivers/stereo/corners.hpp"
#include "drivers/stereo/egomotion.hpp"

namespace crspf {

struct CircleParams {
    CornerParams corners;       ///< in pictures of half the size
    int window_px = 11;         ///< that is followed as a whole
    double home_px = 0.5;       ///< how far from its beginning a circle may end
    double row_px = 1.0;        ///< by which the rows of a pair may differ
    double unique = 1.15;       ///< so much worse every other place in the row must fit than the one that is taken
    double alike = 0.25;        ///< differing by so little of what is usual, two places of a row are the same pattern
    double disparity_px = 0.2;  ///< less tells no distance
};

/// Keeps the pictures of two moments; heap use until they all had their size. One owner.
class CircleMatcher {
 public:
    explicit CircleMatcher(const RectifiedCamera& camera, const CircleParams& params = {});

    /// The pictures of this moment, of the camera's size; rectified.
    void load(const StereoView& pictures);
    /// The pictures loaded last become the reference, whose points are followed. How many points both of them show.
    std::size_t take_reference();
    [[nodiscard]] std::size_t reference_points() const { return reference_points_.size(); }

    enum class Search {
        kWide,   ///< of some points, far round where they are guessed
        kNarrow  ///< of all, a window or two round it
    };
    /// The reference's points that are found in the pictures loaded last.
    void match(Search search, const RigidMotion& P_reference_now, std::vector<StereoMatch>& out);

 private:
    /// Of one picture, each level followed by its derivatives.
    using Pyramid = std::vector<cv::Mat>;
    struct Moment {
        Pyramid left;
        Pyramid right;
    };
    /// One on its way round.
    struct Traveller {
        StereoPoint before;
        StereoPoint guess;
        StereoPoint after;
    };

    void build(const GrayView& picture, Pyramid& out) const;
    /// Fills differences_: of the patch round a place in the reference's left picture and those to the left of it.
    void compare_along_row(const cv::Mat& with, cv::Point at_half);
    template <class Visit>
    void for_each_valley(const Visit& visit) const;
    [[nodiscard]] bool repeats_itself(cv::Point at_half);
    /// Of a place in the reference's left picture, both in pixels of the pictures of half the size.
    [[nodiscard]] bool find_disparity(cv::Point at_half, int& disparity_half_px);
    /// From from_ to to_, which holds guesses at first. Travellers that are lost go.
    void follow(const Pyramid& from, const Pyramid& to, int levels);
    template <class Keep>
    void keep(const Keep& good);

    RectifiedCamera camera_;
    CircleParams params_;
    CornerFinder finder_;
    Moment now_;
    Moment reference_;
    std::vector<StereoPoint> reference_points_;
    std::vector<Traveller> travellers_;  ///< with from_ and to_, one each
    std::vector<cv::Point2f> corners_;
    std::vector<std::uint16_t> differences_;  ///< of patches, by disparity
    std::vector<cv::Point2f> from_;
    std::vector<cv::Point2f> to_;
    std::vector<unsigned char> found_;
    std::vector<float> error_;
};

}  // namespace crspf
