// The paper's experiments: each a name and a function that finds something.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "tools/experiments/report/report.hpp"

namespace crspf::experiments {

/// Where an experiment finds what it needs, and whom it tells how far it is.
struct Context {
    std::filesystem::path data;  ///< recordings: data/carmen/intel.clf.xz and the like; need not be there
    std::filesystem::path maps;  ///< 1r5.yaml; need not be there
    std::filesystem::path scratch;
    std::size_t seeds =
        0;  ///< how many, from 1 on; 0: as many as the experiment has by itself, which the runner puts in
    std::function<void(double share)> progress;  ///< from 0 to 1, from one thread at a time
    [[nodiscard]] std::size_t seeds_or(std::size_t own) const { return seeds == 0 ? own : seeds; }
};

/// Thrown where what an experiment needs is not there; the report says so.
class Skipped : public std::runtime_error {
 public:
    using std::runtime_error::runtime_error;
};

struct Experiment {
    const char* name;
    const char* title;
    const char* source;  ///< where in the paper
    std::size_t seeds;   ///< by default; 0: always seed 1
    Findings (*run)(const Context& context);
};

/// In the order of the report.
[[nodiscard]] std::span<const Experiment> experiments();

Findings table1(const Context& context);
Findings rays(const Context& context);
Findings match(const Context& context);
Findings live(const Context& context);
Findings meeting(const Context& context);
Findings corridor(const Context& context);
Findings lobby(const Context& context);
Findings bank(const Context& context);
Findings campus(const Context& context);
Findings parking(const Context& context);
Findings ablation(const Context& context);
Findings logs(const Context& context);
Findings scale(const Context& context);

}  // namespace crspf::experiments
