#include "drivers/scip/scip_sensor.hpp"

#include <algorithm>

#include "core/base/trig.hpp"

namespace crspf {
namespace {

template <std::size_t N>
bool read_number(Bytes body, const char (&key)[N], std::uint32_t& value) {
    std::array<std::uint8_t, N - 1> bytes{};
    std::copy_n(key, N - 1, bytes.begin());
    const Bytes digits = scip_text_value(body, bytes);
    value = 0;
    if (digits.empty() || digits.size() > 8) {
        return false;
    }
    for (const std::uint8_t c : digits) {
        if (c < '0' || c > '9') {
            return false;
        }
        value = value * 10 + (c - std::uint32_t{'0'});
    }
    return true;
}

template <std::size_t N, std::size_t Size>
void read_text(Bytes body, const char (&key)[N], std::array<char, Size>& text) {
    std::array<std::uint8_t, N - 1> bytes{};
    std::copy_n(key, N - 1, bytes.begin());
    const Bytes value = scip_text_value(body, bytes);
    if (!value.empty()) {
        text = {};
        std::copy_n(value.begin(), std::min(value.size(), Size - 1), text.begin());
    }
}

bool is_no_return(ScipFamily family, std::uint32_t value) {
    switch (family) {
        case ScipFamily::kUrg: return value == 0 || value == 6;
        case ScipFamily::kUtm: return value == 1;
        case ScipFamily::kUst: return value == 65533 || value == 65535;
    }
    return false;
}

}  // namespace

void read_identity(Bytes body, ScipIdentity& identity) {
    read_text(body, "SERI:", identity.serial);
    read_text(body, "FIRM:", identity.firmware);
    read_text(body, "STAT:", identity.diagnosis);
}

bool read_sensor(Bytes body, ScipSensor& sensor) {
    sensor = ScipSensor{};
    constexpr std::array<std::uint8_t, 5> kModel{'M', 'O', 'D', 'L', ':'};
    const Bytes model = scip_text_value(body, kModel);
    std::copy_n(model.begin(), std::min(model.size(), sensor.model.size() - 1), sensor.model.begin());
    sensor.family = begins_with(model, "UTM")   ? ScipFamily::kUtm
                    : begins_with(model, "UST") ? ScipFamily::kUst
                                                : ScipFamily::kUrg;
    return read_number(body, "DMIN:", sensor.dmin_mm) && read_number(body, "DMAX:", sensor.dmax_mm) &&
           read_number(body, "ARES:", sensor.ares) && read_number(body, "AMIN:", sensor.amin) &&
           read_number(body, "AMAX:", sensor.amax) && read_number(body, "AFRT:", sensor.afrt) &&
           read_number(body, "SCAN:", sensor.scan_rpm) && sensor.dmin_mm < sensor.dmax_mm && sensor.ares > 0 &&
           sensor.ares <= 100'000 && sensor.amin < sensor.afrt && sensor.afrt < sensor.amax &&
           sensor.amax - sensor.amin <= sensor.ares && sensor.amax <= 9999 && sensor.scan_rpm > 0 &&
           sensor.scan_rpm <= 60'000;
}

void fill_scan(const ScipRanges& ranges, const ScipScanRequest& request, const ScipSensor& sensor, Scan& scan) {
    const std::uint32_t cluster = request.cluster_steps();
    const double step_rad = 2.0 * kPi / sensor.ares;
    const double first = request.start + 0.5 * (cluster - 1);
    scan.time_per_beam_s = sensor.step_s() * cluster;
    scan.angle_min_rad = (first - sensor.afrt) * step_rad;
    scan.angle_increment_rad = step_rad * cluster;
    scan.count = ranges.count;
    for (std::uint32_t i = 0; i < ranges.count; ++i) {
        const std::uint32_t value = ranges.range_mm[i];
        const bool hit = value >= sensor.dmin_mm && value <= sensor.dmax_mm;
        scan.range_m[i] = hit ? static_cast<float>(value) * 1e-3F : 0.0F;
        scan.beam[i] = hit ? Beam::kHit : is_no_return(sensor.family, value) ? Beam::kNoReturn : Beam::kInvalid;
    }
}

}  // namespace crspf
