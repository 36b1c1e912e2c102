#include "drivers/scip/scip_session.hpp"

#include <algorithm>

namespace crspf {
namespace {

constexpr Duration kProbeTimeout{140'000'000};  // what Hokuyo's own library waits
constexpr Duration kTimeout{500'000'000};
constexpr Duration kSettleTime{50'000'000};
constexpr Duration kStreamPatience{2'000'000'000};  // bytes, but no good scan
constexpr int kTries = 3;
constexpr int kTimerReads = 10;
constexpr std::array<std::uint32_t, 6> kBauds{19'200, 115'200, 38'400, 57'600, 250'000, 500'000};

}  // namespace

void ScipSession::on_open(Stamp now) {
    candidate_ = 0;
    baud_ = params_.baud;
    listener_.on_open();
    enter(State::kProbe, now);
}

void ScipSession::enter(State state, Stamp now) {
    state_ = state;
    tries_ = 0;
    if (state == State::kOpening || state == State::kWaiting) {
        out_size_ = 0;
        return;
    }
    if (state == State::kSettle) {
        deadline_ = now + kSettleTime;
        return;
    }
    if (state == State::kStream) {
        last_scan_ = now;
        heard_ = now;
        first_ = true;
        return;
    }
    replies_at_entry_ = listener_.parser_counters().replies;
    send_command(now);
}

void ScipSession::send_command(Stamp now) {
    ByteWriter out(out_);
    switch (state_) {
        case State::kProbe: put_text(out, "QT"); break;
        case State::kScip2: put_text(out, "SCIP2.0"); break;
        case State::kLeaveAdjust:
        case State::kEndAdjust: put_text(out, "TM2"); break;
        case State::kSetBaud:
            put_text(out, "SS");
            put_decimal(out, params_.baud, 6);
            break;
        case State::kVersion: put_text(out, "VV"); break;
        case State::kParameters: put_text(out, "PP"); break;
        case State::kAdjust: put_text(out, "TM0"); break;
        case State::kReadTimer: put_text(out, "TM1"); break;
        case State::kLaser: put_text(out, "BM"); break;
        case State::kStart: put_request(out, request_); break;
        case State::kDiagnose: put_text(out, "II"); break;
        case State::kOpening:
        case State::kWaiting:
        case State::kSettle:
        case State::kStream: return;
    }
    out.byte('\n');
    out_size_ = out.position();
    deadline_ = now + (state_ == State::kProbe ? kProbeTimeout : kTimeout);
    ++tries_;
}

void ScipSession::fail(Stamp now) {
    ++counters_.failures;
    enter(State::kWaiting, now);
    deadline_ = now + backoff_.next();
}

void ScipSession::refuse(Bytes status, Stamp now) {
    ++counters_.refused;
    trouble_ = scip_status_text(status, state_ == State::kStart);
    enter(State::kDiagnose, now);
}

void ScipSession::on_time(Stamp now) {
    if (state_ == State::kOpening) {
        return;
    }
    if (state_ == State::kStream) {
        if (listener_.sensor().ares == 0) {  // a reply to PP that nobody asked for, and senseless: no angles, no period
            fail(now);
            return;
        }
        const double period_s = listener_.sensor().period_s() * (request_.skip + 1);
        // The laser and the motor take their time before the first scan.
        const Duration silence = Duration::from_seconds(first_ ? 1.0 + 3.0 * period_s : 3.0 * period_s);
        const Duration patience = std::max(silence, kStreamPatience);
        if (now - heard_ > silence || now - last_scan_ > patience) {
            ++counters_.silences;
            fail(now);
        }
        return;
    }
    if (now < deadline_) {
        return;
    }
    switch (state_) {
        case State::kWaiting: enter(State::kOpening, now); break;
        case State::kSettle: enter(State::kVersion, now); break;
        default: time_out(now); break;
    }
}

void ScipSession::time_out(Stamp now) {
    ++counters_.timeouts;
    if (state_ == State::kProbe) {
        // Whole replies to something else: the sensor streams at this bit rate, and its answer is still to come.
        const bool talks = listener_.parser_counters().replies != replies_at_entry_;
        if (tries_ < (talks ? 4 * kTries : params_.baud == 0 ? kTries : 2)) {
            send_command(now);
        } else {
            next_baud(now);
        }
        return;
    }
    if (tries_ < kTries) {
        send_command(now);
    } else if (state_ == State::kVersion) {
        enter(State::kParameters, now);  // what cannot tell its version may serve all the same
    } else {
        fail(now);
    }
}

void ScipSession::next_baud(Stamp now) {
    while (params_.baud != 0 && candidate_ < kBauds.size()) {
        baud_ = kBauds[candidate_++];
        if (baud_ != params_.baud) {
            enter(State::kProbe, now);
            return;
        }
    }
    fail(now);
}

void ScipSession::on_reply(const ScipReply& reply, bool scan, Stamp now) {
    if (state_ == State::kStream) {
        on_stream(reply, scan, now);
        return;
    }
    const Bytes status = reply.status;
    const bool done = is_text(status, "00");
    switch (state_) {
        case State::kProbe:
            if (is_text(reply.echo, "QT")) {
                on_probe(reply, now);
            }
            break;
        case State::kScip2:
            if (is_text(reply.echo, "SCIP2.0")) {
                enter(State::kProbe, now);
            }
            break;
        case State::kLeaveAdjust:
            if (is_text(reply.echo, "TM2")) {
                enter(State::kProbe, now);
            }
            break;
        case State::kSetBaud:
            if (is_text(reply.echo.first(2), "SS")) {
                if (done || is_text(status, "03")) {
                    baud_ = params_.baud;  // any other answer: it stays as it is, and serves
                }
                enter(State::kSettle, now);
            }
            break;
        case State::kVersion:
            if (is_text(reply.echo, "VV")) {
                enter(State::kParameters, now);
            }
            break;
        case State::kDiagnose:
            if (is_text(reply.echo, "II")) {
                fail(now);
            }
            break;
        case State::kParameters:
            if (const ScipSensor& sensor = listener_.sensor(); is_text(reply.echo, "PP") && done && sensor.ares != 0) {
                request_ = {params_.encoding, true, sensor.amin, sensor.amax, params_.cluster, params_.skip, 0};
                enter(params_.synchronise ? State::kAdjust : State::kLaser, now);
            }
            break;
        case State::kAdjust:
            if (is_text(reply.echo, "TM0")) {
                enter(done || is_text(status, "02") ? State::kReadTimer : State::kLaser, now);
            }
            break;
        case State::kReadTimer:
            if (is_text(reply.echo, "TM1")) {
                const int reads = listener_.timer_reads();  // none after the first: the sensor cannot
                enter(reads == 0 || reads >= kTimerReads ? State::kEndAdjust : State::kReadTimer, now);
            }
            break;
        case State::kEndAdjust:
            if (is_text(reply.echo, "TM2")) {
                enter(State::kLaser, now);
            }
            break;
        case State::kLaser:
            if (is_text(reply.echo, "BM")) {
                if (done || is_text(status, "02")) {
                    enter(State::kStart, now);
                } else {
                    refuse(status, now);
                }
            }
            break;
        case State::kStart: {
            ScipScanRequest echoed;
            if (read_request(reply.echo, echoed) && echoed == request_) {
                if (done || is_text(status, "99")) {
                    enter(State::kStream, now);
                } else if (is_text(status, "10")) {
                    enter(State::kLaser, now);
                } else {
                    refuse(status, now);
                }
            }
            break;
        }
        case State::kOpening:
        case State::kWaiting:
        case State::kSettle:
        case State::kStream: break;
    }
}

void ScipSession::on_probe(const ScipReply& reply, Stamp now) {
    if (reply.scip1()) {
        enter(State::kScip2, now);
    } else if (is_text(reply.status, "0E")) {
        enter(State::kLeaveAdjust, now);
    } else if (is_text(reply.status, "00")) {
        enter(params_.baud != 0 && baud_ != params_.baud ? State::kSetBaud : State::kVersion, now);
    }
}

void ScipSession::on_stream(const ScipReply& reply, bool scan, Stamp now) {
    if (scan) {
        first_ = false;
        last_scan_ = now;
        backoff_.reset();
        return;
    }
    if (listener_.stuck()) {
        trouble_ = "the sensor's time stands still";
        fail(now);
        return;
    }
    ScipScanRequest echoed;
    if (reply.scip1() || !read_request(reply.echo, echoed) || !(echoed == request_)) {
        return;
    }
    if (is_text(reply.status, "10")) {
        ++counters_.laser_off;
        enter(State::kLaser, now);
        return;
    }
    if (is_text(reply.status, "00") || is_text(reply.status, "98") || is_text(reply.status, "99")) {
        return;
    }
    ++counters_.trouble;
    trouble_ = scip_status_text(reply.status, true);
    // 21-49: the sensor checks itself and says 98 when it is done; whether it does, the silence tells.
    if (reply.status[0] >= '5' && reply.status[0] <= '9') {
        enter(State::kDiagnose, now);
    }
}

}  // namespace crspf
