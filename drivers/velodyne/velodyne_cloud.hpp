// One revolution of a Velodyne sensor.
#pragma once

#include "core/base/cloud.hpp"
#include "drivers/velodyne/velodyne_models.hpp"

namespace crspf {

struct VelodyneCloud : Cloud {
    VelodyneModel model = VelodyneModel::kVlp16;
};

}  // namespace crspf
