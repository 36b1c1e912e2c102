// The view's server: the page's files and /metrics over HTTP, the hub's peers over WebSocket; on libwebsockets, in the
// caller's thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "core/base/time.hpp"
#include "tools/view/access.hpp"
#include "tools/view/hub.hpp"

namespace crspf::view {

struct WebServerOptions {
    std::string listen = "127.0.0.1";
    std::uint16_t port = 8765;  ///< 0: any that is free
    std::string token;          ///< empty: none, and one is made where others than this machine can connect
    std::vector<std::string> allowed_origins;
};

struct WebCounters {
    std::uint64_t requests = 0;   ///< of HTTP
    std::uint64_t refused = 0;    ///< for its host, origin or token
    std::uint64_t full = 0;       ///< refused since there are as many as there may be
    std::size_t peers = 0;        ///< of the WebSocket, now
    std::size_t connections = 0;  ///< of TCP, now
};

class WebServer {
 public:
    static constexpr std::size_t kPeersMax = 32;
    static constexpr std::size_t kConnectionsMax = 96;

    /// @param hub outlives the server
    /// @param metrics what /metrics is to answer
    /// @throws InputError: the address cannot be had
    WebServer(WebServerOptions options, Hub& hub, std::function<std::string()> metrics);
    WebServer(const WebServer&) = delete;
    WebServer& operator=(const WebServer&) = delete;
    ~WebServer();

    /// Serves for so long, at least once. To be called again and again; each call asks the hub what there is for the
    /// peers.
    void serve(Duration time);

    [[nodiscard]] std::uint16_t port() const;
    [[nodiscard]] const AccessRules& rules() const;
    [[nodiscard]] const WebCounters& counters() const;

 private:
    struct State;
    friend struct WebCallbacks;
    std::unique_ptr<State> state_;
};

}  // namespace crspf::view
