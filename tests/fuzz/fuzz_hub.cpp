// Whatever a viewer sends: it is answered with messages of the protocol, at most it is cut off, and what it makes the
// hub keep is bounded.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/view/hub.hpp"

namespace {

using namespace crspf::view;

void demand(bool so) {
    if (!so) {
        std::abort();
    }
}

void check(const Outgoing& message) {
    if (message.binary) {
        demand(message.head.size() >= 13 && (message.head[0] == 1 || message.head[0] == 3));
        demand(message.body == nullptr || nlohmann::json::accept(message.body->data));
    } else {
        demand(message.body == nullptr && nlohmann::json::accept(message.head));
    }
}

std::vector<Action> actions(std::vector<Action::Answer>& open) {
    const auto now = [](const nlohmann::json& request, const Action::Answer& answer) {
        answer(request.contains("fail") ? "no" : "");
    };
    const auto later = [&open](const nlohmann::json& /*request*/, const Action::Answer& answer) {
        open.push_back(answer);
    };
    return {{.name = "/now", .request_name = "Now", .request_schema = "{}", .call = now},
            {.name = "/later", .request_name = "Later", .request_schema = "{}", .call = later}};
}

}  // namespace

/// Pieces, each: what it is (text, binary, a scan comes, the socket has room), its length in two bytes, its content.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes as text
    std::string_view rest(reinterpret_cast<const char*>(data), size);
    Channels channels;
    std::vector<Action::Answer> open;
    Hub hub(channels, "1", actions(open));
    std::int64_t stamp_ns = 0;
    {
        HubPeer peer(hub);
        while (rest.size() >= 3 && !peer.cut_off()) {
            const auto kind = static_cast<std::uint8_t>(rest[0]);
            const std::size_t length = static_cast<std::uint8_t>(rest[1]) + 256U * static_cast<std::uint8_t>(rest[2]);
            const std::string_view content = rest.substr(3, length);
            rest.remove_prefix(3 + content.size());
            switch (kind % 4) {
                case 0: peer.take_text(content); break;
                case 1: peer.take_binary(content); break;
                case 2: {
                    ScanEvent scan;
                    scan.stamp_ns = ++stamp_ns;
                    channels.take(scan);
                    break;
                }
                default:
                    if (const auto message = peer.next()) {
                        check(*message);
                    }
                    break;
            }
        }
        for (const Action::Answer& answer : std::exchange(open, {})) {
            answer("late");
        }
        std::size_t left = 0;
        while (const auto message = peer.next()) {
            check(*message);
            demand(++left < std::size_t{64} * 700);  // subscriptions, and what a channel keeps
        }
    }
    for (const Action::Answer& answer : open) {
        answer("nobody is there");
    }
    return 0;
}
