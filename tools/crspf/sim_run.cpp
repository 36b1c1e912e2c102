#include "tools/crspf/sim_run.hpp"

#include <filesystem>
#include <memory>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "config/config.hpp"
#include "core/base/trig.hpp"
#include "platform/files/atomic_file.hpp"
#include "platform/files/grid_map.hpp"
#include "platform/files/input_error.hpp"
#include "platform/files/trajectory.hpp"
#include "tools/crspf/sim_config.hpp"
#include "tools/sim/capture_writer.hpp"
#include "tools/sim/kitti_folder.hpp"
#include "tools/sim/lidar_model.hpp"
#include "tools/sim/log_writer.hpp"
#include "tools/sim/scene.hpp"

namespace crspf::cli {

namespace {

/// Of the log, the capture and the pictures those that are written.
class AllWriters final : public sim::LogWriter {
 public:
    void add(sim::LogWriter& writer) { writers_.push_back(&writer); }

    void odometry(const sim::OdometryRecord& record, std::string& out) override {
        for (sim::LogWriter* writer : writers_) {
            writer->odometry(record, out);
        }
    }
    void scan(const sim::ScanRecord& record, std::string& out) override {
        for (sim::LogWriter* writer : writers_) {
            writer->scan(record, out);
        }
    }
    void packet(const sim::PacketRecord& record, std::string& out) override {
        for (sim::LogWriter* writer : writers_) {
            writer->packet(record, out);
        }
    }
    void pictures(const sim::PictureRecord& record, std::string& out) override {
        for (sim::LogWriter* writer : writers_) {
            writer->pictures(record, out);
        }
    }

 private:
    std::vector<sim::LogWriter*> writers_;
};

/// What is written while the robot drives.
class Recordings {
 public:
    /// @param config of which the capture tells, too
    Recordings(const SimOptions& options, const sim::SimulationParams& params, const std::string& config) {
        if (!options.capture.empty()) {
            capture_file_.emplace(options.capture);
            capture_ =
                std::make_unique<sim::CaptureWriter>(params, parse_config(config, "config.toml"), config,
                                                     [this](std::string_view bytes) { capture_file_->write(bytes); });
        }
        if (!params.lidar.spatial()) {
            const bool carmen = options.format == "carmen";
            log_name_ = carmen ? "log.clf" : "log.dat";
            log_file_.emplace(std::filesystem::path(options.out) / log_name_);
            log_ = carmen ? sim::carmen_writer(params.lidar, params.P_base_lidar) : sim::urg_dat_writer();
            writers_.add(*log_);
        }
        if (capture_) {
            writers_.add(*capture_);
        }
        if (!options.stereo.empty()) {
            pictures_.emplace(options.stereo, params.stereo->camera.camera);
            writers_.add(*pictures_);
        }
    }
    Recordings(const Recordings&) = delete;
    Recordings& operator=(const Recordings&) = delete;
    ~Recordings() = default;

    [[nodiscard]] sim::LogWriter& writers() { return writers_; }
    void write_log(std::string_view text) {
        if (log_file_) {
            log_file_->write(text);
        }
    }
    /// The files appear.
    void finish() {
        if (capture_) {
            capture_->finish();
            capture_file_->commit();
        }
        if (log_file_) {
            log_file_->commit();
        }
        if (pictures_) {
            pictures_->finish();
        }
    }
    [[nodiscard]] const std::string& log_name() const { return log_name_; }
    [[nodiscard]] std::optional<std::size_t> picture_pairs() const {
        return pictures_ ? std::optional(pictures_->pairs()) : std::nullopt;
    }

 private:
    std::optional<AtomicFile> capture_file_;
    std::unique_ptr<sim::CaptureWriter> capture_;
    std::string log_name_;
    std::optional<AtomicFile> log_file_;
    std::unique_ptr<sim::LogWriter> log_;
    std::optional<sim::KittiFolder> pictures_;
    AllWriters writers_;
};

void write_whole(const std::filesystem::path& target, std::string_view text) {
    AtomicFile file(target);
    file.write(text);
    file.commit();
}

void check(const SimOptions& options) {
    if (!options.config.empty() && options.capture.empty()) {
        throw InputError("--config: what its sources say is bytes; give --capture FILE.pcapng");
    }
    if (options.format == "dat" && options.lidar.value_or("urg") != "urg") {
        throw InputError("--format dat: this format is the URG's alone; use --lidar urg or --format carmen");
    }
    if (options.format == "dat" && !options.capture.empty()) {
        throw InputError("--format dat: its stamps are not those of a capture; leave it out with --capture");
    }
    if (sim::lidar_model(options.lidar.value_or("urg")).spatial() && options.capture.empty()) {
        throw InputError("--lidar " + *options.lidar + ": logs hold planar scans only; give --capture FILE.pcapng");
    }
}

sim::Scene scene_of(const SimOptions& options) {
    sim::Scene scene = sim::make_scene(options.world);
    if (!options.start.empty()) {
        scene.P_world_start = {.x_m = options.start[0],
                               .y_m = options.start[1],
                               .theta_rad = options.start.size() > 2 ? radians(options.start[2]) : 0.0};
    }
    return scene;
}

void create_directory(const std::string& out) {
    std::error_code error;
    std::filesystem::create_directories(out, error);
    if (error) {
        throw InputError(out + ": cannot be created: " + error.message() + "; give another --out");
    }
}

}  // namespace

SimRun run_sim(const SimOptions& options, const std::function<void(double share)>& progress) {
    check(options);
    std::optional<Config> told = options.config.empty() ? std::nullopt : std::optional(load_config(options.config));
    const sim::SimulationParams params = params_of(options, told ? &*told : nullptr);
    if (told && params.stereo) {
        told->stereo.calibration.clear();
        told->stereo.calibration_text = sim::kitti_calibration(params.stereo->camera.camera);
    }
    const std::string config =
        told ? print_config(*told) : sim_config(params, options.format == "dat", !options.capture.empty());
    const sim::Scene scene = scene_of(options);

    create_directory(options.out);
    Recordings recordings(options, params, config);
    sim::SimulationResult result = sim::simulate(
        scene, params, recordings.writers(), [&](std::string_view text) { recordings.write_log(text); }, progress);
    recordings.finish();
    const std::filesystem::path out = options.out;
    write_tum(result.truth, out / "truth.tum");
    write_grid_map(scene.truth, out / "world");
    write_whole(out / "config.toml", config);
    return {.result = std::move(result), .log = recordings.log_name(), .picture_pairs = recordings.picture_pairs()};
}

}  // namespace crspf::cli
