#include "platform/crspfd/control_client.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>
#include <system_error>

#include "platform/crspfd/control_address.hpp"
#include "platform/files/input_error.hpp"
#include "platform/files/unique_fd.hpp"
#include "platform/linux/monotonic_clock.hpp"

namespace crspf {

nlohmann::ordered_json ask(const std::filesystem::path& socket, const ControlRequest& request, Duration wait) {
    const auto fail = [&socket](const std::string& what) { return InputError(socket.string() + ": " + what); };
    const UniqueFd fd(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    const ControlAddress address(socket);
    if (::connect(fd.get(), address.get(), ControlAddress::size()) != 0) {
        const bool denied = errno == EACCES;
        throw fail(std::generic_category().message(errno) +
                   (denied ? "; be a member of the socket's group" : "; does crspfd run? --socket names another"));
    }
    const std::string line = request_line(request);
    if (::send(fd.get(), line.data(), line.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(line.size())) {
        throw fail("the service does not take the request; see its log");
    }
    const Stamp deadline = monotonic_now() + wait;
    std::string answer;
    while (answer.find('\n') == std::string::npos) {
        std::array<char, 65536> buffer{};
        const Duration left = deadline - monotonic_now();
        if (left.ns <= 0 || wait_for(fd.get(), POLLIN, left) == 0) {
            throw fail("no answer within " + std::to_string(wait.ns / 1'000'000'000) + " s; see the service's log");
        }
        const ssize_t got = ::recv(fd.get(), buffer.data(), buffer.size(), 0);
        if (got <= 0) {
            throw fail("the service closed the connection; see its log");
        }
        answer.append(buffer.data(), static_cast<std::size_t>(got));
    }
    const nlohmann::ordered_json json = nlohmann::ordered_json::parse(answer, nullptr, false);
    if (!json.is_object() || !json.contains("ok")) {
        throw fail("the answer is none; crspf and crspfd must be of one release");
    }
    if (!json["ok"].get<bool>()) {
        throw fail(json.value("error", "unknown error"));
    }
    return json.value("result", nlohmann::ordered_json::object());
}

}  // namespace crspf
