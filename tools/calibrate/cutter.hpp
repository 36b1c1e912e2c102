// Cuts a drive into pieces: how far the lidar came from one scan to another, by laying the two on each other. The map
// has no part in it, nor what the odometer was believed to say.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/base/pose.hpp"
#include "core/base/samples.hpp"
#include "tools/calibrate/drive.hpp"
#include "tools/calibrate/unknowns.hpp"
#include "tools/eval/scan_alignment.hpp"

namespace crspf::calibrate {

class Cutter {
 public:
    /// @param way  of the odometer, for the way that the lidar makes during a scan
    Cutter(std::vector<Moment> way, const Pose2& P_base_lidar);

    /// The next scan, and where it was matched.
    void add(const Scan& scan, const Pose2& P_map_base);

    [[nodiscard]] std::vector<Piece> pieces() { return std::move(pieces_); }
    /// Pieces whose scans do not lie on each other beyond doubt.
    [[nodiscard]] std::size_t doubtful() const { return doubtful_; }

 private:
    struct Place {
        Stamp stamp;
        Pose2 P_map_lidar;
        eval::ScanHits hits;  ///< in the lidar's frame at its first beam
    };
    [[nodiscard]] eval::ScanHits hits_of(const Scan& scan) const;

    std::vector<Moment> way_;
    Pose2 P_base_lidar_;
    std::optional<Place> begin_;
    Pose2 P_map_before_;
    double way_m_ = 0.0;
    double turn_rad_ = 0.0;
    std::vector<Piece> pieces_;
    std::size_t doubtful_ = 0;
};

}  // namespace crspf::calibrate
