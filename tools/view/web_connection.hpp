// What the view's server keeps of a connection while something is on its way.
#pragma once

#include <libwebsockets.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/view/hub.hpp"

namespace crspf::view {

/// What is being sent on a connection: the answer to a request.
struct Answer {
    std::string made;       ///< where it is not one of the page's files
    std::string_view body;  ///< of `made` or of the program itself
    std::size_t sent = 0;
};

/// A peer of the hub, and the one message that is on its way to it.
struct PeerSession {
    explicit PeerSession(Hub& hub) : peer(hub) {}
    HubPeer peer;
    std::string incoming;  ///< pieces of a message that is not whole yet
    std::optional<Outgoing> outgoing;
    std::size_t sent = 0;
};

/// libwebsockets wants room in front of what it sends.
class SendBuffer {
 public:
    static constexpr std::size_t kChunk = std::size_t{32} * 1024;  ///< [bytes] written at once

    SendBuffer() : bytes_(LWS_PRE + kChunk) {}
    [[nodiscard]] std::uint8_t* begin() { return bytes_.data() + LWS_PRE; }
    [[nodiscard]] std::uint8_t* end() { return bytes_.data() + bytes_.size(); }
    /// Text from `from` on, as much as there is room for. @return how much
    std::size_t fill(std::string_view text, std::size_t from) { return append(0, text, from); }
    std::size_t fill(const Outgoing& message, std::size_t from) {
        std::size_t n = append(0, message.head, std::min(from, message.head.size()));
        if (message.body) {
            n += append(n, message.body->data, from + n - message.head.size());
        }
        return n;
    }

 private:
    std::size_t append(std::size_t at, std::string_view text, std::size_t from) {
        const std::size_t n = std::min(kChunk - at, text.size() - from);
        std::copy_n(text.data() + from, n, begin() + at);
        return n;
    }
    std::vector<std::uint8_t> bytes_;
};

}  // namespace crspf::view
