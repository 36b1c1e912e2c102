#include "platform/service/open_run.hpp"

#include <algorithm>
#include <string>

#include "platform/capture/capture_reader.hpp"
#include "platform/capture/stereo_folder.hpp"
#include "platform/files/input_error.hpp"
#include "platform/service/capture_run.hpp"

namespace crspf {

namespace {

/// The configuration that a recording carries; nothing where it has none.
std::optional<Config> carried_config(const std::filesystem::path& file) {
    const std::unique_ptr<CaptureReader> reader = open_capture(file);
    CaptureRecord record;
    static_cast<void>(reader->next(record));
    if (reader->comment().find("[source.") == std::string::npos) {
        return std::nullopt;
    }
    return parse_config(reader->comment(), file.string() + " (its configuration)");
}

}  // namespace

Run open_run(const std::vector<std::filesystem::path>& files, const std::optional<Config>& config) {
    Run run{.parts = {}, .config = config.value_or(Config{})};
    const auto captures = std::count_if(files.begin(), files.end(), is_capture);
    if (captures == 0) {
        for (const std::filesystem::path& file : files) {
            run.parts.push_back(open_log(file, run.config.slam.lidar, run.config.wheels));
        }
        return run;
    }
    if (captures != static_cast<std::ptrdiff_t>(files.size())) {
        const auto log = std::find_if_not(files.begin(), files.end(), is_capture);
        throw InputError(
            log->string() +
            ": no recording of sensors (pcapng, pcap, candump) as the others are; play logs by themselves");
    }
    for (const std::filesystem::path& file : files) {
        if (!config && run.config.sources.empty()) {
            run.config = carried_config(file).value_or(Config{});
        }
    }
    for (const std::filesystem::path& file : files) {
        StereoConfig& stereo = run.config.stereo;
        if (is_stereo_folder(file) && stereo.calibration.empty() && stereo.calibration_text.empty()) {
            stereo.calibration = calibration_of(file).string();
        }
    }
    run.parts.push_back(open_capture_run(files, run.config));
    return run;
}

}  // namespace crspf
