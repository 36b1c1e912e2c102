// What the running service says, from its control socket.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/time.hpp"
#include "platform/files/unique_fd.hpp"
#include "tools/view/run_events.hpp"

namespace crspf::view {

/// Never reset.
struct LiveFeedCounters {
    std::uint64_t connections = 0;  ///< that were granted
    std::uint64_t lines = 0;
    std::uint64_t bad_lines = 0;  ///< each ended its connection
};

/// Connects again and again. A connection begins with an AwayEvent that is over, and its map with a fresh TilesEvent;
/// it ends, or does not come about, with an AwayEvent that says why, once for each reason. Nothing blocks, nothing
/// throws but the constructor.
class LiveFeed {
 public:
    static constexpr Duration kRetry{500'000'000};
    static constexpr Duration kSilenceMax{5'000'000'000};  ///< the service says its status twice a second

    /// @param socket [service] control_socket. Throws InputError where that can be no socket's path.
    explicit LiveFeed(std::filesystem::path socket);

    /// To be polled for POLLIN; -1: there is no connection.
    [[nodiscard]] int fd() const { return fd_.get(); }
    /// Takes what has come and appends it to `out`. To be called when fd() is readable, and at least each kRetry.
    void turn(std::vector<RunEvent>& out);

    [[nodiscard]] const LiveFeedCounters& counters() const { return counters_; }

 private:
    void connect(Stamp now, std::vector<RunEvent>& out);
    void read(Stamp now, std::vector<RunEvent>& out);
    /// False: the connection has ended.
    bool take_line(std::string_view line, std::vector<RunEvent>& out);
    void close(const std::string& why, std::vector<RunEvent>& out);

    std::filesystem::path socket_;
    UniqueFd fd_;
    std::string received_;  ///< the beginning of a line
    Stamp tried_;           ///< to connect; the beginning of time: never
    Stamp heard_;
    bool map_begun_ = false;
    bool away_told_ = false;
    std::string why_away_;
    LiveFeedCounters counters_;
};

}  // namespace crspf::view
