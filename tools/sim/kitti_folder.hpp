// Rectified pairs of pictures in a folder, as KITTI's odometry benchmark lays them out
// (https://www.cvlibs.net/datasets/kitti/eval_odometry.php).
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "drivers/stereo/stereo_calibration.hpp"
#include "tools/sim/log_writer.hpp"

namespace crspf::sim {

/// calib.txt of a pair: P0 and P1, each a row of twelve numbers, the projection of a point of the left camera's axes.
[[nodiscard]] std::string kitti_calibration(const RectifiedCamera& camera);

/// image_0/NNNNNN.png (left), image_1 (right), times.txt [s], calib.txt, and poses.txt: the true poses of the left
/// camera in its axes (x right, y down, z forward), from the first one's. Pictures of a longer run that was
/// written there before do not stay behind these.
class KittiFolder final : public LogWriter {
 public:
    /// Throws InputError where it cannot be written, as do the others.
    KittiFolder(std::filesystem::path folder, const RectifiedCamera& camera);

    void odometry(const OdometryRecord& /*record*/, std::string& /*out*/) override {}
    void scan(const ScanRecord& /*record*/, std::string& /*out*/) override {}
    void pictures(const PictureRecord& record, std::string& out) override;
    /// The drive is over: the texts are written, without which a reader finds nothing.
    void finish();

    [[nodiscard]] std::size_t pairs() const { return pairs_; }

 private:
    std::filesystem::path folder_;
    RectifiedCamera camera_;
    std::optional<Pose2> P_world_first_;
    std::size_t pairs_ = 0;
    std::string times_;
    std::string poses_;
};

}  // namespace crspf::sim
