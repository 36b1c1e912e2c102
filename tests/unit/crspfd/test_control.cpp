#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <deque>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "platform/crspfd/control_address.hpp"
#include "platform/crspfd/control_client.hpp"
#include "platform/crspfd/control_server.hpp"
#include "platform/files/input_error.hpp"
#include "platform/files/unique_fd.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "tests/unit/platform/scratch.hpp"

using namespace crspf;
using crspf::test::Scratch;
using Command = ControlRequest::Command;

namespace {

std::string error_of(std::string_view line) {
    std::string error;
    CHECK_FALSE(parse_request(line, error));
    return error;
}

std::string echo(const ControlRequest& request) {
    return request.command == Command::kSaveMap ? error_line("disk full")
                                                : result_line({{"x", request.P_map_base.x_m}});
}

UniqueFd connect_to(const std::filesystem::path& path) {
    UniqueFd fd(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    const ControlAddress address(path);
    REQUIRE(::connect(fd.get(), address.get(), ControlAddress::size()) == 0);
    return fd;
}

/// Up to the end of the next line, within ten seconds; empty: none came.
std::string line_of(const UniqueFd& fd) {
    std::string line;
    while (wait_for(fd.get(), POLLIN, Duration{10'000'000'000}) != 0) {
        char c = 0;
        if (::recv(fd.get(), &c, 1, 0) != 1) {
            return {};
        }
        if (c == '\n') {
            return line;
        }
        line += c;
    }
    return {};
}

/// A server in a thread of its own.
class Served {
 public:
    explicit Served(const std::filesystem::path& path, ControlServer::NextLine next = {})
        : server_(path, echo, std::move(next)) {
        thread_ = std::jthread([this](const std::stop_token& stop) {
            while (!stop.stop_requested()) {
                server_.serve(Duration{5'000'000});
            }
        });
    }
    ControlCounters stop() {
        thread_.request_stop();
        thread_.join();
        return server_.counters();
    }

 private:
    ControlServer server_;
    std::jthread thread_;
};

}  // namespace

TEST_CASE("control: requests go there and back") {
    for (const ControlRequest& request :
         {ControlRequest{.command = Command::kStatus, .P_map_base = {}, .text = {}},
          ControlRequest{
              .command = Command::kSetPose, .P_map_base = {.x_m = 1.5, .y_m = -2.0, .theta_rad = 0.5}, .text = {}},
          ControlRequest{.command = Command::kLogLevel, .P_map_base = {}, .text = "debug"},
          ControlRequest{.command = Command::kLoadMap, .P_map_base = {}, .text = "/srv/a \"map\".yaml"},
          ControlRequest{.command = Command::kReset, .P_map_base = {}, .text = {}},
          ControlRequest{.command = Command::kReload, .P_map_base = {}, .text = {}},
          ControlRequest{.command = Command::kRecordStart, .P_map_base = {}, .text = {}},
          ControlRequest{.command = Command::kRecordStop, .P_map_base = {}, .text = {}},
          ControlRequest{.command = Command::kRelocalize, .P_map_base = {}, .text = {}},
          ControlRequest{.command = Command::kWatch, .P_map_base = {}, .text = {}}}) {
        std::string error;
        const auto back = parse_request(request_line(request), error);
        REQUIRE(back);
        CHECK(back->command == request.command);
        CHECK(back->P_map_base.x_m == request.P_map_base.x_m);
        CHECK(back->P_map_base.theta_rad == Approx(request.P_map_base.theta_rad));
        CHECK(back->text == request.text);
    }
}

TEST_CASE("control: what is no request is told why") {
    CHECK(error_of("") == "a request is a line with a JSON object");
    CHECK(error_of("[1]") == "a request is a line with a JSON object");
    CHECK(error_of("\xFF\xFE") == "a request is a line with a JSON object");
    CHECK(error_of("{}").find("version 1") != std::string::npos);
    CHECK(error_of(R"({"version": 2, "command": "status"})").find("of one release") != std::string::npos);
    CHECK(error_of(R"({"version": 1})").find("none of status, pose") != std::string::npos);
    CHECK(error_of(R"({"version": 1, "command": 7})").find("none of status") != std::string::npos);
    for (const char* const pose :
         {"[1, 2]", "\"here\"", "[1, 2, \"x\"]", "[1e9, 0, 0]", "[0, 0, 999]", "[0, 1e999, 0]"}) {
        const std::string line = std::string(R"({"version": 1, "command": "set-pose", "pose": )") + pose + "}";
        CHECK_FALSE(error_of(line).empty());
    }
    for (const char* const path : {"7", "\"\"", "\"map.yaml\"", R"("/a\u0000b")"}) {
        CHECK(error_of(std::string(R"({"version": 1, "command": "load-map", "path": )") + path + "}")
                  .find("absolute path") != std::string::npos);
    }
    CHECK(error_of(R"({"version": 1, "command": "log-level", "level": "loud"})").find("one of trace") !=
          std::string::npos);
}

TEST_CASE("control: asked over the socket it answers, and errors are errors") {
    const Scratch scratch;
    const std::filesystem::path path = scratch / "control";
    Served served(path);
    struct stat status {};
    REQUIRE(::stat(path.c_str(), &status) == 0);
    CHECK((status.st_mode & 0777U) == 0660U);
    const ControlRequest pose{
        .command = Command::kSetPose, .P_map_base = {.x_m = 3.0, .y_m = 0.0, .theta_rad = 0.0}, .text = {}};
    CHECK(ask(path, pose, Duration{5'000'000'000}).at("x") == 3.0);
    CHECK_THROWS_WITH(ask(path, {.command = Command::kSaveMap, .P_map_base = {}, .text = {}}, Duration{5'000'000'000}),
                      Catch::Contains("disk full"));
    CHECK_THROWS_WITH(ask(scratch / "elsewhere", pose, Duration{1'000'000'000}), Catch::Contains("does crspfd run?"));
    CHECK_THROWS_WITH(ControlServer(path, echo), Catch::Contains("another service listens there"));
    CHECK_THROWS_AS(ControlServer(scratch / std::string(200, 'x'), echo), InputError);
}

TEST_CASE("control: what a service left that was killed is no obstacle") {
    const Scratch scratch;
    const std::filesystem::path path = scratch / "control";
    {
        const UniqueFd left(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
        const ControlAddress address(path);
        REQUIRE(::bind(left.get(), address.get(), ControlAddress::size()) == 0);
    }
    REQUIRE(std::filesystem::exists(path));
    {
        const ControlServer server(path, echo);
        CHECK(server.counters().requests == 0);
    }
    CHECK_FALSE(std::filesystem::exists(path));
}

TEST_CASE("control: no peer can hold the others up") {
    const Scratch scratch;
    const std::filesystem::path path = scratch / "control";
    Served served(path);
    const UniqueFd silent = connect_to(path);
    const UniqueFd endless = connect_to(path);
    const std::string much(2 * kRequestBytesMax, 'x');
    static_cast<void>(::send(endless.get(), much.data(), much.size(), MSG_NOSIGNAL));
    const UniqueFd greedy = connect_to(path);  // asks and asks and never reads
    const std::string status = request_line({.command = Command::kStatus, .P_map_base = {}, .text = {}});
    for (int i = 0; i < 100'000; ++i) {
        if (::send(greedy.get(), status.data(), status.size(), MSG_NOSIGNAL) < 0) {
            break;
        }
    }
    { const UniqueFd hasty = connect_to(path); }
    const ControlRequest pose{
        .command = Command::kSetPose, .P_map_base = {.x_m = 3.0, .y_m = 0.0, .theta_rad = 0.0}, .text = {}};
    CHECK(ask(path, pose, Duration{10'000'000'000}).at("x") == 3.0);
    std::deque<UniqueFd> crowd;
    for (std::size_t i = 0; i < ControlServer::kPeersMax + 5; ++i) {
        crowd.push_back(connect_to(path));
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    crowd.clear();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    CHECK(ask(path, pose, Duration{10'000'000'000}).at("x") == 3.0);
    const ControlCounters counters = served.stop();
    CHECK(counters.cut_off >= 2);
    CHECK(counters.refused >= 5);
}

TEST_CASE("control: who watches is sent lines as he takes them, and keeps out nobody who asks") {
    const Scratch scratch;
    const std::filesystem::path path = scratch / "control";
    std::atomic<int> made = 0;
    Served served(path, [&made](WatchCursor& cursor) {
        ++made;
        return std::to_string(++cursor.scan) + std::string(50'000, ' ') + "\n";  // there is always something new
    });
    const std::string watch = request_line({.command = Command::kWatch, .P_map_base = {}, .text = {}});
    const auto begin = [&] {
        UniqueFd fd = connect_to(path);
        REQUIRE(::send(fd.get(), watch.data(), watch.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(watch.size()));
        return fd;
    };
    std::deque<UniqueFd> watchers;
    for (std::size_t i = 0; i < ControlServer::kWatchersMax; ++i) {
        watchers.push_back(begin());
        CHECK(line_of(watchers.back()).find("\"ok\":true") != std::string::npos);
    }
    CHECK(line_of(begin()).find("8 watch already; close one of them") != std::string::npos);
    const ControlRequest pose{
        .command = Command::kSetPose, .P_map_base = {.x_m = 3.0, .y_m = 0.0, .theta_rad = 0.0}, .text = {}};
    for (int i = 0; i < 20; ++i) {
        CHECK(ask(path, pose, Duration{10'000'000'000}).at("x") == 3.0);
    }
    // Nobody of them has read since: what was made for each is what lies in his socket, and one line.
    const int before = made;
    CHECK(before < 200);
    for (int i = 0; i < 20; ++i) {
        CHECK(ask(path, pose, Duration{10'000'000'000}).at("x") == 3.0);
    }
    CHECK(made == before);
    for (int number = 1; number <= 30; ++number) {  // one reads: his lines come in order
        CHECK(std::stoi(line_of(watchers.front())) == number);
    }
    CHECK(made > before);
    watchers.clear();
    UniqueFd after;
    for (int i = 0; i < 100; ++i) {  // their going is seen
        after = begin();
        if (line_of(after).find("\"ok\":true") != std::string::npos) {
            break;
        }
    }
    CHECK(line_of(after).substr(0, 2) == "1 ");
    CHECK(served.stop().refused >= 1);
}

TEST_CASE("control: where there is nothing to be watched, that is the answer") {
    const Scratch scratch;
    const std::filesystem::path path = scratch / "control";
    const Served served(path);
    CHECK_THROWS_WITH(ask(path, {.command = Command::kWatch, .P_map_base = {}, .text = {}}, Duration{10'000'000'000}),
                      Catch::Contains("nothing to be watched"));
}
