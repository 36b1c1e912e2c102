// The connection to a broker, by libmosquitto: MQTT 3.1.1, over TCP or TLS.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "core/base/time.hpp"
#include "tools/mqtt/broker_address.hpp"
#include "tools/mqtt/publication.hpp"

struct mosquitto;

namespace crspf::mqtt {

struct BrokerOptions {
    BrokerAddress address;
    std::string client_id;
    std::string user;  ///< empty: none is told
    std::string password;
    bool tls = false;
    std::string ca;    ///< file; empty: the certificates that this machine trusts
    std::string cert;  ///< file; empty: none is shown
    std::string key;   ///< file
    Publication will;  ///< said by the broker when it misses us
};

/// Connects again and again; each time with a client of its own, so that nothing that was on its way before comes late.
/// One owner; turn() may wait for the resolver beyond its time.
class BrokerLink {
 public:
    /// Messages that the library has, and the broker has not confirmed, or the socket not taken.
    static constexpr int kOnTheWayMax = 8;
    static constexpr Duration kKeepAlive{15'000'000'000};
    static constexpr Duration kAnswerMax{10'000'000'000};  ///< from the connecting to the broker's consent
    static constexpr Duration kRetryMin{1'000'000'000};
    static constexpr Duration kRetryMax{30'000'000'000};
    static constexpr Duration kStable{10'000'000'000};  ///< a connection that lasted is tried again soon

    /// @param say gets a line when a connection is there, and when it is not, each reason once, with the remedy
    /// Throws InputError where a file for TLS cannot be used.
    BrokerLink(BrokerOptions options, std::function<void(const std::string&)> say);
    BrokerLink(const BrokerLink&) = delete;
    BrokerLink& operator=(const BrokerLink&) = delete;
    ~BrokerLink();

    /// Sends, receives, connects where it is time. Waits so long for something to do.
    void turn(Duration wait);

    /// That were granted. One more: another connection.
    [[nodiscard]] std::uint64_t connections() const { return connections_; }
    /// It is connected, and has room. What is published all the same stays in memory until the broker takes it.
    [[nodiscard]] bool takes() const { return connected_ && on_the_way_ < kOnTheWayMax; }
    void publish(const Publication& publication);

    /// A clean end: the last message, and no will. Waits so long for the broker.
    void end(const Publication& last, Duration wait);

 private:
    struct Calls;  ///< the library's
    struct Forget {
        void operator()(mosquitto* client) const;
    };

    void connect(Stamp now);
    void set_up_tls();
    void lose(Stamp now, const std::string& why);
    [[nodiscard]] std::string doubt_of_certificate() const;
    [[nodiscard]] std::string why_of(int error, int system_error) const;

    BrokerOptions options_;
    std::function<void(const std::string&)> say_;
    std::unique_ptr<mosquitto, Forget> client_;  ///< null: there is no connection, nor one on its way
    bool connected_ = false;
    int refusal_ = 0;        ///< the broker's code
    std::string complaint_;  ///< of the library, since the connecting
    int on_the_way_ = 0;
    std::uint64_t connections_ = 0;
    Stamp tried_;
    Stamp connected_at_;
    Duration retry_{};  ///< from the last loss to the next attempt
    Stamp lost_at_;
    std::string said_;
};

}  // namespace crspf::mqtt
