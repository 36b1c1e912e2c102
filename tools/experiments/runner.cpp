#include "tools/experiments/runner.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "platform/files/input_error.hpp"

namespace crspf::experiments {

namespace {

std::string seeds_text(const Experiment& experiment, const Context& context) {
    if (experiment.seeds == 0) {
        return "1, always";
    }
    const std::size_t seeds = context.seeds_or(experiment.seeds);
    return seeds == 1 ? "1" : "1 to " + std::to_string(seeds);
}

void run_one(const Experiment& experiment, const Context& context, Section& section, Outcome& outcome) {
    try {
        std::filesystem::create_directories(context.scratch);
        section.findings = experiment.run(context);
    } catch (const Skipped& e) {
        section.skipped = e.what();
    } catch (const InputError& e) {
        section.failure = e.what();
        outcome.failed = true;
    } catch (const std::exception& e) {
        section.failure = std::string("internal error: ") + e.what();
        outcome.internal_error = true;
    }
    std::error_code ignored;  // what stays lies in a directory for such things
    std::filesystem::remove_all(context.scratch, ignored);
}

}  // namespace

std::vector<Experiment> chosen(std::span<const Experiment> all, const std::vector<std::string>& names) {
    for (const std::string& name : names) {
        if (std::none_of(all.begin(), all.end(), [&](const Experiment& e) { return e.name == name; })) {
            std::string reason = name + ": there is no such experiment; there are";
            for (const Experiment& experiment : all) {
                reason.append(" ").append(experiment.name);
            }
            throw InputError(reason);
        }
    }
    std::vector<Experiment> some(all.begin(), all.end());
    std::erase_if(some, [&](const Experiment& experiment) {
        return !names.empty() && std::find(names.begin(), names.end(), experiment.name) == names.end();
    });
    return some;
}

Outcome run_all(std::span<const Experiment> experiments, const Context& context, const std::string& options,
                const Observer& observer) {
    Outcome outcome;
    for (const Experiment& experiment : experiments) {
        Section section{.name = experiment.name,
                        .title = experiment.title,
                        .source = experiment.source,
                        .seeds = seeds_text(experiment, context),
                        .command = std::string("crspf experiments ") + experiment.name + options};
        Context own = context;
        own.scratch /= experiment.name;
        own.seeds = context.seeds_or(experiment.seeds);
        own.progress = [&observer](double share) {
            if (observer.progress) {
                observer.progress(share);
            }
        };
        if (observer.begins) {
            observer.begins(experiment);
        }
        const auto begin = std::chrono::steady_clock::now();
        run_one(experiment, own, section, outcome);
        section.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        if (observer.ends) {
            observer.ends(section);
        }
        outcome.sections.push_back(std::move(section));
    }
    return outcome;
}

}  // namespace crspf::experiments
