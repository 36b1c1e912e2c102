#include "tools/view/web_server.hpp"

#include <fcntl.h>
#include <libwebsockets.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <stdexcept>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "tools/view/listening_socket.hpp"
#include "tools/view/page_files.hpp"
#include "tools/view/web_connection.hpp"
#include "tools/view/web_request.hpp"

namespace crspf::view {
namespace {

void say(int /*level*/, const char* line) {
    std::fprintf(stderr, "crspf: warning: web server: %s", line);
}

/// Nothing but what the server itself has, no frame around it, and no URL, which may hold the token, told to anybody.
constexpr std::array<std::pair<const char*, std::string_view>, 5> kHeaders{{
    {"content-security-policy:",
     "default-src 'self'; connect-src 'self' ws:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
    {"x-content-type-options:", "nosniff"},
    {"referrer-policy:", "no-referrer"},
    {"cross-origin-resource-policy:", "same-origin"},
    {"cache-control:", "no-cache"},
}};

const std::uint8_t* bytes_of(std::string_view text) {
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): text as bytes, as the library wants it
    return reinterpret_cast<const std::uint8_t*>(text.data());
}

}  // namespace

struct WebServer::State {
    State(WebServerOptions options, Hub& the_hub, std::function<std::string()> the_metrics)
        : hub(the_hub), metrics(std::move(the_metrics)), listening(listen_at(options.listen, options.port)) {
        rules.loopback = listening.loopback;
        rules.token = std::move(options.token);
        rules.allowed_origins = std::move(options.allowed_origins);
        if (!rules.loopback && rules.token.empty()) {
            rules.token = make_token();
        }
    }
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() {
        if (context != nullptr) {
            lws_context_destroy(context);  // ends all connections, which calls back
        }
    }

    /// Sends an answer's head, and has its body sent when the socket has room. @return what the callback is to return
    int answer(lws* wsi, unsigned status, std::string_view type, Answer body);
    int answer_http(lws* wsi, std::string_view path);
    int send_http(lws* wsi);
    int confirm_upgrade(lws* wsi, std::string_view to);
    int begin_peer(lws* wsi);
    int receive(lws* wsi, std::string_view piece);
    int send_message(lws* wsi);
    int accept_connections();
    int forget(lws* wsi);
    void open();

    struct Timer {
        lws_sorted_usec_list_t entry{};  // the first member: the library hands it back
        lws_context* context = nullptr;
        bool rung = false;
    };
    /// The library may ring before it begins to wait, and then wait for the timer after this one: so there is always
    /// one at hand.
    static void ring(lws_sorted_usec_list_t* entry) {
        // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): a struct at the place of its first member
        auto* const timer = reinterpret_cast<Timer*>(entry);
        timer->rung = true;
        lws_sul_schedule(timer->context, 0, entry, ring, 1);
    }

