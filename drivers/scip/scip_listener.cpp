#include "drivers/scip/scip_listener.hpp"

#include <algorithm>
#include <cmath>  // floor

namespace crspf {
namespace {

constexpr Duration kCalibrationTime{20'000'000'000};  // within what the clock estimator remembers
constexpr int kStuckScans = 2;

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

// Sensors count down in the echo what is left of a limited number of scans.
bool same_scans(ScipScanRequest a, const ScipScanRequest& b) {
    a.count = b.count;
    return a == b;
}

}  // namespace

bool ScipListener::stuck() const {
    return repeated_ > kStuckScans;
}

const Scan* ScipListener::on_reply(const ScipReply& reply) {
    if (reply.scip1()) {
        return nullptr;
    }
    ScipScanRequest request;
    if (read_request(reply.echo, request)) {
        if (is_text(reply.status, request.continuous ? "99" : "00")) {
            return on_scan(reply, request);
        }
        if (is_text(reply.status, "00")) {
            begin_scans(request);
        }
        return nullptr;
    }
    if (is_text(reply.echo, "PP") && is_text(reply.status, "00")) {
        on_parameters(reply);
    } else if ((is_text(reply.echo, "VV") || is_text(reply.echo, "II")) && is_text(reply.status, "00")) {
        read_identity(reply.body, identity_);
    } else if (is_text(reply.echo, "TM0")) {
        timer_reads_ = 0;
    } else if (is_text(reply.echo, "TM1") && is_text(reply.status, "00")) {
        on_timer(reply);
    } else if (is_text(reply.echo, "TM2")) {
        synchronised_ = timer_reads_ > 0;
    }
    return nullptr;
}

void ScipListener::on_parameters(const ScipReply& reply) {
    if (!read_sensor(reply.body, sensor_)) {
        sensor_ = {};
    }
    clock_.reset();
    timer_ = ScipTimer{};
    scan_delay_ = {};
    synchronised_ = false;
    timer_reads_ = 0;
    asked_for_scans_ = false;
}

void ScipListener::on_timer(const ScipReply& reply) {
    if (reply.body.size() != 6) {
        return;
    }
    const Stamp device = timer_.unwrap(scip_decode(reply.body.first(4)));
    // The timer showed `device` up to 1 ms later, and it was read after we asked and before the reply came.
    const std::int64_t low = asked_.ns - device.ns - 1'000'000;
    const std::int64_t high = reply.received.ns - device.ns;
    offset_low_ns_ = timer_reads_ == 0 ? low : std::max(offset_low_ns_, low);
    offset_high_ns_ = timer_reads_ == 0 ? high : std::min(offset_high_ns_, high);
    ++timer_reads_;
    synchronised_at_ = device;
}

void ScipListener::begin_scans(const ScipScanRequest& request) {
    request_ = request;
    asked_for_scans_ = true;
    first_ = true;
    doubted_ = false;
    repeated_ = 0;
}

const Scan* ScipListener::on_scan(const ScipReply& reply, const ScipScanRequest& request) {
    if (sensor_.ares == 0) {
        ++counters_.unknown_sensor;
        return nullptr;
    }
    if (!asked_for_scans_) {
        begin_scans(request);
    }
    if (!same_scans(request, request_) || request.end < request.start || !decode_scan(reply.body, request_, ranges_)) {
        ++counters_.bad_scans;
        return nullptr;
    }
    if (!stamp_ok(reply.received)) {
        return nullptr;
    }
    first_ = false;
    doubted_ = false;
    repeated_ = 0;
    accepted_ms_ = ranges_.stamp_ms;
    accepted_at_ = reply.received;
    ++counters_.scans;
    fill_scan(ranges_, request_, sensor_, scan_);
    stamp_scan(reply.received);
    return &scan_;
}

bool ScipListener::stamp_ok(Stamp received) {
    const std::uint32_t stamp_ms = ranges_.stamp_ms;
    if (first_) {
        static_cast<void>(timer_.unwrap(stamp_ms));
        return true;
    }
    const std::int64_t step_ms = stamp_step_ms(accepted_ms_, stamp_ms);
    if (step_ms == 0) {
        ++counters_.stuck_stamps;
        ++repeated_;
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
        synchronised_ = false;
        return true;
    }
    ++counters_.bad_stamps;
    doubted_ = true;
    doubted_ms_ = stamp_ms;
    doubted_at_ = received;
    return false;
}

// The sensor can send a scan once its last beam was measured. What passes from then to the reception is at least the
// same for every scan; where the line of the most punctual scans stood when TM1 told the true offset shows how much.
void ScipListener::stamp_scan(Stamp received) {
    const Stamp device = timer_.unwrap(ranges_.stamp_ms);
    const Stamp last_beam = device + Duration::from_seconds(request_.end * sensor_.step_s());
    const double first_beam_s = (request_.start + 0.5 * (request_.cluster_steps() - 1)) * sensor_.step_s();
    clock_.add(last_beam, received);
    if (synchronised_ && last_beam - synchronised_at_ < kCalibrationTime) {
        const std::int64_t offset_ns = offset_low_ns_ + (offset_high_ns_ - offset_low_ns_) / 2;
        scan_delay_ = {
            std::max<std::int64_t>(clock_.to_host(synchronised_at_).ns - synchronised_at_.ns - offset_ns, 0)};
    }
    scan_.stamp = clock_.to_host(device) + Duration::from_seconds(first_beam_s) - scan_delay_;
}

}  // namespace crspf
