// The service within its process: it can be stopped and begun anew, with another configuration or another map.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>

#include "config/config.hpp"
#include "platform/crspfd/map_store.hpp"
#include "platform/crspfd/service.hpp"

namespace crspf {

/// The main thread's, but for alive(). What is stopped saves its map and its pose, and what begins loads them: without
/// poses for about a second. Every method throws InputError, and the service then goes on as before; std::runtime_error
/// where it cannot, and there is none any longer: the process has to end.
class ServiceHost {
 public:
    /// Reads the configuration and the saved map.
    ServiceHost(std::filesystem::path config_file, ServiceOptions options);

    void start() { service_->start(); }
    void stop() { service_->stop(); }
    [[nodiscard]] Service& service() { return *service_; }
    [[nodiscard]] const Config& config() const { return config_; }
    /// From any thread. While the service begins anew: true.
    [[nodiscard]] bool alive() const;

    /// The configuration is read again. Refused where [service] control_socket is another one.
    void reload();
    /// An empty map, the robot at its origin. The map before stays the older of the two on the disk.
    void reset();
    /// A map of map_server's format. Where the robot is on it is unknown: it is looked for.
    void load_map(const std::filesystem::path& yaml);
    /// The run that begins now, from its first byte: a sensor says only at its start what it is.
    /// @return the directory of the recordings
    std::filesystem::path start_recording();
    void stop_recording();

 private:
    void begin_anew(Config config, const std::function<void(MapStore&)>& change);

    std::filesystem::path file_;
    ServiceOptions options_;
    Config config_;
    mutable std::mutex mutex_;  ///< held while there may be no service
    std::unique_ptr<Service> service_;
};

}  // namespace crspf
