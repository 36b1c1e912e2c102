// Visual odometry (paper 3.2): pairs of pictures in, motion of the vehicle out.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/gray_image.hpp"
#include "core/base/samples.hpp"
#include "drivers/stereo/circle_matcher.hpp"
#include "drivers/stereo/egomotion.hpp"
#include "drivers/stereo/motion_filter.hpp"
#include "drivers/stereo/stereo_calibration.hpp"
#include "drivers/stereo/stereo_params.hpp"

namespace crspf {

/// Why the pictures told nothing.
enum class Blindness : std::uint8_t {
    kSees,
    kNoTexture,    ///< too few places that can be told apart: dark, blurred, bare, or the same over and over
    kNoMatch,      ///< they were not found again
    kNoAgreement,  ///< no motion explains enough of them: much moves by itself
    kUncertain,    ///< some explains them, but so do others
    kImplausible,  ///< one that no vehicle makes
};

[[nodiscard]] const char* name_of(Blindness blindness);

struct StereoMotion {
    /// Of base_link in the plane since the pair before, with its variances. While blind it goes on as it went, for
    /// kHeldFor at most, and the variances grow accordingly.
    MotionSample sample;
    RigidMotion P_first_camera;  ///< the way so far: the left camera's optical axes, seen from the first pair's
    Blindness blindness = Blindness::kSees;
    std::uint32_t points = 0;   ///< to be followed
    std::uint32_t matches = 0;  ///< circles that came home
    std::uint32_t inliers = 0;
};

struct StereoCounters {
    std::uint64_t pairs = 0;
    std::uint64_t blind = 0;
    std::uint64_t ran_back = 0;    ///< pairs not newer than the one before: dropped
    std::uint64_t gaps = 0;        ///< pairs too long after the one before
    std::uint64_t wide = 0;        ///< the points were not where they were expected
    std::uint64_t references = 0;  ///< pairs whose points were followed
};

/// One owner; an ordinary thread's work: it allocates and takes tens of milliseconds a pair. The same pairs give the
/// same bits on the same kind of processor: OpenCV's arithmetic differs in the last bit between instruction sets.
class StereoOdometry {
 public:
    static constexpr Duration kHeldFor{3'000'000'000};
    static constexpr Duration kGap{1'000'000'000};

    StereoOdometry(const RectifiedCamera& camera, const StereoParams& params);

    /// @param pictures of the camera's size, rectified  @param stamp of their exposure
    /// False: the pair was dropped, and `out` is as it was.
    [[nodiscard]] bool add(Stamp stamp, const StereoView& pictures, StereoMotion& out);

    [[nodiscard]] const StereoCounters& counters() const { return counters_; }

 private:
    [[nodiscard]] Blindness look(double dt_s, Egomotion& seen, StereoMotion& out);
    [[nodiscard]] Blindness judge(const Egomotion& seen, double dt_s) const;
    [[nodiscard]] bool solve(CircleMatcher::Search search, const RigidMotion& guess, Egomotion& seen);
    [[nodiscard]] bool is_new_reference_due() const;
    /// How far the way may be off, as told of the plane.
    struct Doubt {
        double translation_m2 = 0.0;
        double rotation_rad2 = 0.0;
    };
    [[nodiscard]] Doubt doubt() const;
    void go_blind(double dt_s);
    void take_reference();
    void report(Stamp stamp, StereoMotion& out);

    RectifiedCamera camera_;
    RigidMotion P_base_camera_;
    CircleMatcher matcher_;
    EgomotionSolver solver_;
    MotionFilter filter_;
    MotionFilter adrift_;  ///< the filter since the pictures told nothing, never given a new reference
    std::vector<StereoMatch> matches_;

    bool started_ = false;
    Stamp last_;
    Stamp last_seen_;  ///< of the newest pair that told something
    bool blind_ = false;
    RigidMotion P_first_reference_;
    RigidMotion P_first_camera_;
    Doubt at_reference_;
    Doubt when_lost_;  ///< at the reference of the pair that told something last
    Doubt told_;
    StereoCounters counters_;
};

}  // namespace crspf
