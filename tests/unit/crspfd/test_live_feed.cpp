// The other end of the watching: what comes over the socket, and what if it does not.
#include <sys/socket.h>

#include <catch2/catch.hpp>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "platform/crspfd/control_address.hpp"
#include "platform/crspfd/control_server.hpp"
#include "platform/crspfd/watch_board.hpp"
#include "platform/files/input_error.hpp"
#include "platform/files/unique_fd.hpp"
#include "platform/linux/monotonic_clock.hpp"
#include "tests/unit/crspfd/watched_map.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tools/view/live_feed.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

/// A service's control thread: its server and its board.
class Server {
 public:
    explicit Server(const std::filesystem::path& path)
        : server_(
              path, [](const ControlRequest&) { return error_line("nothing"); },
              [this](WatchCursor& cursor) { return board.next(cursor); }) {}
    void turn() {
        server_.serve(Duration{1'000'000});
        const bool was_watched = board.watched();
        board.watched(server_.watchers() > 0);
        if (board.watched() && !was_watched) {
            board.begin_map(0.02);
            TileCells cells;
            cells.fill(kOccupiedCell);
            board.take_tile({}, cells);
        }
    }

    WatchBoard board;

 private:
    ControlServer server_;
};

/// Of a live feed, while the other end turns.
class Follower {
 public:
    explicit Follower(const std::filesystem::path& path) : feed(path) {}
    bool until(const std::function<bool()>& done, const std::function<void()>& other_end) {
        const Stamp end = monotonic_now() + Duration{20'000'000'000};
        while (monotonic_now() < end) {
            other_end();
            std::vector<view::RunEvent> events;
            feed.turn(events);
            for (const view::RunEvent& event : events) {
                take(event);
            }
            if (done()) {
                return true;
            }
            sleep_until(monotonic_now() + Duration{2'000'000});
        }
        return false;
    }

    view::LiveFeed feed;
    WatchedMap map;
    std::vector<view::AwayEvent> away;
    std::vector<view::LogLine> log;

 private:
    void take(const view::RunEvent& event) {
        if (const auto* const tiles = std::get_if<view::TilesEvent>(&event)) {
            map.take(*tiles);
        } else if (const auto* const gone = std::get_if<view::AwayEvent>(&event)) {
            away.push_back(*gone);
        } else if (const auto* const line = std::get_if<view::LogLine>(&event)) {
            log.push_back(*line);
        }
    }
};

/// Somebody else at the socket, who says `text` to everybody and hangs up, or holds the line.
class Stranger {
 public:
    Stranger(const std::filesystem::path& path, std::string text, bool hangs_up)
        : text_(std::move(text)), hangs_up_(hangs_up) {
        const ControlAddress address(path);
        REQUIRE(::bind(listener_.get(), address.get(), ControlAddress::size()) == 0);
        REQUIRE(::listen(listener_.get(), 4) == 0);
    }
    void turn() {
        if (UniqueFd fd(::accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC)); fd.valid()) {
            peers_.push_back({.fd = std::move(fd), .said = 0});
        }
        for (Peer& peer : peers_) {
            const ssize_t sent =
                ::send(peer.fd.get(), text_.data() + peer.said, text_.size() - peer.said, MSG_NOSIGNAL);
            peer.said += sent > 0 ? static_cast<std::size_t>(sent) : 0;
            if (peer.said == text_.size() && hangs_up_) {
                peer.fd = UniqueFd();
            }
        }
    }

 private:
    struct Peer {
        UniqueFd fd;
        std::size_t said = 0;
    };
    std::string text_;
    bool hangs_up_;
    UniqueFd listener_{::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)};
    std::vector<Peer> peers_;
};

}  // namespace

