// The recording of the Intel Research Lab as samples in memory, with its relations.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "core/base/pose.hpp"
#include "tools/eval/relations.hpp"
#include "tools/sim/sample_drive.hpp"

namespace crspf::experiments {

struct IntelRun {
    sim::SampleDrive drive;        ///< without a truth: there are relations in its stead
    std::vector<double> stamps_s;  ///< of the scans, as recorded
    std::vector<eval::Relation> relations;
};

/// DATA/carmen/intel.clf.xz and intel.relations.xz; nothing where one is not there.
[[nodiscard]] std::optional<IntelRun> load_intel(const std::filesystem::path& data);

/// The same with every fifth scan and all of the odometry; of the relations those whose scans were kept.
[[nodiscard]] IntelRun every_fifth(const IntelRun& run);

/// Mean absolute error of the translation over the relations.
[[nodiscard]] double relation_error_m(const IntelRun& run, const std::vector<Pose2>& poses);

}  // namespace crspf::experiments