    Hub& hub;
    std::function<std::string()> metrics;
    ListeningSocket listening;
    AccessRules rules;
    WebCounters counters;
    SendBuffer buffer;
    std::unordered_set<lws*> connections;
    std::unordered_map<lws*, Answer> answers;
    std::unordered_map<lws*, std::unique_ptr<PeerSession>> peers;
    Timer timer;
    std::array<lws_protocols, 4> protocols{};
    lws_context* context = nullptr;
    lws_vhost* vhost = nullptr;
};

int WebServer::State::answer(lws* wsi, unsigned status, std::string_view type, Answer body) {
    std::uint8_t* at = buffer.begin();
    std::uint8_t* const end = buffer.end();
    if (body.body.data() == nullptr) {
        body.body = body.made;
    }
    bool fits = lws_add_http_common_headers(wsi, status, std::string(type).c_str(), body.body.size(), &at, end) == 0;
    for (const auto& [name, value] : kHeaders) {
        fits = fits && lws_add_http_header_by_name(wsi, bytes_of(name), bytes_of(value), static_cast<int>(value.size()),
                                                   &at, end) == 0;
    }
    if (!fits || lws_finalize_write_http_header(wsi, buffer.begin(), &at, end) != 0) {
        return -1;
    }
    if (body.body.empty() || lws_hdr_total_length(wsi, WSI_TOKEN_HEAD_URI) > 0) {
        return lws_http_transaction_completed(wsi) != 0 ? -1 : 0;
    }
    Answer& kept = answers[wsi] = std::move(body);
    if (!kept.made.empty()) {
        kept.body = kept.made;  // a short text moves with its string
    }
    lws_callback_on_writable(wsi);
    return 0;
}

int WebServer::State::answer_http(lws* wsi, std::string_view path) {
    constexpr std::string_view kText = "text/plain; charset=utf-8";
    ++counters.requests;
    if (lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) <= 0 && lws_hdr_total_length(wsi, WSI_TOKEN_HEAD_URI) <= 0) {
        return answer(wsi, HTTP_STATUS_METHOD_NOT_ALLOWED, kText, {.made = "Only GET and HEAD.\n", .body = {}});
    }
    const bool wants_metrics = path == "/metrics";
    const Request request = request_of(wsi);
    const Access access = wants_metrics ? may_see_data(rules, request) : may_see_page(rules, request);
    if (access != Access::kGranted) {
        ++counters.refused;
        return answer(wsi, status_of(access), kText, {.made = reason_of(access), .body = {}});
    }
    if (wants_metrics) {
        return answer(wsi, HTTP_STATUS_OK, "text/plain; version=0.0.4; charset=utf-8", {.made = metrics(), .body = {}});
    }
    for (const PageFile& file : page_files()) {
        if (file.path == path) {
            return answer(wsi, HTTP_STATUS_OK, file.content_type, {.made = {}, .body = file.content});
        }
    }
    return answer(wsi, HTTP_STATUS_NOT_FOUND, kText, {.made = "There is no such page; / is the view.\n", .body = {}});
}

int WebServer::State::send_http(lws* wsi) {
    const auto found = answers.find(wsi);
    if (found == answers.end()) {
        return 0;
    }
    Answer& answer = found->second;
    const std::size_t n = buffer.fill(answer.body, answer.sent);
    answer.sent += n;
    const bool last = answer.sent == answer.body.size();
    if (lws_write(wsi, buffer.begin(), n, last ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP) < 0) {
        return -1;
    }
    if (!last) {
        lws_callback_on_writable(wsi);
        return 0;
    }
    answers.erase(found);
    return lws_http_transaction_completed(wsi) != 0 ? -1 : 0;
}

/// 0: it may become a WebSocket; 1: it has been answered and may not.
int WebServer::State::confirm_upgrade(lws* wsi, std::string_view to) {
    const Access access = may_see_data(rules, request_of(wsi));
    unsigned status = status_of(access);
    std::string reason = reason_of(access);
    if (access == Access::kGranted && to != "websocket") {
        status = HTTP_STATUS_BAD_REQUEST;
        reason = "Only a WebSocket is offered here.\n";
    } else if (access == Access::kGranted && peers.size() >= kPeersMax) {
        ++counters.full;
        status = HTTP_STATUS_SERVICE_UNAVAILABLE;
        reason = "There are as many viewers as there may be.\n";
    } else if (access == Access::kGranted) {
        return 0;
    } else {
        ++counters.refused;
    }
    lws_return_http_status(wsi, status, reason.c_str());
    return 1;
}

int WebServer::State::receive(lws* wsi, std::string_view piece) {
    const auto found = peers.find(wsi);
    if (found == peers.end()) {
        return -1;
    }
    PeerSession& session = *found->second;
    // Beyond the bound the hub sees that it is too much; more is not kept.
    session.incoming +=
        piece.substr(0, Hub::kIncomingMax + 1 - std::min(session.incoming.size(), Hub::kIncomingMax + 1));
    const bool whole = lws_is_final_fragment(wsi) != 0 && lws_remaining_packet_payload(wsi) == 0;
    if (whole || session.incoming.size() > Hub::kIncomingMax) {
        if (lws_frame_is_binary(wsi) != 0) {
            session.peer.take_binary(session.incoming);
        } else {
            session.peer.take_text(session.incoming);
        }
        session.incoming = {};
        lws_callback_on_writable(wsi);
    }
    return 0;
}

