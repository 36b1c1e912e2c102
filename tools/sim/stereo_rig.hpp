// The stereo camera during a drive: when it exposes, and when it is blind.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/sim/log_writer.hpp"
#include "tools/sim/robot.hpp"
#include "tools/sim/scene.hpp"
#include "tools/sim/stereo_camera.hpp"
#include "tools/sim/world.hpp"

namespace crspf::sim {

/// By the time since the drive began.
struct BlindSpell {
    double from_s = 0.0;
    double to_s = 0.0;
    Blindness kind = Blindness::kDark;
};

struct StereoRigParams {
    StereoCameraParams camera;
    double rate_hz = 15.0;
    std::vector<BlindSpell> blind;
};

class StereoRig {
 public:
    /// `scene` must outlive it. @param start_us stamp of the drive's start. Throws what StereoCamera does.
    StereoRig(const Scene& scene, const StereoRigParams& params, std::uint64_t seed, std::int64_t start_us);

    /// Exposes what falls into the step [start_s, start_s + length_s) of the drive.
    void advance(const Motion& motion, double start_s, double length_s, const Movers& movers);
    /// Hands on what is exposed, oldest first.
    void deliver(LogWriter& writer, std::string& out);

 private:
    StereoCamera camera_;
    StereoRigParams params_;
    std::int64_t start_us_;
    std::int64_t next_us_ = 0;  ///< of the next pair, since the drive's start
    std::int64_t pairs_ = 0;
    std::vector<PictureRecord> finished_;
};

}  // namespace crspf::sim
