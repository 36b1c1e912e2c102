// Match values analyser (paper 4.4 and 5): what the match value decides, with hysteresis.
#pragma once

#include "core/slam/slam_params.hpp"

namespace crspf {

class MatchAnalyser {
 public:
    explicit MatchAnalyser(const AnalyserParams& params) : params_(params) {}

    /// @param M M(t) of (11), on the scale of (10): 0 to 2975
    void update(double M) {
        result_ = result_ ? !(M < params_.result_off) : M > params_.result_on;
        // A map that has only just been begun matches faintly, however good the pose: until it first matches fairly,
        // every scan is drawn.
        begun_ = begun_ || M > params_.draw_on;
        draw_ = draw_ ? !begun_ || !(M < params_.draw_off) : M > params_.draw_on;
    }

    /// (12): the pose is good: a key frame. It corrects the odometry, is drawn, and removes errors.
    [[nodiscard]] bool result() const { return result_; }
    /// (13): the pose is fair: the scan may be drawn although Result is 0.
    [[nodiscard]] bool draw() const { return draw_; }

 private:
    AnalyserParams params_;
    bool result_ = false;
    bool draw_ = true;
    bool begun_ = false;
};

}  // namespace crspf
