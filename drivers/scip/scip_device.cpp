#include "drivers/scip/scip_device.hpp"

#include <algorithm>

namespace crspf {
namespace {

template <std::size_t N>
void put_status_text(ByteWriter& out, const char (&two_chars)[N]) {
    static_assert(N == 3);
    const std::array<std::uint8_t, 2> bytes{static_cast<std::uint8_t>(two_chars[0]),
                                            static_cast<std::uint8_t>(two_chars[1])};
    put_status(out, bytes);
}

void put_line(ByteWriter& out, Bytes text) {
    out.bytes(text);
    out.byte('\n');
}

template <std::size_t N>
void put_reply(ByteWriter& out, Bytes echo, const char (&status)[N]) {
    put_line(out, echo);
    put_status_text(out, status);
    out.byte('\n');
}

template <std::size_t N>
void put_text_line(ByteWriter& out, const char (&text)[N]) {
    std::array<std::uint8_t, N - 1> bytes{};
    std::copy_n(text, N - 1, bytes.begin());
    put_text_line(out, Bytes(bytes));
}

template <std::size_t N>
void put_number_line(ByteWriter& out, const char (&key)[N], std::uint32_t value) {
    std::array<std::uint8_t, 32> bytes{};
    ByteWriter line(bytes);
    put_text(line, key);
    std::size_t digits = 1;
    for (std::uint32_t rest = value; rest >= 10; rest /= 10) {
        ++digits;
    }
    put_decimal(line, value, digits);
    put_text_line(out, line.written());
}

void put_model_line(ByteWriter& out, const ScipSensor& sensor) {
    std::array<std::uint8_t, 80> bytes{};
    ByteWriter line(bytes);
    put_text(line, "MODL:");
    for (const char c : sensor.model) {
        if (c == '\0') {
            break;
        }
        line.byte(static_cast<std::uint8_t>(c));
    }
    put_text_line(out, line.written());
}

}  // namespace

void ScipDevice::power_on(Stamp now) {
    line_size_ = 0;
    scip1_ = params_.starts_in_scip1;
    laser_ = false;
    adjust_ = false;
    streaming_ = false;
    baud_ = params_.baud;
    origin_ = now;
    revolution_ = 0;
    planted_ = {};
}

std::uint32_t ScipDevice::timer_ms(Stamp now) const {
    return static_cast<std::uint32_t>((now - origin_).ns / 1'000'000) & 0xFFFFFFU;
}

void ScipDevice::on_bytes(Bytes bytes, Stamp now, ByteWriter& out) {
    for (const std::uint8_t c : bytes) {
        if (c != '\n' && c != '\r') {
            if (line_size_ < line_.size()) {
                line_[line_size_++] = c;
            }
        } else if (line_size_ > 0) {
            answer(Bytes(line_).first(line_size_), now, out);
            line_size_ = 0;
        }
    }
}

void ScipDevice::answer(Bytes line, Stamp now, ByteWriter& out) {
    if (!scip1_) {
        answer_scip2(line, now, out);
        return;
    }
    const bool switches = is_text(line, "SCIP2.0");
    scip1_ = !switches;
    put_line(out, line);
    out.byte(switches ? '0' : 'E');
    put_text(out, "\n\n");
}

void ScipDevice::answer_scip2(Bytes line, Stamp now, ByteWriter& out) {
    ScipScanRequest request;
    if (begins_with(line, "TM")) {
        answer_timer(line, now, out);
        return;
    }
    if (adjust_) {
        put_reply(out, line, "0E");
        return;
    }
    if (is_text(line, "VV")) {
        put_line(out, line);
        put_status_text(out, "00");
        put_text_line(out, "VEND:Hokuyo Automatic Co.,Ltd.");
        put_text_line(out, "PROD:simulated");
        put_text_line(out, "FIRM:3.1.00");
        put_text_line(out, "PROT:SCIP 2.0");
        put_text_line(out, "SERI:H0000000");
        out.byte('\n');
    } else if (is_text(line, "PP")) {
        put_line(out, line);
        put_status_text(out, "00");
        put_model_line(out, params_.sensor);
        put_number_line(out, "DMIN:", params_.sensor.dmin_mm);
        put_number_line(out, "DMAX:", params_.sensor.dmax_mm);
        put_number_line(out, "ARES:", params_.sensor.ares);
        put_number_line(out, "AMIN:", params_.sensor.amin);
        put_number_line(out, "AMAX:", params_.sensor.amax);
        put_number_line(out, "AFRT:", params_.sensor.afrt);
        put_number_line(out, "SCAN:", params_.sensor.scan_rpm);
        out.byte('\n');
    } else if (is_text(line, "II")) {
        put_line(out, line);
        put_status_text(out, "00");
        put_model_line(out, params_.sensor);
        if (laser_) {
            put_text_line(out, "LASR:ON");
        } else {
            put_text_line(out, "LASR:OFF");
        }
        put_number_line(out, "SBPS:", baud_);
        put_text_line(out, "STAT:Sensor works well.");
        out.byte('\n');
    } else if (is_text(line, "BM")) {
        if (laser_) {
            put_reply(out, line, "02");
        } else {
            put_reply(out, line, "00");
        }
        laser_ = true;
    } else if (is_text(line, "QT") || is_text(line, "RS")) {
        laser_ = false;
        streaming_ = false;
        if (line[0] == 'R') {
            origin_ = now;
            baud_ = params_.baud;
        }
        put_reply(out, line, "00");
    } else if (begins_with(line, "SS") && line.size() == 8) {
        std::uint32_t baud = 0;
        for (const std::uint8_t c : line.subspan(2)) {
            baud = baud * 10 + (c - std::uint32_t{'0'});
        }
        put_reply(out, line, "00");
        baud_ = baud;
    } else if (read_request(line, request)) {
        answer_scans(line, request, out);
    } else {
        put_reply(out, line, "0E");
    }
}

void ScipDevice::answer_timer(Bytes line, Stamp now, ByteWriter& out) {
    if (is_text(line, "TM0")) {
        if (adjust_) {
            put_reply(out, line, "02");
            return;
        }
        adjust_ = true;
        laser_ = false;
        streaming_ = false;
        put_reply(out, line, "00");
    } else if (is_text(line, "TM1") && adjust_) {
        std::array<std::uint8_t, 4> chars{};
        ByteWriter stamp(chars);
        scip_encode(stamp, timer_ms(now), 4);
        put_line(out, line);
        put_status_text(out, "00");
        put_payload(out, chars);
        out.byte('\n');
    } else if (is_text(line, "TM1")) {
        put_reply(out, line, "04");
    } else if (is_text(line, "TM2")) {
        if (adjust_) {
            put_reply(out, line, "00");
        } else {
            put_reply(out, line, "03");
        }
        adjust_ = false;
    } else {
        put_reply(out, line, "01");
    }
}

void ScipDevice::answer_scans(Bytes line, const ScipScanRequest& request, ByteWriter& out) {
    if (request.end > params_.sensor.amax) {
        put_reply(out, line, "04");
    } else if (!request.continuous && !laser_) {
        put_reply(out, line, "10");
    } else if (!request.continuous) {
        put_line(out, line);
        put_status_text(out, "00");
        put_scan(request, out);
    } else {
        laser_ = true;
        streaming_ = true;
        request_ = request;
        revolution_ = 0;
        put_reply(out, line, "00");
    }
}

void ScipDevice::on_revolution(Stamp step0, std::span<const std::uint32_t> range_mm,
                               std::span<const std::uint32_t> intensity, ByteWriter& out) {
    latest_.stamp_ms = timer_ms(step0);
    latest_.count = static_cast<std::uint32_t>(std::min(range_mm.size(), latest_.range_mm.size()));
    std::copy_n(range_mm.begin(), latest_.count, latest_.range_mm.begin());
    latest_.intensity = {};
    std::copy_n(intensity.begin(), std::min<std::size_t>(intensity.size(), latest_.count), latest_.intensity.begin());
    if (!streaming_ || revolution_++ % (request_.skip + 1) != 0) {
        return;
    }
    ScipScanRequest echo = request_;
    if (request_.count > 0) {
        echo.count = --request_.count;
        streaming_ = echo.count > 0;
    }
    put_request(out, echo);
    out.byte('\n');
    if (planted_[0] != 0 || !laser_) {
        constexpr std::array<std::uint8_t, 2> kLaserOff{'1', '0'};
        put_status(out, planted_[0] != 0 ? planted_ : kLaserOff);
        out.byte('\n');
        streaming_ = false;
        planted_ = {};
        return;
    }
    put_status_text(out, "99");
    put_scan(echo, out);
    laser_ = streaming_;  // goes off after the last of a counted row
}

void ScipDevice::put_scan(const ScipScanRequest& request, ByteWriter& out) {
    std::array<std::uint8_t, 4> stamp{};
    ByteWriter stamp_chars(stamp);
    scip_encode(stamp_chars, latest_.stamp_ms, 4);
    put_payload(out, stamp);

    std::array<std::uint8_t, capacity::kBeams * 6> chars{};
    ByteWriter payload(chars);
    const std::size_t digits = request.encoding == ScipEncoding::kTwoChars ? 2 : 3;
    const std::uint32_t largest = digits == 2 ? 0xFFF : 0x3FFFF;
    const std::uint32_t cluster = request.cluster_steps();
    for (std::uint32_t step = request.start; step <= request.end; step += cluster) {
        std::uint32_t range = 0;
        std::uint32_t intensity = 0;
        for (std::uint32_t i = step; i < std::min({step + cluster, request.end + 1, latest_.count}); ++i) {
            const std::uint32_t value = latest_.range_mm[i];
            // The nearest that is a distance; a code only where there is nothing else.
            const bool nearer =
                value >= params_.sensor.dmin_mm ? range < params_.sensor.dmin_mm || value < range : i == step;
            if (nearer) {
                range = value;
                intensity = latest_.intensity[i];
            }
        }
        scip_encode(payload, std::min(range, largest), digits);
        if (request.encoding == ScipEncoding::kWithIntensity) {
            scip_encode(payload, std::min(intensity, largest), digits);
        }
    }
    put_payload(out, payload.written());
    out.byte('\n');
}

}  // namespace crspf