int WebServer::State::send_message(lws* wsi) {
    const auto found = peers.find(wsi);
    if (found == peers.end()) {
        return -1;
    }
    PeerSession& session = *found->second;
    if (session.peer.cut_off()) {
        std::array<std::uint8_t, 1> none{};
        lws_close_reason(wsi, LWS_CLOSE_STATUS_POLICY_VIOLATION, none.data(), 0);
        return -1;
    }
    if (!session.outgoing) {
        session.outgoing = session.peer.next();
        session.sent = 0;
        if (!session.outgoing) {
            return 0;
        }
    }
    const std::size_t n = buffer.fill(*session.outgoing, session.sent);
    const bool first = session.sent == 0;
    session.sent += n;
    const bool last = session.sent == session.outgoing->size();
    const int kind =
        lws_write_ws_flags(session.outgoing->binary ? LWS_WRITE_BINARY : LWS_WRITE_TEXT, first ? 1 : 0, last ? 1 : 0);
    if (lws_write(wsi, buffer.begin(), n, static_cast<lws_write_protocol>(kind)) < 0) {
        return -1;
    }
    if (last) {
        session.outgoing.reset();
    }
    lws_callback_on_writable(wsi);
    return 0;
}

int WebServer::State::accept_connections() {
    for (UniqueFd fd = accept_one(listening.fd.get()); fd.valid(); fd = accept_one(listening.fd.get())) {
        if (connections.size() >= kConnectionsMax) {
            ++counters.full;
        } else if (lws* const wsi = lws_adopt_socket_vhost(vhost, fd.release());
                   wsi != nullptr) {  // closes it where it fails
            connections.insert(wsi);
        }
    }
    return 0;
}

int WebServer::State::begin_peer(lws* wsi) {
    answers.erase(wsi);
    peers[wsi] = std::make_unique<PeerSession>(hub);
    lws_callback_on_writable(wsi);
    return 0;
}

int WebServer::State::forget(lws* wsi) {
    answers.erase(wsi);
    peers.erase(wsi);
    connections.erase(wsi);
    return 0;
}

/// What libwebsockets calls, by the state that its context knows. Nothing may be thrown through it.
struct WebCallbacks {
    using State = WebServer::State;

    static State& state_of(lws* wsi) { return *static_cast<State*>(lws_context_user(lws_get_context(wsi))); }

    static std::string_view text_of(const void* in, std::size_t length) {
        return in == nullptr ? std::string_view() : std::string_view(static_cast<const char*>(in), length);
    }

    /// An error of ours costs the connection that it was met on.
    template <class Work>
    static int guarded(const Work& work) {
        try {
            return work();
        } catch (const std::exception& e) {
            std::fprintf(stderr, "crspf: warning: web server: %s\n", e.what());
            return -1;
        }
    }

    static int http(lws* wsi, lws_callback_reasons reason, void* user, void* in, std::size_t length) {
        State& state = state_of(wsi);
        switch (reason) {
            case LWS_CALLBACK_HTTP: return guarded([&] { return state.answer_http(wsi, text_of(in, length)); });
            case LWS_CALLBACK_HTTP_WRITEABLE: return guarded([&] { return state.send_http(wsi); });
            case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE:
                return guarded([&] { return state.confirm_upgrade(wsi, static_cast<const char*>(in)); });
            case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION: return -1;  // a WebSocket of no protocol that we know
            case LWS_CALLBACK_WSI_DESTROY: return guarded([&] { return state.forget(wsi); });
            default: return lws_callback_http_dummy(wsi, reason, user, in, length);
        }
    }

