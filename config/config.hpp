// The configuration file: TOML, one table per module, every key optional. docs/configuration.md lists the keys.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "config/service_config.hpp"
#include "config/sources.hpp"
#include "config/stereo_config.hpp"
#include "core/base/wheel_encoder_params.hpp"
#include "core/slam/slam_params.hpp"

namespace crspf {

/// Every setting that a file can carry; default-constructed it is the empty file.
struct Config {
    SlamParams slam;
    WheelEncoderParams wheels;
    std::vector<SourceConfig> sources;  ///< in the file's order of names
    StereoConfig stereo;
    PoseOutputConfig pose_output;
    ThreadsConfig threads;
    ServiceConfig service;
};

/// Reads and checks a file. Throws InputError that lists every problem found, one a line:
/// "FILE:LINE:COLUMN: [table] key: reason; remedy". A TOML syntax error hides the problems behind it.
[[nodiscard]] Config load_config(const std::filesystem::path& file);

/// The same for text already in memory; `name` stands for the file in messages.
[[nodiscard]] Config parse_config(std::string_view text, std::string_view name);

/// All values as a TOML file that loads back to the same bits; each line says whether it holds the default.
[[nodiscard]] std::string print_config(const Config& config);

/// docs/configuration.md.
[[nodiscard]] std::string config_reference();

/// The compile-time bounds of config/capacities.hpp with their values and what they cost.
[[nodiscard]] std::string list_capacities();

}  // namespace crspf
