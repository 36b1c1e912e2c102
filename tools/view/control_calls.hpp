// What viewers ask of the running service: a thread asks, so that a service that takes its time holds nobody up.
#pragma once

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <functional>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "core/base/time.hpp"
#include "platform/crspfd/control_protocol.hpp"

namespace crspf::view {

/// The control protocol's words for {x_m, y_m, heading_deg}; throws InputError where it is no pose.
[[nodiscard]] ControlRequest set_pose_request(const nlohmann::json& pose);

class ControlCalls {
 public:
    using Done = std::function<void(const std::string& error)>;
    static constexpr std::size_t kWaitingMax = 8;

    /// @param patience with an answer
    explicit ControlCalls(std::filesystem::path socket, Duration patience = {5'000'000'000});
    ControlCalls(const ControlCalls&) = delete;
    ControlCalls& operator=(const ControlCalls&) = delete;
    ~ControlCalls();

    /// `done` is called by this call, where too many are waiting, or by turn().
    void ask(const ControlRequest& request, Done done);
    /// Hands out the answers that have come.
    void turn();

 private:
    struct Call {
        ControlRequest request;
        Done done;
        std::string error;
    };
    void work();

    std::filesystem::path socket_;
    Duration patience_;
    std::mutex mutex_;
    std::condition_variable wakeup_;
    std::deque<Call> waiting_;
    std::deque<Call> answered_;
    bool ending_ = false;
    std::thread worker_;
};

}  // namespace crspf::view
