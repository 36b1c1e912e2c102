#include "drivers/sick/sick_session.hpp"

#include <algorithm>

namespace crspf {
namespace {

constexpr Duration kAnswerTime{1'000'000'000};     // a command without an answer is sent again
constexpr Duration kPollTime{250'000'000};         // from one STlms to the next
constexpr Duration kStartSilence{35'000'000'000};  // a sensor says nothing for up to 30 s after power-on
constexpr Duration kStartTime{120'000'000'000};    // and may heat up, but some time it must stream
constexpr Duration kFirstScanTime{5'000'000'000};  // a TiM does not tell when it is ready
constexpr Duration kFirstBackOff{100'000'000};
constexpr Duration kLongestBackOff{5'000'000'000};
// A stream is dead after three scans, but not before TCP had the time to repeat a lost segment (200 ms).
constexpr double kSilentScans = 3.0;
constexpr Duration kLeastSilence{250'000'000};

ColaDialect other(ColaDialect dialect) {
    return dialect == ColaDialect::kBinary ? ColaDialect::kAscii : ColaDialect::kBinary;
}

}  // namespace

SickSession::SickSession(const SickParams& params)
    : params_(params), dialect_(params.dialect == SickDialect::kAscii ? ColaDialect::kAscii : ColaDialect::kBinary) {}

void SickSession::on_open(Stamp now) {
    listener_.on_open();
    wants_reopen_ = false;
    opened_ = heard_ = now;
    enter(SickState::kLogin, now);
}

void SickSession::on_closed(Stamp now) {
    if (state_ != SickState::kStopped) {
        close(now);
    }
}

void SickSession::stop() {
    if (state_ == SickState::kClosed) {
        wants_reopen_ = false;
        out_size_ = 0;
    } else {
        out_size_ = encode_command(SickCommand::kUnsubscribe, dialect_, {}, out_);
    }
    state_ = SickState::kStopped;
}

void SickSession::close(Stamp now) {
    back_off_ = std::clamp(Duration{2 * back_off_.ns}, kFirstBackOff, kLongestBackOff);
    reopen_at_ = now + back_off_;
    wants_reopen_ = true;
    out_size_ = 0;
    state_ = SickState::kClosed;
}

SickOutput SickSession::next_output(Stamp now) {
    if (wants_reopen_ && now >= reopen_at_) {
        wants_reopen_ = false;
        ++counters_.reopened;
        return {SickOutput::Kind::kReopen, {}};
    }
    if (out_size_ > 0) {
        const std::size_t size = out_size_;
        out_size_ = 0;
        return {SickOutput::Kind::kSend, std::span(out_).first(size)};
    }
    return {};
}

SickCommand SickSession::command() const {
    switch (state_) {
        case SickState::kSwitchDialect:
            return dialect_ == ColaDialect::kBinary ? SickCommand::kUseAscii : SickCommand::kUseBinary;
        case SickState::kConfigureScan: return SickCommand::kConfigureScan;
        case SickState::kConfigureOutput: return SickCommand::kConfigureOutput;
        case SickState::kStartMeasuring: return SickCommand::kStartMeasuring;
        case SickState::kWaitReady: return SickCommand::kReadStatus;
        case SickState::kRun: return SickCommand::kRun;
        case SickState::kSubscribe: return SickCommand::kSubscribe;
        default: return SickCommand::kLogin;
    }
}

void SickSession::send(Stamp now) {
    out_size_ = encode_command(command(), dialect_, params_.scan.value_or(SickScanConfig{}), out_);
    sent_ = now;
}

void SickSession::enter(SickState state, Stamp now) {
    state_ = state;
    polling_ = false;
    out_size_ = 0;
    if (state_ != SickState::kStreaming) {
        send(now);
    }
}

// To the state after this one, past what the parameters do not ask for.
void SickSession::advance(Stamp now) {
    const bool wrong_dialect = (params_.dialect == SickDialect::kBinary && dialect_ == ColaDialect::kAscii) ||
                               (params_.dialect == SickDialect::kAscii && dialect_ == ColaDialect::kBinary);
    switch (state_) {
        case SickState::kLogin:
            if (wrong_dialect && !switched_) {
                return enter(SickState::kSwitchDialect, now);
            }
            [[fallthrough]];
        case SickState::kSwitchDialect:
            if (params_.scan) {
                return enter(SickState::kConfigureScan, now);
            }
            [[fallthrough]];
        case SickState::kConfigureScan:
            if (params_.configure_output) {
                return enter(SickState::kConfigureOutput, now);
            }
            [[fallthrough]];
        case SickState::kConfigureOutput: return enter(SickState::kStartMeasuring, now);
        case SickState::kStartMeasuring: return enter(SickState::kWaitReady, now);
        case SickState::kWaitReady: return enter(SickState::kRun, now);
        case SickState::kRun: return enter(SickState::kSubscribe, now);
        default: return enter(SickState::kStreaming, now);
    }
}

void SickSession::on_time(Stamp now) {
    if (state_ == SickState::kClosed || state_ == SickState::kStopped) {
        return;
    }
    if (state_ == SickState::kStreaming) {
        const double period_s = listener_.period_s();
        const Duration silence = std::max(kLeastSilence, Duration::from_seconds(kSilentScans * period_s));
        // Before two scans came nothing is known about the period.
        if (now - heard_ > (period_s > 0.0 ? silence : kFirstScanTime)) {
            ++counters_.silences;
            close(now);
        }
        return;
    }
    if (now - heard_ > kStartSilence || now - opened_ > kStartTime) {
        return close(now);
    }
    if (polling_ && now - sent_ >= kPollTime) {
        polling_ = false;
        send(now);
    } else if (now - sent_ >= kAnswerTime) {
        ++counters_.repeated;
        if (state_ == SickState::kLogin) {
            dialect_ = other(dialect_);
        }
        send(now);
    }
}

void SickSession::on_telegram(const ColaTelegram& telegram, bool scan, Stamp received) {
    const bool decoded = listener_.decoded() != decoded_before_;
    decoded_before_ = listener_.decoded();
    if (state_ == SickState::kClosed || state_ == SickState::kStopped) {
        return;
    }
    if (!telegram.is("sSN", "LMDscandata")) {
        heard_ = state_ == SickState::kStreaming ? heard_ : received;
        return on_reply(telegram, received);
    }
    if (state_ == SickState::kSubscribe) {
        advance(received);  // the answer was lost, the scans were not
    }
    if (state_ == SickState::kStreaming) {
        heard_ = decoded ? received : heard_;
        back_off_ = scan ? Duration{} : back_off_;
    }
}

void SickSession::on_reply(const ColaTelegram& reply, Stamp now) {
    const SickCommand asked = command();
    const bool refused = spells(reply.kind(), "sFA");
    const bool waiting = state_ != SickState::kStreaming;
    if (!waiting || (!refused && !answers(reply, asked))) {
        ++counters_.passed_over;
        return;
    }
    dialect_ = reply.dialect;
    if (refused || !accepted(reply, asked)) {
        ++counters_.refused;
        const std::uint16_t number = refusal(reply);
        refusal_ = {asked, number, refused ? refusal_text(number) : "the sensor said no"};
        if (state_ == SickState::kSubscribe) {
            return close(now);
        }
        return advance(now);
    }
    if (state_ == SickState::kWaitReady) {
        ColaFieldReader fields = reply.fields();
        if (fields.number<std::uint16_t>() != kSickReady) {
            polling_ = true;
            return;
        }
    }
    if (state_ == SickState::kSwitchDialect) {
        // The connection keeps its dialect; a new one has the other.
        switched_ = true;
        dialect_ = other(dialect_);
        return close(now);
    }
    advance(now);
}

}  // namespace crspf
