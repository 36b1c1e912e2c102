#include "tools/view/path_keeper.hpp"

#include <cmath>

namespace crspf::view {

bool PathKeeper::add(const Pose2& P_map_base) {
    if (!std::isfinite(P_map_base.x_m) || !std::isfinite(P_map_base.y_m) || !std::isfinite(P_map_base.theta_rad)) {
        return false;
    }
    if (!poses_.empty() &&
        std::hypot(P_map_base.x_m - poses_.back().x_m, P_map_base.y_m - poses_.back().y_m) < spacing_m_) {
        return false;
    }
    if (poses_.size() == kPosesMax) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < poses_.size(); i += 2) {
            poses_[kept++] = poses_[i];
        }
        poses_.resize(kept);
        spacing_m_ *= 2.0;
    }
    poses_.push_back(P_map_base);
    return true;
}

void PathKeeper::clear() {
    poses_.clear();
    spacing_m_ = kSpacing_m;
}

}  // namespace crspf::view
