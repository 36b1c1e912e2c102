// The Foxglove WebSocket protocol (github.com/foxglove/ws-protocol, docs/spec.md), without sockets: which peer has
// subscribed to what, and what it is to be sent next. Of a slow peer nothing is kept but its cursors (DESIGN.md).
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/view/channels.hpp"

namespace crspf::view {

/// What a peer may ask to be done: a "service" of the protocol, JSON both ways.
struct Action {
    /// To be called once, now or later. Empty: it is done; else why it is not.
    using Answer = std::function<void(const std::string& error)>;
    std::string name;            ///< "/set_pose"
    std::string request_name;    ///< of the schema, "crspf.SetPose"
    std::string request_schema;  ///< JSON schema
    std::function<void(const nlohmann::json& request, const Answer& answer)> call;
};

/// One message of the WebSocket: `head`, and the data of `body` after it, where there is one.
struct Outgoing {
    bool binary = false;
    std::string head;
    std::shared_ptr<const Message> body;

    [[nodiscard]] std::size_t size() const { return head.size() + (body ? body->data.size() : 0); }
};

struct HubCounters {
    std::uint64_t peers = 0;     ///< that ever came
    std::uint64_t messages = 0;  ///< of channels, handed to a peer
    std::uint64_t calls = 0;     ///< of actions
    std::uint64_t mistakes = 0;  ///< what peers sent that could not be understood or granted
    std::uint64_t cut_off = 0;   ///< peers that sent too much of that, or too much at all
};

/// What all peers have in common. Not thread-safe. Outlives its peers.
class Hub {
 public:
    static constexpr const char* kProtocol = "foxglove.websocket.v1";
    static constexpr std::size_t kIncomingMax = std::size_t{64} * 1024;  ///< [bytes] of a message from a peer

    Hub(Channels& channels, const std::string& version, std::vector<Action> actions);

    [[nodiscard]] const HubCounters& counters() const { return counters_; }

 private:
    friend class HubPeer;

    Channels& channels_;
    std::vector<Action> actions_;
    std::vector<std::string> greeting_;  ///< the first messages to everybody
    HubCounters counters_;
};

/// One connection. What it is given may be anything.
class HubPeer {
 public:
    explicit HubPeer(Hub& hub);
    HubPeer(const HubPeer&) = delete;
    HubPeer& operator=(const HubPeer&) = delete;
    ~HubPeer() = default;

    void take_text(std::string_view text);
    void take_binary(std::string_view bytes);
    /// What is to be sent now, if there is anything; to be asked when the socket has room.
    [[nodiscard]] std::optional<Outgoing> next();
    /// Too much nonsense: close the connection.
    [[nodiscard]] bool cut_off() const { return cut_off_; }

 private:
    struct Subscription {
        std::uint32_t id = 0;  ///< the peer's
        Channels::Id channel = 0;
        std::uint64_t cursor = 0;
    };
    /// Answers on their way. An action may answer when the peer has gone.
    struct Outbox {
        std::deque<Outgoing> ready;
        std::size_t open_calls = 0;
    };

    void subscribe(const nlohmann::json& message);
    void subscribe_one(const nlohmann::json& wish);
    void unsubscribe(const nlohmann::json& message);
    void call(std::uint32_t action, std::uint32_t number, std::string_view encoding, std::string_view data);
    void mistake(const std::string& what);
    void post(Outgoing message);
    void give_up();

    Hub& hub_;
    std::size_t greeted_ = 0;
    std::vector<Subscription> subscriptions_;
    std::size_t turn_ = 0;  ///< whose turn it is: subscriptions are served one after the other
    std::shared_ptr<Outbox> outbox_ = std::make_shared<Outbox>();
    std::size_t mistakes_ = 0;
    bool cut_off_ = false;
};

}  // namespace crspf::view
