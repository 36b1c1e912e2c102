// Runs experiments one after the other; one that fails does not keep the others from running.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "tools/experiments/experiment.hpp"

namespace crspf::experiments {

/// Who watches. Each may be empty.
struct Observer {
    std::function<void(const Experiment& experiment)> begins;
    std::function<void(double share)> progress;
    std::function<void(const Section& section)> ends;
};

struct Outcome {
    std::vector<Section> sections;
    bool failed = false;          ///< one at least, by what the user can mend
    bool internal_error = false;  ///< one at least, by what only we can mend
};

/// Those of the names, in the order of `all`, each once; all of them without a name. Throws InputError for a name that
/// there is not.
[[nodiscard]] std::vector<Experiment> chosen(std::span<const Experiment> all, const std::vector<std::string>& names);

/// Each gets a directory of its own in context.scratch, which is gone afterwards, and its own number of seeds unless
/// the context names one. `options` are those with which a section is found again: " --out DIR --seeds 3".
[[nodiscard]] Outcome run_all(std::span<const Experiment> experiments, const Context& context,
                              const std::string& options, const Observer& observer);

}  // namespace crspf::experiments
