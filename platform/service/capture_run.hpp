// Recorded traffic of sensors -> samples, through the drivers that would have heard it live.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "config/config.hpp"
#include "platform/capture/log_reader.hpp"

namespace crspf {

/// Recordings of one run, played together: their records in the order of their stamps, those of one file in the order
/// of the file. A stamp that runs back by more than a second is a clock that was set: that file goes on from there, and
/// it is counted.
///
/// A recorded source belongs to the configured one of the same name. Where none has its name: a datagram to the one
/// that listens on its port, a CAN bus to the one on an interface of its name or else to the only one, a stream to the
/// only one.
///
/// Pictures of a stereo camera are an odometer as [stereo] describes it; what a service was told of them is left out
/// then.
///
/// Throws InputError: a file that cannot be read or is no recording, a configuration without sources; and at the end,
/// where none of the sources spoke.
[[nodiscard]] std::unique_ptr<LogReader> open_capture_run(const std::vector<std::filesystem::path>& files,
                                                          const Config& config);

}  // namespace crspf
