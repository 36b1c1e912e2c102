#include "drivers/sick/lms2xx_session.hpp"

#include <algorithm>

namespace crspf {
namespace {

// From the factory 9600; the others are what an earlier session left behind.
constexpr std::array<std::uint32_t, 4> kBauds = {9600, 19200, 38400, 500000};
constexpr Duration kAnswerTime{500'000'000};  // 160 bytes of status take 170 ms at 9600 baud
constexpr Duration kStartSilence{35'000'000'000};
constexpr Duration kFirstBackOff{100'000'000};
constexpr Duration kLongestBackOff{5'000'000'000};
constexpr Duration kLeastSilence{250'000'000};
constexpr int kAttempts = 4;
constexpr int kAttemptsPerBaud = 2;
constexpr double kBitsPerByte = 10.0;

constexpr std::uint8_t kModeReply = 0xA0;
constexpr std::uint8_t kStatusReply = 0xB1;
constexpr std::uint8_t kVariantReply = 0xBB;
constexpr std::uint8_t kModeTaken = 0;
constexpr std::uint8_t kVariantTaken = 1;

}  // namespace

void Lms2xxSession::on_open(Stamp now) {
    listener_.on_open();
    wants_reopen_ = false;
    opened_ = heard_ = now;
    candidate_ = 0;
    set_baud(kBauds[candidate_]);
    enter(Lms2xxState::kFindBaud, now);
}

void Lms2xxSession::on_closed(Stamp now) {
    if (state_ != Lms2xxState::kStopped) {
        close(now);
    }
}

void Lms2xxSession::stop() {
    wants_reopen_ = false;
    baud_wanted_ = false;
    out_size_ = state_ == Lms2xxState::kClosed ? 0 : encode_lms2xx_mode(Lms2xxMode::kOnRequest, out_);
    state_ = Lms2xxState::kStopped;
}

void Lms2xxSession::close(Stamp now) {
    back_off_ = std::clamp(Duration{2 * back_off_.ns}, kFirstBackOff, kLongestBackOff);
    reopen_at_ = now + back_off_;
    wants_reopen_ = true;
    baud_wanted_ = false;
    out_size_ = 0;
    state_ = Lms2xxState::kClosed;
}

void Lms2xxSession::set_baud(std::uint32_t baud) {
    baud_ = baud;
    baud_wanted_ = true;
}

Lms2xxOutput Lms2xxSession::next_output(Stamp now) {
    if (wants_reopen_ && now >= reopen_at_) {
        wants_reopen_ = false;
        ++counters_.reopened;
        return {Lms2xxOutput::Kind::kReopen, 0, {}};
    }
    if (baud_wanted_) {
        baud_wanted_ = false;
        return {Lms2xxOutput::Kind::kSetBaud, baud_, {}};
    }
    if (out_size_ > 0) {
        const std::size_t size = out_size_;
        out_size_ = 0;
        return {Lms2xxOutput::Kind::kSend, 0, std::span(out_).first(size)};
    }
    return {};
}

void Lms2xxSession::send(Stamp now) {
    Lms2xxMode mode = Lms2xxMode::kOnRequest;
    switch (state_) {
        case Lms2xxState::kFindBaud: out_size_ = encode_lms2xx_status_request(out_); break;
        case Lms2xxState::kQuiet: out_size_ = encode_lms2xx_mode(Lms2xxMode::kOnRequest, out_); break;
        case Lms2xxState::kVariant: out_size_ = encode_lms2xx_variant(params_.variant, out_); break;
        case Lms2xxState::kSetBaud:
            out_size_ = mode_of_baud(params_.baud, mode) ? encode_lms2xx_mode(mode, out_) : 0;
            break;
        default: out_size_ = encode_lms2xx_mode(Lms2xxMode::kStreamAll, out_); break;
    }
    sent_ = now;
}

void Lms2xxSession::enter(Lms2xxState state, Stamp now) {
    Lms2xxMode mode = Lms2xxMode::kOnRequest;
    const bool nothing_to_set = params_.baud == baud_ || !mode_of_baud(params_.baud, mode);
    state_ = state == Lms2xxState::kSetBaud && nothing_to_set ? Lms2xxState::kStream : state;
    attempts_ = 0;
    out_size_ = 0;
    if (state_ != Lms2xxState::kStreaming) {
        send(now);
    }
}

Duration Lms2xxSession::silence() const {
    const double line_s = static_cast<double>(kLargestLms2xxTelegram) * kBitsPerByte / static_cast<double>(baud_);
    return std::max(kLeastSilence, Duration::from_seconds(3.0 * line_s));  // always longer than the sweep
}

void Lms2xxSession::on_time(Stamp now) {
    if (state_ == Lms2xxState::kClosed || state_ == Lms2xxState::kStopped) {
        return;
    }
    if (state_ == Lms2xxState::kStreaming) {
        if (now - heard_ > silence()) {
            ++counters_.silences;
            close(now);
        }
        return;
    }
    if (now - heard_ > kStartSilence) {
        return close(now);
    }
    if (now - sent_ < kAnswerTime) {
        return;
    }
    ++attempts_;
    ++counters_.repeated;
    if (state_ == Lms2xxState::kFindBaud && attempts_ >= kAttemptsPerBaud) {
        candidate_ = (candidate_ + 1) % kBauds.size();
        set_baud(kBauds[candidate_]);
        attempts_ = 0;
    } else if (state_ != Lms2xxState::kFindBaud && attempts_ >= kAttempts) {
        return enter(Lms2xxState::kFindBaud, now);  // it may have changed its speed, and the answer was lost
    }
    send(now);
}

void Lms2xxSession::on_message(const Lms2xxMessage& message, bool scan, Stamp now) {
    if (state_ == Lms2xxState::kClosed || state_ == Lms2xxState::kStopped) {
        return;
    }
    if (message.kind != Lms2xxMessage::Kind::kTelegram) {
        counters_.refused += message.kind == Lms2xxMessage::Kind::kNack ? 1 : 0;
        return;  // the reply tells more; without one the command is sent again
    }
    if ((message.address & kLms2xxFromSensor) == 0) {
        return;
    }
    if (state_ == Lms2xxState::kStream && message.payload[0] == kLms2xxScanReply) {
        enter(Lms2xxState::kStreaming, now);  // the answer was lost, the scans were not
    }
    if (state_ != Lms2xxState::kStreaming) {
        heard_ = now;
        on_reply(message.payload, now);
    } else if (scan) {
        heard_ = now;
        back_off_ = {};
    }
}

void Lms2xxSession::on_reply(std::span<const std::uint8_t> payload, Stamp now) {
    const std::uint8_t command = payload[0];
    const std::uint8_t verdict = payload.size() > 1 ? payload[1] : 0;
    if (state_ == Lms2xxState::kFindBaud) {
        // A telegram whose sum holds is proof of the speed, whatever it says.
        if (command == kStatusReply || command == kLms2xxScanReply) {
            enter(Lms2xxState::kQuiet, now);
        }
        return;
    }
    if (command != (state_ == Lms2xxState::kVariant ? kVariantReply : kModeReply)) {
        return;
    }
    const bool taken = verdict == (state_ == Lms2xxState::kVariant ? kVariantTaken : kModeTaken);
    counters_.refused += taken ? 0 : 1;
    switch (state_) {
        case Lms2xxState::kQuiet: return enter(Lms2xxState::kVariant, now);
        case Lms2xxState::kVariant: return enter(Lms2xxState::kSetBaud, now);  // a scan tells its own variant
        case Lms2xxState::kSetBaud:
            if (!taken) {
                return close(now);  // scans at another speed than the configured one would be stamped wrongly
            }
            set_baud(params_.baud);
            return enter(Lms2xxState::kStream, now);
        default:
            if (taken) {
                enter(Lms2xxState::kStreaming, now);
            }
    }
}

}  // namespace crspf