TEST_CASE("live feed: a service that comes, goes and comes again is told of, and its map begins anew") {
    const Scratch scratch;
    const std::filesystem::path path = scratch / "control";
    Follower follower(path);
    REQUIRE(follower.until([&] { return !follower.away.empty(); }, [] {}));
    CHECK(follower.away.back().away);
    CHECK(follower.away.back().why.find("does crspfd run?") != std::string::npos);
    CHECK(follower.away.back().why.find(path.string()) == 0);
    CHECK(follower.feed.fd() == -1);
    for (std::size_t times = 1; times <= 2; ++times) {
        Server server(path);
        REQUIRE(follower.until([&] { return follower.map.beginnings == times && follower.map.size() == 1; },
                               [&] { server.turn(); }));
        CHECK(follower.feed.fd() >= 0);
        CHECK_FALSE(follower.away.back().away);
        server.board.take_log(0, WatchBoard::Level::kInfo, "map saved");
        REQUIRE(follower.until([&] { return follower.log.size() == times; }, [&] { server.turn(); }));
        CHECK(follower.away.size() == 2 * times);  // away, back
    }
    CHECK(follower.feed.counters().connections == 2);
    CHECK(follower.feed.counters().bad_lines == 0);
    // Why it is away is told once for each reason: it hung up, and then nobody listens.
    REQUIRE(follower.until([&] { return follower.away.size() == 6; }, [] {}));
    CHECK(follower.away[4].why.find("closed the connection") != std::string::npos);
    CHECK(follower.away[5].why.find("does crspfd run?") != std::string::npos);
}

TEST_CASE("live feed: one watcher too many is told so, and gets in when another goes") {
    const Scratch scratch;
    const std::filesystem::path path = scratch / "control";
    Server server(path);
    std::vector<std::unique_ptr<Follower>> others;
    for (std::size_t i = 0; i < ControlServer::kWatchersMax; ++i) {
        others.push_back(std::make_unique<Follower>(path));
        REQUIRE(others.back()->until([&] { return others.back()->map.size() == 1; }, [&] { server.turn(); }));
    }
    Follower late(path);
    REQUIRE(late.until([&] { return !late.away.empty(); }, [&] { server.turn(); }));
    CHECK(late.away.back().away);
    CHECK(late.away.back().why.find("8 watch already") != std::string::npos);
    others.pop_back();
    REQUIRE(late.until([&] { return late.map.size() == 1; }, [&] { server.turn(); }));
    CHECK_FALSE(late.away.back().away);
}

TEST_CASE("live feed: what is no line of crspfd's is counted, ends the connection, and is tried again") {
    const Scratch scratch;
    const std::filesystem::path path = scratch / "control";
    struct Case {
        std::string text;
        std::string why;
        bool hangs_up = false;
    };
    const Case it = GENERATE(values<Case>({
        {"HTTP/1.1 400 Bad Request\r\n", "is no JSON object"},
        {"{\"version\":1,\"ok\":true,\"result\":{}}\n"
         "{\"version\":1,\"event\":\"tiles\",\"fresh\":false,\"resolution_m\":0.02,\"tiles\":[]}\n",
         "of a map that has not begun"},
        {"{\"version\":2,\"ok\":true}\n", "of one release"},
        {"{\"version\":1,\"event\":\"gossip\"}\n", "event: is missing or wrong"},
        {std::string(view::kWatchLineMax + 65536, '['), "too long"},
        {std::string(1000, '[') + "\n", "is no JSON object"},
        {"", "closed the connection", true},
    }));
    Stranger stranger(path, it.text, it.hangs_up);
    Follower follower(path);
    const auto told = [&] {
        return !follower.away.empty() && follower.away.back().why.find(it.why) != std::string::npos &&
               (it.hangs_up || follower.feed.counters().bad_lines >= 2);
    };
    CHECK(follower.until(told, [&] { stranger.turn(); }));
    CHECK(follower.map.beginnings == 0);
}

TEST_CASE("live feed: a path that no socket can have is said at once") {
    CHECK_THROWS_AS(view::LiveFeed("/" + std::string(200, 'x')), InputError);
}
