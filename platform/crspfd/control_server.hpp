// The service's end of the control socket.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/time.hpp"
#include "platform/crspfd/control_protocol.hpp"
#include "platform/crspfd/watch_cursor.hpp"
#include "platform/files/unique_fd.hpp"

namespace crspf {

/// Never reset.
struct ControlCounters {
    std::uint64_t requests = 0;
    std::uint64_t bad_requests = 0;  ///< answered with an error
    std::uint64_t cut_off = 0;       ///< peers that sent too much, or did not read
    std::uint64_t refused = 0;       ///< peers beyond kPeersMax, and watchers beyond kWatchersMax
};

/// One thread's. No peer can hold it up: what a peer does not read is dropped with it. Of one that watches nothing is
/// kept but his cursor and one line.
class ControlServer {
 public:
    static constexpr std::size_t kPeersMax = 16;
    static constexpr std::size_t kWatchersMax = 8;  ///< the other places are for those who ask
    /// @return the answer, a line
    using Handler = std::function<std::string(const ControlRequest&)>;
    /// @return the line that a watcher is to be sent next; empty: there is none now
    using NextLine = std::function<std::string(WatchCursor&)>;

    /// Listens at `path`, for owner and group. Throws InputError: no such directory; another service lives there.
    /// @param next without it nobody can watch
    ControlServer(std::filesystem::path path, Handler handler, NextLine next = {});
    ControlServer(const ControlServer&) = delete;
    ControlServer& operator=(const ControlServer&) = delete;
    ~ControlServer();

    /// Sends watchers what is new. Answers what has come; waits for it at most `wait`.
    void serve(Duration wait);
    [[nodiscard]] std::size_t watchers() const;

    [[nodiscard]] const ControlCounters& counters() const { return counters_; }

 private:
    struct Peer {
        UniqueFd fd;
        std::string received;
        std::string to_send;
        std::optional<WatchCursor> watch;
    };

    void accept_all();
    /// False: the peer has gone or is cut off.
    bool read_from(Peer& peer);
    bool write_to(Peer& peer);
    void answer(Peer& peer, std::string_view line);
    std::string begin_watch(Peer& peer);
    /// False: the peer has gone.
    bool send_news(Peer& peer);

    std::filesystem::path path_;
    Handler handler_;
    NextLine next_;
    UniqueFd listener_;
    std::deque<Peer> peers_;
    ControlCounters counters_;
};

}  // namespace crspf
