#include "tools/view/control_calls.hpp"

#include <cmath>
#include <exception>
#include <utility>

#include "core/base/trig.hpp"
#include "platform/crspfd/control_client.hpp"
#include "platform/files/input_error.hpp"

namespace crspf::view {

ControlRequest set_pose_request(const nlohmann::json& pose) {
    const auto number = [&pose](const char* key) {
        const auto found = pose.find(key);
        if (found == pose.end() || !found->is_number() || !std::isfinite(found->get<double>())) {
            throw InputError(std::string(key) + ": a number is wanted");
        }
        return found->get<double>();
    };
    return {.command = ControlRequest::Command::kSetPose,
            .P_map_base = {.x_m = number("x_m"), .y_m = number("y_m"), .theta_rad = radians(number("heading_deg"))},
            .text = {}};
}

ControlCalls::ControlCalls(std::filesystem::path socket, Duration patience)
    : socket_(std::move(socket)), patience_(patience), worker_([this] { work(); }) {}

ControlCalls::~ControlCalls() {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
    }
    wakeup_.notify_all();
    worker_.join();
}

void ControlCalls::ask(const ControlRequest& request, Done done) {
    {
        const std::lock_guard lock(mutex_);
        if (waiting_.size() < kWaitingMax) {
            waiting_.push_back({.request = request, .done = std::move(done), .error = {}});
            wakeup_.notify_all();
            return;
        }
    }
    done("the service is busy; ask again");
}

void ControlCalls::turn() {
    std::deque<Call> answered;
    {
        const std::lock_guard lock(mutex_);
        answered.swap(answered_);
    }
    for (const Call& call : answered) {
        call.done(call.error);
    }
}

void ControlCalls::work() {
    std::unique_lock lock(mutex_);
    for (;;) {
        wakeup_.wait(lock, [this] { return ending_ || !waiting_.empty(); });
        if (ending_) {
            return;
        }
        Call call = std::move(waiting_.front());
        waiting_.pop_front();
        lock.unlock();
        try {
            static_cast<void>(crspf::ask(socket_, call.request, patience_));
        } catch (const std::exception& e) {
            call.error = e.what();
        }
        lock.lock();
        answered_.push_back(std::move(call));
    }
}

}  // namespace crspf::view
