// Finds the pose of a trajectory by its stamp. Recorded stamps may run back, so file order is not stamp order.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "platform/files/trajectory.hpp"

namespace crspf::eval {

class StampIndex {
 public:
    /// The stamps are finite. Of poses with equal stamps the first in file order is kept.
    explicit StampIndex(const std::vector<TimedPose>& trajectory);

    /// Place in the trajectory of the pose nearest in stamp, the earlier one of two equally near; none if it is more
    /// than `max_gap_s` away.
    [[nodiscard]] std::optional<std::size_t> nearest(double stamp_s, double max_gap_s) const;

 private:
    struct Entry {
        double stamp_s;
        std::size_t place;
    };
    std::vector<Entry> by_stamp_;
};

}  // namespace crspf::eval
