#include "tools/mqtt/broker_link.hpp"

#include <mosquitto.h>

#include <algorithm>
#include <cerrno>
#include <new>
#include <system_error>
#include <utility>

#include "platform/files/input_error.hpp"
#include "platform/linux/monotonic_clock.hpp"

namespace crspf::mqtt {
namespace {

constexpr const char* kTrustedHere = "/etc/ssl/certs";  // Debian's ca-certificates
constexpr Duration kNoTime{};

int milliseconds(Duration wait) {
    return static_cast<int>(wait.ns / 1'000'000);
}

bool holds(const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
}

/// What the library says of files that it cannot use.
bool is_of_files(const std::string& complaint) {
    return holds(complaint, "Unable to load") || holds(complaint, "keyfile") || holds(complaint, "key file");
}

}  // namespace

struct BrokerLink::Calls {
    static void on_connect(mosquitto* /*client*/, void* link, int refusal) {
        auto& self = *static_cast<BrokerLink*>(link);
        self.refusal_ = refusal;
        if (refusal == 0) {
            self.connected_ = true;
            self.connected_at_ = monotonic_now();
            ++self.connections_;
            self.said_.clear();
            self.say_(text_of(self.options_.address) + ": connected");
        }
    }
    static void on_publish(mosquitto* /*client*/, void* link, int /*message*/) {
        --static_cast<BrokerLink*>(link)->on_the_way_;
    }
    static void on_log(mosquitto* /*client*/, void* link, int level, const char* text) {
        if ((static_cast<unsigned>(level) & (MOSQ_LOG_ERR | MOSQ_LOG_WARNING)) != 0) {
            std::string& complaint = static_cast<BrokerLink*>(link)->complaint_;
            constexpr std::size_t kEnough = 500;
            if (complaint.size() < kEnough) {
                complaint += (complaint.empty() ? "" : "; ") + std::string(text);
            }
        }
    }
    /// A key with a passphrase: nobody is there to type it.
    static int no_passphrase(char* /*buffer*/, int /*size*/, int /*writing*/, void* /*client*/) { return 0; }
};

void BrokerLink::Forget::operator()(mosquitto* client) const {
    ::mosquitto_destroy(client);
}

BrokerLink::BrokerLink(BrokerOptions options, std::function<void(const std::string&)> say)
    : options_(std::move(options)), say_(std::move(say)) {
    ::mosquitto_lib_init();
    try {
        connect(monotonic_now());
    } catch (...) {
        client_.reset();
        ::mosquitto_lib_cleanup();
        throw;
    }
}

BrokerLink::~BrokerLink() {
    client_.reset();
    ::mosquitto_lib_cleanup();
}

void BrokerLink::set_up_tls() {
    const auto or_null = [](const std::string& file) { return file.empty() ? nullptr : file.c_str(); };
    const int error =
        ::mosquitto_tls_set(client_.get(), or_null(options_.ca), options_.ca.empty() ? kTrustedHere : nullptr,
                            or_null(options_.cert), or_null(options_.key), Calls::no_passphrase);
    if (error != MOSQ_ERR_SUCCESS) {
        throw InputError("--ca " + options_.ca + ", --cert " + options_.cert + ", --key " + options_.key +
                         ": cannot be read; check the paths and their permissions");
    }
}

void BrokerLink::connect(Stamp now) {
    tried_ = now;
    refusal_ = on_the_way_ = 0;
    complaint_.clear();
    errno = 0;
    client_.reset(::mosquitto_new(options_.client_id.c_str(), true, this));
    if (client_ == nullptr && errno != ENOMEM) {
        throw InputError("--prefix, --robot: \"" + options_.client_id + "\" is no UTF-8; give other names");
    }
    if (client_ == nullptr) {
        throw std::bad_alloc();
    }
    ::mosquitto_connect_callback_set(client_.get(), Calls::on_connect);
    ::mosquitto_publish_callback_set(client_.get(), Calls::on_publish);
    ::mosquitto_log_callback_set(client_.get(), Calls::on_log);
    const Publication& will = options_.will;
    ::mosquitto_will_set(client_.get(), will.topic.c_str(), static_cast<int>(will.payload.size()), will.payload.data(),
                         will.acknowledged ? 1 : 0, will.retained);
    if (!options_.user.empty()) {
        ::mosquitto_username_pw_set(client_.get(), options_.user.c_str(),
                                    options_.password.empty() ? nullptr : options_.password.c_str());
    }
    if (options_.tls) {
        set_up_tls();
    }
    errno = 0;
    const int error = ::mosquitto_connect_async(client_.get(), options_.address.host.c_str(), options_.address.port,
                                                static_cast<int>(kKeepAlive.seconds()));
    if (error != MOSQ_ERR_SUCCESS) {
        lose(now, why_of(error, errno));
    }
}

void BrokerLink::turn(Duration wait) {
    if (client_ == nullptr) {
        const Stamp now = monotonic_now();
        if (now - lost_at_ < retry_) {
            sleep_until(now + wait);
            return;
        }
        connect(now);
    }
    if (client_ == nullptr) {
        return;
    }
    errno = 0;
    const int error = ::mosquitto_loop(client_.get(), milliseconds(wait), 1);
    const int system_error = errno;
    const Stamp now = monotonic_now();
    if (error != MOSQ_ERR_SUCCESS || refusal_ != 0) {
        lose(now, why_of(error, system_error));
    } else if (!connected_ && now - tried_ > kAnswerMax) {
        lose(now, "does not answer; is that a broker, and does a firewall let through?");
    }
}

void BrokerLink::lose(Stamp now, const std::string& why) {
    const bool lasted = connected_ && now - connected_at_ >= kStable;
    retry_ = lasted || retry_ == kNoTime ? kRetryMin : std::min(Duration{2 * retry_.ns}, kRetryMax);
    lost_at_ = now;
    connected_ = false;
    client_.reset();
    if (const std::string line = text_of(options_.address) + ": " + why; line != said_) {
        said_ = line;
        say_(line);
    }
}

std::string BrokerLink::doubt_of_certificate() const {
    return options_.cert.empty() ? "does it want --cert?" : "does it know who signed " + options_.cert + "?";
}

std::string BrokerLink::why_of(int error, int system_error) const {
    constexpr int kBadPassword = 4;
    constexpr int kNotAuthorised = 5;
    if (refusal_ == kBadPassword || refusal_ == kNotAuthorised) {
        return options_.user.empty() ? "refuses us without a user; --user and --password-file name one"
                                     : "refuses the user " + options_.user +
                                           "; check --user, --password-file and the broker's list of users";
    }
    if (refusal_ != 0) {
        return std::string("refuses the connection: ") + ::mosquitto_connack_string(refusal_) +
               "; see the broker's log";
    }
    if (connected_) {
        return error == MOSQ_ERR_KEEPALIVE ? "is silent; trying again"
                                           : "the connection is lost; trying again. Again and again: does another "
                                             "crspf mqtt have the same --robot?";
    }
    if (is_of_files(complaint_)) {
        throw InputError(complaint_ + "; --ca, --cert and --key name PEM files, the key without a passphrase");
    }
    if (holds(complaint_, "host name verification failed")) {
        return "its certificate is for another host than " + options_.address.host +
               "; give --broker the name that stands in it";
    }
    if (holds(complaint_, "certificate verify failed")) {
        return "its certificate is not signed by " +
               (options_.ca.empty() ? std::string("any that this machine trusts") : options_.ca) +
               ", or is out of date; --ca names the certificate of who signed it";
    }
    if (holds(complaint_, "OpenSSL Error")) {
        return "no TLS with it: " + complaint_ + "; is that its port for TLS, and " + doubt_of_certificate();
    }
    if (error == MOSQ_ERR_EAI) {
        return "no such host; --broker names it";
    }
    // A client's certificate is refused after the handshake by TLS 1.3, and OpenSSL says nothing of that.
    if (options_.tls && error == MOSQ_ERR_ERRNO && system_error == EPROTO) {
        return "breaks off TLS; " + doubt_of_certificate();
    }
    if (error == MOSQ_ERR_ERRNO && system_error != 0) {
        return std::generic_category().message(system_error) + "; does the broker run there? --broker names another";
    }
    return std::string("no connection: ") + ::mosquitto_strerror(error) + "; is that a broker's port" +
           (options_.tls ? " for TLS?" : ", and one without TLS?");
}

void BrokerLink::publish(const Publication& publication) {
    ++on_the_way_;  // before: the library may confirm it at once
    const int error = ::mosquitto_publish(client_.get(), nullptr, publication.topic.c_str(),
                                          static_cast<int>(publication.payload.size()), publication.payload.data(),
                                          publication.acknowledged ? 1 : 0, publication.retained);
    if (error != MOSQ_ERR_SUCCESS) {
        lose(monotonic_now(), std::string("takes no message: ") + ::mosquitto_strerror(error) + "; trying again");
    }
}

void BrokerLink::end(const Publication& last, Duration wait) {
    const Stamp until = monotonic_now() + wait;
    constexpr Duration kTurn{20'000'000};
    if (!connected_) {
        return;
    }
    publish(last);
    while (connected_ && on_the_way_ > 0 && monotonic_now() < until) {
        turn(kTurn);
    }
    if (connected_) {
        ::mosquitto_disconnect(client_.get());
        ::mosquitto_loop(client_.get(), milliseconds(kTurn), 1);
    }
}

}  // namespace crspf::mqtt
