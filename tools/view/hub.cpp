#include "tools/view/hub.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace crspf::view {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kSubscriptionsMax = 64;
constexpr std::size_t kAnswersMax = 32;  ///< open or not taken yet, of one peer
constexpr std::size_t kMistakesMax = 16;

// The first byte of binary messages.
constexpr char kMessageData = 0x01;
constexpr char kCallRequest = 0x02;
constexpr char kCallResponse = 0x03;

constexpr int kStatusError = 2;

void put(std::string& out, std::uint64_t value, std::size_t bytes) {
    for (std::size_t i = 0; i < bytes; ++i) {
        out += static_cast<char>(static_cast<std::uint8_t>(value >> (8 * i)));
    }
}

std::uint32_t get_u32(std::string_view bytes) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        value |= std::uint32_t{static_cast<std::uint8_t>(bytes[i])} << (8 * i);
    }
    return value;
}

/// Foreign text may hold anything; the protocol's own is UTF-8.
std::string text_of(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Outgoing text_message(const Json& json) {
    return {.binary = false, .head = text_of(json), .body = nullptr};
}

std::optional<std::uint32_t> u32_of(const nlohmann::json& object, const char* key) {
    const auto found = object.is_object() ? object.find(key) : object.end();
    if (found == object.end() || !found->is_number_unsigned() ||
        found->get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max()) {
        return std::nullopt;
    }
    return found->get<std::uint32_t>();
}

Json server_info(const std::string& version, bool services) {
    Json capabilities = Json::array();
    if (services) {
        capabilities.push_back("services");
    }
    return {{"op", "serverInfo"},
            {"name", "crspf view"},
            {"capabilities", std::move(capabilities)},
            {"supportedEncodings", {"json"}},
            {"metadata", {{"version", version}}}};
}

Json advertise(const std::vector<ChannelInfo>& channels) {
    Json list = Json::array();
    for (std::size_t id = 0; id < channels.size(); ++id) {
        list.push_back({{"id", id},
                        {"topic", channels[id].topic},
                        {"encoding", "json"},
                        {"schemaName", channels[id].schema_name},
                        {"schema", channels[id].schema},
                        {"schemaEncoding", "jsonschema"}});
    }
    return {{"op", "advertise"}, {"channels", std::move(list)}};
}

Json advertise_services(const std::vector<Action>& actions) {
    constexpr const char* kAnswerSchema =
        R"({"type":"object","properties":{"ok":{"type":"boolean"},"error":{"type":"string"}}})";
    Json list = Json::array();
    for (std::size_t id = 0; id < actions.size(); ++id) {
        const auto json_by = [](const std::string& name, const std::string& schema) {
            return Json{
                {"encoding", "json"}, {"schemaName", name}, {"schemaEncoding", "jsonschema"}, {"schema", schema}};
        };
        list.push_back({{"id", id},
                        {"name", actions[id].name},
                        {"type", actions[id].request_name},
                        {"request", json_by(actions[id].request_name, actions[id].request_schema)},
                        {"response", json_by("crspf.Answer", kAnswerSchema)}});
    }
    return {{"op", "advertiseServices"}, {"services", std::move(list)}};
}

Outgoing call_response(std::uint32_t action, std::uint32_t number, const std::string& error) {
    constexpr std::string_view kEncoding = "json";
    std::string head(1, kCallResponse);
    put(head, action, 4);
    put(head, number, 4);
    put(head, kEncoding.size(), 4);
    head += kEncoding;
    head += text_of({{"ok", error.empty()}, {"error", error}});
    return {.binary = true, .head = std::move(head), .body = nullptr};
}

}  // namespace

Hub::Hub(Channels& channels, const std::string& version, std::vector<Action> actions)
    : channels_(channels), actions_(std::move(actions)) {
    greeting_.push_back(text_of(server_info(version, !actions_.empty())));
    greeting_.push_back(text_of(advertise(channels_.all())));
    if (!actions_.empty()) {
        greeting_.push_back(text_of(advertise_services(actions_)));
    }
}

HubPeer::HubPeer(Hub& hub) : hub_(hub) {
    ++hub_.counters_.peers;
}

void HubPeer::take_text(std::string_view text) {
    if (text.size() > Hub::kIncomingMax) {
        give_up();
        return;
    }
    const nlohmann::json message = nlohmann::json::parse(text, nullptr, false);
    const auto op = message.is_object() ? message.find("op") : message.end();
    if (op == message.end() || !op->is_string()) {
        mistake("not a JSON object with an \"op\"");
    } else if (*op == "subscribe") {
        subscribe(message);
    } else if (*op == "unsubscribe") {
        unsubscribe(message);
    } else {
        mistake("op \"" + op->get<std::string>() + "\" is not offered here; see capabilities in serverInfo");
    }
}

void HubPeer::take_binary(std::string_view bytes) {
    constexpr std::size_t kHead = 13;  // opcode, action, number, length of the encoding's name
    if (bytes.size() > Hub::kIncomingMax) {
        give_up();
        return;
    }
    if (bytes.size() < kHead || bytes.front() != kCallRequest) {
        mistake("a binary message that is not a service call");
        return;
    }
    const std::uint32_t length = get_u32(bytes.substr(9));
    if (length > bytes.size() - kHead) {
        mistake("a service call that is cut short");
        return;
    }
    call(get_u32(bytes.substr(1)), get_u32(bytes.substr(5)), bytes.substr(kHead, length), bytes.substr(kHead + length));
}

