// The service's end of the control socket.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <string>

#include "core/base/time.hpp"
#include "platform/crspfd/control_protocol.hpp"
#include "platform/files/unique_fd.hpp"

namespace crspf {

/// Never reset.
struct ControlCounters {
    std::uint64_t requests = 0;
    std::uint64_t bad_requests = 0;  ///< answered with an error
    std::uint64_t cut_off = 0;       ///< peers that sent too much, or did not read
    std::uint64_t refused = 0;       ///< peers beyond kPeersMax
};

/// One thread's. No peer can hold it up: what a peer does not read is dropped with it.
class ControlServer {
 public:
    static constexpr std::size_t kPeersMax = 16;
    /// @return the answer, a line
    using Handler = std::function<std::string(const ControlRequest&)>;

    /// Listens at `path`, for owner and group. Throws InputError: no such directory; another service lives there.
    ControlServer(std::filesystem::path path, Handler handler);
    ControlServer(const ControlServer&) = delete;
    ControlServer& operator=(const ControlServer&) = delete;
    ~ControlServer();

    /// Answers what has come; waits for it at most `wait`.
    void serve(Duration wait);

    [[nodiscard]] const ControlCounters& counters() const { return counters_; }

 private:
    struct Peer {
        UniqueFd fd;
        std::string received;
        std::string to_send;
    };

    void accept_all();
    /// False: the peer has gone or is cut off.
    bool read_from(Peer& peer);
    bool write_to(Peer& peer);
    void answer(Peer& peer, std::string_view line);

    std::filesystem::path path_;
    Handler handler_;
    UniqueFd listener_;
    std::deque<Peer> peers_;
    ControlCounters counters_;
};

}  // namespace crspf
