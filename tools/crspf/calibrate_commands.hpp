// What `crspf calibrate` can find beside the vehicle itself, each in its file.
#pragma once

#include <CLI/CLI.hpp>

namespace crspf::cli {

void add_calibrate_stereo(CLI::App& calibrate);

}  // namespace crspf::cli