std::optional<Outgoing> HubPeer::next() {
    if (greeted_ < hub_.greeting_.size()) {
        return Outgoing{.binary = false, .head = hub_.greeting_[greeted_++], .body = nullptr};
    }
    if (!outbox_->ready.empty()) {
        Outgoing answer = std::move(outbox_->ready.front());
        outbox_->ready.pop_front();
        return answer;
    }
    for (std::size_t i = 0; i < subscriptions_.size(); ++i) {
        turn_ = (turn_ + 1) % subscriptions_.size();
        Subscription& subscription = subscriptions_[turn_];
        if (std::shared_ptr<const Message> message = hub_.channels_.next(subscription.channel, subscription.cursor)) {
            ++hub_.counters_.messages;
            std::string head(1, kMessageData);
            put(head, subscription.id, 4);
            put(head, static_cast<std::uint64_t>(message->stamp_ns), 8);
            return Outgoing{.binary = true, .head = std::move(head), .body = std::move(message)};
        }
    }
    return std::nullopt;
}

void HubPeer::subscribe(const nlohmann::json& message) {
    const auto wishes = message.find("subscriptions");
    if (wishes == message.end() || !wishes->is_array()) {
        mistake("subscribe: \"subscriptions\" is not a list");
        return;
    }
    for (const nlohmann::json& wish : *wishes) {
        if (cut_off_) {
            return;
        }
        subscribe_one(wish);
    }
}

void HubPeer::subscribe_one(const nlohmann::json& wish) {
    const auto id = u32_of(wish, "id");
    const auto channel = u32_of(wish, "channelId");
    if (!id || !channel || *channel >= hub_.channels_.all().size()) {
        mistake(R"(subscribe: wants an "id" and the "channelId" of a channel that was advertised)");
    } else if (std::any_of(subscriptions_.begin(), subscriptions_.end(),
                           [&](const Subscription& other) { return other.id == *id; })) {
        mistake("subscribe: id " + std::to_string(*id) + " is in use");
    } else if (subscriptions_.size() >= kSubscriptionsMax) {
        mistake("subscribe: at most " + std::to_string(kSubscriptionsMax) + " subscriptions");
    } else {
        subscriptions_.push_back({.id = *id, .channel = *channel, .cursor = 0});
    }
}

void HubPeer::unsubscribe(const nlohmann::json& message) {
    const auto ids = message.find("subscriptionIds");
    if (ids == message.end() || !ids->is_array()) {
        mistake("unsubscribe: \"subscriptionIds\" is not a list");
        return;
    }
    for (const nlohmann::json& id : *ids) {
        if (cut_off_) {
            return;
        }
        const auto gone = std::remove_if(subscriptions_.begin(), subscriptions_.end(),
                                         [&](const Subscription& each) { return id == each.id; });
        if (gone == subscriptions_.end()) {
            mistake("unsubscribe: there is no such subscription");
        }
        subscriptions_.erase(gone, subscriptions_.end());
    }
}

void HubPeer::call(std::uint32_t action, std::uint32_t number, std::string_view encoding, std::string_view data) {
    const auto refuse = [&](const char* why) {
        mistake(std::string("service call: ") + why);
        post(text_message({{"op", "serviceCallFailure"}, {"serviceId", action}, {"callId", number}, {"message", why}}));
    };
    if (action >= hub_.actions_.size()) {
        refuse("there is no such service");
        return;
    }
    const nlohmann::json request = nlohmann::json::parse(data, nullptr, false);
    if (encoding != "json" || !request.is_object()) {
        refuse("the request is not a JSON object in encoding \"json\"");
        return;
    }
    if (outbox_->open_calls + outbox_->ready.size() >= kAnswersMax) {
        give_up();
        return;
    }
    ++hub_.counters_.calls;
    ++outbox_->open_calls;
    hub_.actions_[action].call(request,
                               [to = std::weak_ptr<Outbox>(outbox_), action, number](const std::string& error) {
                                   if (const std::shared_ptr<Outbox> outbox = to.lock()) {
                                       --outbox->open_calls;
                                       outbox->ready.push_back(call_response(action, number, error));
                                   }
                               });
}

void HubPeer::mistake(const std::string& what) {
    ++hub_.counters_.mistakes;
    if (++mistakes_ > kMistakesMax) {
        give_up();
        return;
    }
    post(text_message({{"op", "status"}, {"level", kStatusError}, {"message", what}}));
}

void HubPeer::post(Outgoing message) {
    if (outbox_->open_calls + outbox_->ready.size() >= 2 * kAnswersMax) {
        give_up();  // it asks and does not read
        return;
    }
    outbox_->ready.push_back(std::move(message));
}

void HubPeer::give_up() {
    if (!cut_off_) {
        cut_off_ = true;
        ++hub_.counters_.cut_off;
    }
}

}  // namespace crspf::view