    static int websocket(lws* wsi, lws_callback_reasons reason, void* /*user*/, void* in, std::size_t length) {
        State& state = state_of(wsi);
        switch (reason) {
            case LWS_CALLBACK_ESTABLISHED: return guarded([&] { return state.begin_peer(wsi); });
            case LWS_CALLBACK_RECEIVE: return guarded([&] { return state.receive(wsi, text_of(in, length)); });
            case LWS_CALLBACK_SERVER_WRITEABLE: return guarded([&] { return state.send_message(wsi); });
            default: return 0;
        }
    }

    static int accept(lws* wsi, lws_callback_reasons reason, void* /*user*/, void* /*in*/, std::size_t /*length*/) {
        if (reason == LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION) {
            return -1;  // a WebSocket that calls itself by this name
        }
        return reason == LWS_CALLBACK_RAW_RX_FILE ? guarded([&] { return state_of(wsi).accept_connections(); }) : 0;
    }
};

void WebServer::State::open() {
    static const lws_retry_bo_t liveness = [] {  // a tablet that went out of reach says nothing more
        lws_retry_bo_t policy{};
        policy.secs_since_valid_ping = 10;
        policy.secs_since_valid_hangup = 30;
        return policy;
    }();
    lws_set_log_level(LLL_ERR, say);
    protocols[0].name = "http";
    protocols[0].callback = WebCallbacks::http;
    protocols[1].name = Hub::kProtocol;
    protocols[1].callback = WebCallbacks::websocket;
    protocols[2].name = "accept";
    protocols[2].callback = WebCallbacks::accept;
    lws_context_creation_info info{};
    info.port = CONTEXT_PORT_NO_LISTEN_SERVER;
    info.protocols = protocols.data();
    info.user = this;
    info.options = LWS_SERVER_OPTION_EXPLICIT_VHOSTS | LWS_SERVER_OPTION_VALIDATE_UTF8;
    info.server_string = "crspf";
    info.fd_limit_per_thread = kConnectionsMax + 16;  // its own among them
    info.retry_and_idle_policy = &liveness;
    context = lws_create_context(&info);
    vhost = context == nullptr ? nullptr : lws_create_vhost(context, &info);
    lws_sock_file_fd_type listener{};
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-union-access): the library declares it so
    listener.filefd =
        vhost == nullptr ? -1 : ::fcntl(listening.fd.get(), F_DUPFD_CLOEXEC, 0);  // it closes what it is given
    if (vhost == nullptr ||
        lws_adopt_descriptor_vhost(vhost, LWS_ADOPT_RAW_FILE_DESC, listener, "accept", nullptr) == nullptr) {
        throw std::runtime_error("libwebsockets could not be set up");
    }
}

WebServer::WebServer(WebServerOptions options, Hub& hub, std::function<std::string()> metrics)
    : state_(std::make_unique<State>(std::move(options), hub, std::move(metrics))) {
    state_->open();
}

WebServer::~WebServer() = default;

void WebServer::serve(Duration time) {
    State& state = *state_;
    for (const auto& [wsi, session] : state.peers) {
        lws_callback_on_writable(wsi);
    }
    state.timer.context = state.context;
    state.timer.rung = false;
    const lws_usec_t end_us = lws_now_usecs() + time.ns / 1000;
    lws_sul_schedule(state.context, 0, &state.timer.entry, State::ring, time.ns / 1000);
    do {
        if (lws_service(state.context, 0) < 0) {
            throw std::runtime_error("libwebsockets gave up");
        }
        // It waits whole milliseconds: the part of one that is left it would spend asking again and again.
    } while (!state.timer.rung && lws_now_usecs() + 1000 < end_us);
}

std::uint16_t WebServer::port() const {
    return state_->listening.port;
}

const AccessRules& WebServer::rules() const {
    return state_->rules;
}

const WebCounters& WebServer::counters() const {
    state_->counters.peers = state_->peers.size();
    state_->counters.connections = state_->connections.size();
    return state_->counters;
}

}  // namespace crspf::view
