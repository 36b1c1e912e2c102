#include "platform/crspfd/service_host.hpp"

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "platform/files/input_error.hpp"
#include "platform/service/map_image.hpp"

namespace crspf {

namespace {

/// Throws InputError where the service could not work on the map.
void check_map(const GridMap& map, const std::string& name, const SlamParams& slam) {
    if (tiles_of(map, name, slam.map.resolution_m, {}).empty()) {
        throw InputError(name + ": nothing in it is known");
    }
}

}  // namespace

ServiceHost::ServiceHost(std::filesystem::path config_file, ServiceOptions options)
    : file_(std::move(config_file)),
      options_(std::move(options)),
      config_(load_config(file_)),
      service_(std::make_unique<Service>(config_, options_)) {}

bool ServiceHost::alive() const {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    return !lock || (service_ != nullptr && service_->alive());
}

void ServiceHost::reload() {
    Config config = load_config(file_);
    if (config.service.control_socket != config_.service.control_socket) {
        throw InputError(file_.string() + ": [service] control_socket is another one; restart the service");
    }
    begin_anew(std::move(config), [](MapStore& /*store*/) {});
}

void ServiceHost::reset() {
    if (config_.service.localize_only) {
        throw InputError("[service] localize_only: there is nothing to be mapped; set it to false and reload");
    }
    GridMap empty;
    empty.width = empty.height = 1;
    empty.resolution_m = config_.slam.map.resolution_m;
    empty.cells = {GridCell::kUnknown};
    begin_anew(config_, [&empty](MapStore& store) { store.save(empty, Pose2{}); });
}

void ServiceHost::load_map(const std::filesystem::path& yaml) {
    const GridMap map = read_grid_map(yaml);
    check_map(map, yaml.string(), config_.slam);
    begin_anew(config_, [&map](MapStore& store) { store.save(map, std::nullopt); });
}

std::filesystem::path ServiceHost::start_recording() {
    if (!config_.service.record_directory.empty()) {
        throw InputError("the run is being recorded already, into " + config_.service.record_directory);
    }
    std::filesystem::path directory = std::filesystem::path(config_.service.state_directory) / "recordings";
    Config config = config_;
    config.service.record_directory = directory.string();
    begin_anew(std::move(config), [](MapStore& /*store*/) {});
    return directory;
}

void ServiceHost::stop_recording() {
    if (config_.service.record_directory.empty()) {
        throw InputError("nothing is being recorded");
    }
    Config config = config_;
    config.service.record_directory.clear();
    begin_anew(std::move(config), [](MapStore& /*store*/) {});
}

void ServiceHost::begin_anew(Config config, const std::function<void(MapStore&)>& change) {
    if (!config_.service.localize_only) {
        service_->save_map();  // a disk that is full is no reason to stop
    }
    const std::lock_guard lock(mutex_);
    const auto begin = [this](const Config& with) {
        service_.reset();  // ports can be opened once
        service_ = std::make_unique<Service>(with, options_);
        service_->start();
    };
    try {
        service_->stop();
        MapStore store(config.service.state_directory);
        change(store);
        begin(config);
        config_ = std::move(config);
    } catch (const InputError& e) {
        const std::string problem = e.what();
        try {
            begin(config_);
        } catch (const InputError& again) {
            throw std::runtime_error(problem + "; nor can the service go on as it was: " + again.what());
        }
        throw InputError(problem + "; the service goes on as it was");
    }
}

}  // namespace crspf
