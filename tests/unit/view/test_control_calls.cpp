#include <atomic>
#include <catch2/catch.hpp>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "core/base/trig.hpp"
#include "platform/crspfd/control_server.hpp"
#include "platform/files/input_error.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tools/view/control_calls.hpp"

namespace {

using namespace crspf;
using crspf::test::Scratch;
using crspf::view::ControlCalls;
using crspf::view::set_pose_request;
using Json = nlohmann::json;

/// Turns until there are so many answers.
void turn_until(ControlCalls& calls, const std::vector<std::string>& answers, std::size_t count) {
    while (answers.size() < count) {
        calls.turn();
        std::this_thread::yield();
    }
}

TEST_CASE("A pose of a viewer's is three numbers", "[control_calls]") {
    const ControlRequest request = set_pose_request({{"x_m", 1.5}, {"y_m", -2}, {"heading_deg", 90}});
    CHECK(request.command == ControlRequest::Command::kSetPose);
    CHECK(request.P_map_base.x_m == 1.5);
    CHECK(request.P_map_base.y_m == -2.0);
    CHECK(request.P_map_base.theta_rad == Approx(radians(90.0)));
    CHECK_THROWS_WITH(set_pose_request({{"x_m", 1.5}, {"heading_deg", 90}}), Catch::Contains("y_m"));
    CHECK_THROWS_AS(set_pose_request({{"x_m", "1"}, {"y_m", 0}, {"heading_deg", 0}}), InputError);
}

TEST_CASE("The service is asked, and its answer handed out by turn()", "[control_calls]") {
    const Scratch scratch;
    std::atomic<int> asked = 0;
    ControlServer service(scratch / "control", [&asked](const ControlRequest& request) {
        ++asked;
        return request.P_map_base.x_m > 5.0 ? error_line("too far") : result_line(nlohmann::ordered_json::object());
    });
    std::jthread serving([&service](const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            service.serve(Duration{5'000'000});
        }
    });
    ControlCalls calls(scratch / "control");
    std::vector<std::string> answers;
    const auto keep = [&answers](const std::string& error) { answers.push_back(error); };
    calls.ask(set_pose_request({{"x_m", 1}, {"y_m", 0}, {"heading_deg", 0}}), keep);
    calls.ask(set_pose_request({{"x_m", 9}, {"y_m", 0}, {"heading_deg", 0}}), keep);
    turn_until(calls, answers, 2);
    CHECK(answers[0].empty());
    CHECK(answers[1].find("too far") != std::string::npos);
    CHECK(asked == 2);
}

TEST_CASE("A service that is away is told as the answer, and nobody waits for it", "[control_calls]") {
    const Scratch scratch;
    std::vector<std::string> answers;
    const auto keep = [&answers](const std::string& error) { answers.push_back(error); };
    ControlCalls calls(scratch / "nobody");
    calls.ask({}, keep);
    turn_until(calls, answers, 1);
    CHECK(answers[0].find("nobody") != std::string::npos);
}

TEST_CASE("Calls have a bound", "[control_calls]") {
    const Scratch scratch;
    ControlServer service(scratch / "control",
                          [](const ControlRequest&) { return error_line("never"); });  // nobody serves
    std::vector<std::string> answers;
    auto calls = std::make_unique<ControlCalls>(scratch / "control", Duration{50'000'000});
    for (std::size_t i = 0; i < 2 * ControlCalls::kWaitingMax; ++i) {
        calls->ask({}, [&answers](const std::string& error) { answers.push_back(error); });
    }
    REQUIRE(answers.size() >= ControlCalls::kWaitingMax - 1);
    CHECK(answers[0].find("ask again") != std::string::npos);
}

}  // namespace
