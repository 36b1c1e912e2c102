// The other end of the view's server: raw bytes on a socket, and only as fast as the test asks. One thread: the server
// is served in between.
#pragma once

#include <arpa/inet.h>
#include <sys/socket.h>

#include <catch2/catch.hpp>
#include <cerrno>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "platform/files/unique_fd.hpp"
#include "tools/view/web_server.hpp"

namespace crspf::test {

/// Turns of the server until something is so; a bound on turns, not on time, that only a server that hangs can reach.
inline bool serve_until(view::WebServer& server, const std::function<bool()>& so) {
    constexpr int kTurns = 20'000;
    for (int i = 0; i < kTurns && !so(); ++i) {
        server.serve({500'000});
    }
    return so();
}

class WebClient {
 public:
    /// @param receive_buffer [bytes] of the kernel; 0: as it likes
    explicit WebClient(view::WebServer& server, int receive_buffer = 0)
        : server_(server), fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
        if (receive_buffer > 0) {
            REQUIRE(::setsockopt(fd_.get(), SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer) == 0);
        }
        sockaddr_in to{};
        to.sin_family = AF_INET;
        to.sin_port = htons(server.port());
        to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): the sockets' own way
        REQUIRE(::connect(fd_.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0);
    }

    void send(std::string_view bytes) {
        REQUIRE(::send(fd_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size()));
    }
    /// Takes what has come. False: the other end has closed.
    bool receive() {
        std::string buffer(std::size_t{64} * 1024, '\0');
        for (;;) {
            const ssize_t got = ::recv(fd_.get(), buffer.data(), buffer.size(), MSG_DONTWAIT);
            if (got <= 0) {
                return got < 0 && (errno == EAGAIN || errno == EINTR);
            }
            received.append(buffer, 0, static_cast<std::size_t>(got));
        }
    }

    /// A request of HTTP/1.1 and its whole answer. @param lines further header lines, each with its end
    std::string ask(const std::string& first_line, const std::string& host, const std::string& lines = "") {
        send(first_line + " HTTP/1.1\r\nHost: " + host + "\r\n" + lines + "Connection: close\r\n\r\n");
        REQUIRE(serve_until(server_, [this] { return !receive(); }));
        return received;
    }
    std::string get(const std::string& path, const std::string& lines = "") {
        return ask("GET " + path, "127.0.0.1:" + std::to_string(server_.port()), lines);
    }

    /// Asks for a WebSocket. @return the status line and headers of the answer; empty: closed without one
    std::string upgrade(const std::string& path = "/", const std::string& lines = "",
                        const std::string& protocol = view::Hub::kProtocol) {
        send("GET " + path + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(server_.port()) +
             "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
             "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: " +
             protocol + "\r\n" + lines + "\r\n");
        bool open = true;
        REQUIRE(serve_until(server_, [&] {
            open = receive() && open;
            return !open || received.find("\r\n\r\n") != std::string::npos;
        }));
        const std::size_t end = std::min(received.find("\r\n\r\n"), received.size());
        std::string head = received.substr(0, end);
        received.erase(0, std::min(end + 4, received.size()));
        return head;
    }

    /// Small messages only. A mask of zeros is one, too.
    void send_frame(char opcode, const std::string& payload) {
        REQUIRE(payload.size() < 65536);
        std::string frame(1, static_cast<char>(0x80 | opcode));
        if (payload.size() < 126) {
            frame += static_cast<char>(0x80 | static_cast<int>(payload.size()));
        } else {
            frame += static_cast<char>(0xFE);
            frame += static_cast<char>(payload.size() >> 8U);
            frame += static_cast<char>(payload.size() & 0xFFU);
        }
        send(frame + std::string(4, '\0') + payload);
    }
    void send_text(const std::string& text) { send_frame(1, text); }

    struct Frame {
        bool last = false;
        int opcode = 0;
        std::string payload;
    };
    /// The next frame of what has been received, where it is whole.
    std::optional<Frame> take_frame() {
        const auto byte = [this](std::size_t at) { return static_cast<std::uint8_t>(received[at]); };
        if (received.size() < 2) {
            return std::nullopt;
        }
        std::size_t head = 2;
        std::size_t length = byte(1) & 0x7FU;
        const std::size_t more = length == 126 ? 2 : length == 127 ? 8 : 0;
        if (received.size() < head + more) {
            return std::nullopt;
        }
        if (more > 0) {
            length = 0;
            for (std::size_t i = 0; i < more; ++i) {
                length = (length << 8U) | byte(head + i);
            }
            head += more;
        }
        if (received.size() < head + length) {
            return std::nullopt;
        }
        Frame frame{.last = (byte(0) & 0x80U) != 0, .opcode = byte(0) & 0x0F, .payload = received.substr(head, length)};
        received.erase(0, head + length);
        return frame;
    }
    /// The next message, its frames put together; none: the server has closed.
    std::optional<Frame> next_message() {
        Frame message;
        bool open = true;
        bool whole = false;
        REQUIRE(serve_until(server_, [&] {
            open = open && receive();
            while (!whole) {
                const auto frame = take_frame();
                if (!frame) {
                    break;
                }
                if (frame->opcode == 8) {
                    open = false;
                    break;
                }
                if (frame->opcode == 9) {  // whether we live, when a test takes its time
                    send_frame(10, frame->payload);
                    continue;
                }
                message.opcode = frame->opcode != 0 ? frame->opcode : message.opcode;
                message.payload += frame->payload;
                whole = frame->last;
            }
            return whole || !open;
        }));
        return whole ? std::optional(message) : std::nullopt;
    }

    std::string received;

 private:
    view::WebServer& server_;
    UniqueFd fd_;
};

}  // namespace crspf::test
