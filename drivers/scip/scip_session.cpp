#include "drivers/scip/scip_session.hpp"

#include <cmath>  // floor

namespace crspf {
namespace {

constexpr Duration kProbeTimeout{140'000'000};  // what Hokuyo's own library waits
constexpr Duration kTimeout{500'000'000};
constexpr Duration kSettleTime{50'000'000};
constexpr Duration kStreamPatience{2'000'000'000};  // bytes, but no good scan
constexpr int kTries = 3;
constexpr int kTimerReads = 10;
constexpr int kCalibrationScans = 10;
constexpr int kStuckScans = 2;
constexpr std::array<std::uint32_t, 6> kBauds{19'200, 115'200, 38'400, 57'600, 250'000, 500'000};

// Milliseconds from stamp `a` to `b`, either way round the wrap.
std::int64_t stamp_step_ms(std::uint32_t a, std::uint32_t b) {
    const std::int64_t step = (b - a) & 0xFFFFFFU;
    return step >= 0x800000 ? step - 0x1000000 : step;
}

// A sensor's clock and the host's agree on how long it was, up to a late host and a slow crystal.
bool agrees(std::int64_t step_ms, Duration host) {
    const double off_s = static_cast<double>(step_ms) * 1e-3 - host.seconds();
    const double tolerance_s = 0.5 + 0.01 * host.seconds();
    return step_ms > 0 && off_s <= tolerance_s && off_s >= -tolerance_s;
}

}  // namespace

void ScipSession::on_open(Stamp now) {
    candidate_ = 0;
    baud_ = params_.baud;
    parser_.clear();
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
        doubted_ = false;
        repeated_ = 0;
        return;
    }
    replies_at_entry_ = parser_.counters().replies;
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
        case State::kParameters: put_text(out, "PP"); break;
        case State::kAdjust: put_text(out, "TM0"); break;
        case State::kReadTimer: put_text(out, "TM1"); break;
        case State::kLaser: put_text(out, "BM"); break;
        case State::kStart: put_request(out, request_); break;
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
    fail(now);
}

void ScipSession::on_time(Stamp now) {
    if (state_ == State::kOpening) {
        return;
    }
    if (state_ == State::kStream) {
        const double period_s = sensor_.period_s() * (request_.skip + 1);
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
        case State::kSettle:
            parser_.clear();
            enter(State::kParameters, now);
            break;
        default: time_out(now); break;
    }
}

void ScipSession::time_out(Stamp now) {
    ++counters_.timeouts;
    if (state_ == State::kProbe) {
        // Whole replies to something else: the sensor streams at this bit rate, and its answer is still to come.
        const bool talks = parser_.counters().replies != replies_at_entry_;
        if (tries_ < (talks ? 4 * kTries : params_.baud == 0 ? kTries : 2)) {
            send_command(now);
        } else {
            next_baud(now);
        }
        return;
    }
    if (tries_ < kTries) {
        send_command(now);
    } else {
        fail(now);
    }
}

void ScipSession::next_baud(Stamp now) {
    while (params_.baud != 0 && candidate_ < kBauds.size()) {
        baud_ = kBauds[candidate_++];
        if (baud_ != params_.baud) {
            parser_.clear();
            enter(State::kProbe, now);
            return;
        }
    }
    fail(now);
}

bool ScipSession::on_reply(const ScipReply& reply, Stamp now) {
    if (state_ == State::kStream) {
        return on_stream(reply, now);
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
        case State::kParameters:
            if (is_text(reply.echo, "PP") && done && read_sensor(reply.body, sensor_)) {
                request_ = {params_.encoding, true, sensor_.amin, sensor_.amax, params_.cluster, params_.skip, 0};
                clock_.reset();
                timer_ = ScipTimer{};
                scan_delay_ = {};
                calibrating_ = 0;
                timer_reads_ = 0;
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
                on_timer(reply, now);
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
    return false;
}

void ScipSession::on_probe(const ScipReply& reply, Stamp now) {
    if (reply.scip1()) {
        enter(State::kScip2, now);
    } else if (is_text(reply.status, "0E")) {
        enter(State::kLeaveAdjust, now);
    } else if (is_text(reply.status, "00")) {
        enter(params_.baud != 0 && baud_ != params_.baud ? State::kSetBaud : State::kParameters, now);
    }
}

void ScipSession::on_timer(const ScipReply& reply, Stamp now) {
    Bytes body = reply.body;
    if (is_text(reply.status, "00") && body.size() == 6) {
        const Stamp device = timer_.unwrap(scip_decode(body.first(4)));
        // The timer showed `device` up to 1 ms later, and it was read after we asked and before the reply came.
        const std::int64_t low = asked_.ns - device.ns - 1'000'000;
        const std::int64_t high = reply.received.ns - device.ns;
        offset_low_ns_ = timer_reads_ == 0 ? low : std::max(offset_low_ns_, low);
        offset_high_ns_ = timer_reads_ == 0 ? high : std::min(offset_high_ns_, high);
        ++timer_reads_;
    }
    if (timer_reads_ == 0 || timer_reads_ >= kTimerReads) {
        calibrating_ = timer_reads_ == 0 ? 0 : kCalibrationScans;
        enter(State::kEndAdjust, now);
        return;
    }
    enter(State::kReadTimer, now);
}

bool ScipSession::on_stream(const ScipReply& reply, Stamp now) {
    ScipScanRequest echoed;
    if (reply.scip1() || !read_request(reply.echo, echoed) || !(echoed == request_)) {
        return false;
    }
    if (is_text(reply.status, "99")) {
        return on_scan(reply, now);
    }
    if (is_text(reply.status, "10")) {
        ++counters_.laser_off;
        enter(State::kLaser, now);
        return false;
    }
    if (is_text(reply.status, "00") || is_text(reply.status, "98")) {
        return false;
    }
    ++counters_.trouble;
    trouble_ = scip_status_text(reply.status, true);
    // 21-49: the sensor checks itself and says 98 when it is done; whether it does, the silence tells.
    if (reply.status[0] >= '5' && reply.status[0] <= '9') {
        fail(now);
    }
    return false;
}

bool ScipSession::stamp_ok(Stamp received, Stamp now) {
    const std::uint32_t stamp_ms = ranges_.stamp_ms;
    if (first_) {
        static_cast<void>(timer_.unwrap(stamp_ms));
        return true;
    }
    const std::int64_t step_ms = stamp_step_ms(accepted_ms_, stamp_ms);
    if (step_ms == 0) {
        ++counters_.stuck_stamps;
        if (++repeated_ > kStuckScans) {
            trouble_ = "the sensor's time stands still";
            fail(now);
        }
        return false;
    }
    const double period_ms = sensor_.period_s() * 1e3 * (request_.skip + 1);
    if (agrees(step_ms, received - accepted_at_)) {
        const double gap = static_cast<double>(step_ms) / period_ms;
        const double whole = std::floor(gap + 0.5);
        // A revolution is as regular as the motor: a stamp between two of them is a damaged one.
        if (whole >= 1.0 && (whole > 50.0 || (gap - whole < 0.2 && gap - whole > -0.2))) {
            counters_.lost_scans += static_cast<std::uint64_t>(whole) - 1;
            return true;
        }
    } else if (doubted_ && agrees(stamp_step_ms(doubted_ms_, stamp_ms), received - doubted_at_)) {
        // Twice the same contradiction: the sensor's time did move.
        ++counters_.clock_jumps;
        clock_.reset();
        calibrating_ = 0;
        return true;
    }
    ++counters_.bad_stamps;
    doubted_ = true;
    doubted_ms_ = stamp_ms;
    doubted_at_ = received;
    return false;
}

bool ScipSession::on_scan(const ScipReply& reply, Stamp now) {
    if (!decode_scan(reply.body, request_, ranges_)) {
        ++counters_.bad_scans;
        return false;
    }
    if (!stamp_ok(reply.received, now)) {
        return false;
    }
    first_ = false;
    doubted_ = false;
    repeated_ = 0;
    accepted_ms_ = ranges_.stamp_ms;
    accepted_at_ = reply.received;
    last_scan_ = now;
    backoff_.reset();
    ++counters_.scans;
    fill_scan(ranges_, request_, sensor_, scan_);
    stamp_scan(reply.received);
    return true;
}

// The sensor can send a scan once its last beam was measured. What passes from then to the reception is the same for
// every scan but for jitter; the offset that TM1 told shows how much it is.
void ScipSession::stamp_scan(Stamp received) {
    const Stamp device = timer_.unwrap(ranges_.stamp_ms);
    const Stamp last_beam = device + Duration::from_seconds(request_.end * sensor_.step_s());
    const double first_beam_s = (request_.start + 0.5 * (request_.cluster_steps() - 1)) * sensor_.step_s();
    if (calibrating_ > 0) {
        const std::int64_t offset_ns = offset_low_ns_ + (offset_high_ns_ - offset_low_ns_) / 2;
        const Duration delay{std::max<std::int64_t>(received.ns - last_beam.ns - offset_ns, 0)};
        scan_delay_ = calibrating_ == kCalibrationScans ? delay : std::min(scan_delay_, delay);
        if (--calibrating_ > 0) {
            scan_.stamp = Stamp{device.ns + offset_ns} + Duration::from_seconds(first_beam_s);
            return;
        }
    }
    clock_.add(last_beam, received - scan_delay_);
    scan_.stamp = clock_.to_host(device) + Duration::from_seconds(first_beam_s);
}

}  // namespace crspf
