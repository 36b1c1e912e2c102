#include "tools/sim/stream_sensor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "config/capacities.hpp"
#include "core/base/trig.hpp"
#include "drivers/scip/scip_device.hpp"
#include "drivers/sick/sick_device.hpp"
#include "platform/files/input_error.hpp"

namespace crspf::sim {
namespace {

using ByteVector = std::vector<std::uint8_t>;

constexpr std::size_t kReplyBytes = 16384;         // more than any reply
constexpr double kScipDistanceMax_mm = 65'000.0;   // a UST's codes begin at 65533
constexpr double kSickDistanceMax_mm = 130'000.0;  // 16 bit of 2 mm

std::uint32_t rounded(double value) {
    return static_cast<std::uint32_t>(std::floor(value + 0.5));
}

ScipSensor scip_sensor_of(const LidarModel& model) {
    const bool urg = model.name == "urg";
    const std::string_view name = urg ? "URG-04LX-UG01(simulated)" : "UST-10LX(simulated)";
    if (model.range_max_m * 1000.0 > kScipDistanceMax_mm) {
        throw InputError("--max-range: this sensor's protocol counts to 65 m; give less");
    }
    ScipSensor sensor;
    std::copy(name.begin(), name.end(), sensor.model.begin());
    sensor.dmin_mm = rounded(model.range_min_m * 1000.0);
    sensor.dmax_mm = rounded(model.range_max_m * 1000.0);
    sensor.ares = rounded(2.0 * kPi / model.increment_rad);
    sensor.amin = urg ? 44 : 0;
    sensor.amax = sensor.amin + model.beams - 1;
    sensor.afrt = sensor.amin + rounded(-model.angle_min_rad / model.increment_rad);
    sensor.scan_rpm = rounded(60.0 / model.revolution_s);
    sensor.family = urg ? ScipFamily::kUrg : ScipFamily::kUst;
    return sensor;
}

class Hokuyo final : public StreamSensor {
 public:
    explicit Hokuyo(const LidarModel& model)
        : sensor_(scip_sensor_of(model)), device_({.sensor = sensor_, .starts_in_scip1 = false}) {
        device_.power_on({});
    }

    [[nodiscard]] std::string name() const override { return sensor_.model.data(); }
    void on_connect() override {}
    [[nodiscard]] ByteVector on_bytes(std::span<const std::uint8_t> bytes, Stamp now) override {
        return said([&](ByteWriter& out) { device_.on_bytes(bytes, now, out); });
    }
    [[nodiscard]] ByteVector on_sweep(Stamp begin, Stamp /*end*/, std::span<const int> range_mm) override {
        std::vector<std::uint32_t> steps(sensor_.amin, 0);
        steps.insert(steps.end(), range_mm.begin(), range_mm.end());
        const Stamp step0 = begin - Duration::from_seconds(sensor_.amin * sensor_.step_s());
        return said([&](ByteWriter& out) { device_.on_revolution(step0, steps, {}, out); });
    }

 private:
    template <typename Act>
    [[nodiscard]] ByteVector said(Act act) {
        std::array<std::uint8_t, kReplyBytes> buffer{};
        ByteWriter out(buffer);
        act(out);
        return {out.written().begin(), out.written().end()};
    }

    ScipSensor sensor_;
    ScipDevice device_;
};

class Sick final : public StreamSensor {
 public:
    Sick(const SickParams& params, const LidarModel& model)
        : model_(model),
          unit_mm_(model.range_max_m > 65.0 ? 2 : 1),
          device_({.dialect = params.dialect == SickDialect::kAscii ? ColaDialect::kAscii : ColaDialect::kBinary}, {}) {
        if (model.range_max_m * 1000.0 > kSickDistanceMax_mm) {
            throw InputError("--max-range: this sensor's telegrams count to 130 m; give less");
        }
        if (model.beams > capacity::kBeams) {
            throw InputError("resolution_deg: a scan of " + std::to_string(model.beams) + " beams is more than the " +
                             std::to_string(capacity::kBeams) + " that the program takes; give more");
        }
        const double step_deg = degrees(model.increment_rad);
        LmdScandata& data = device_.measurement();
        data.scan_frequency_centihertz = rounded(100.0 * model.scan_rate_hz);
        data.beam_frequency_hectohertz = rounded(0.01 * 360.0 / step_deg / model.revolution_s);
        data.channels16 = 1;
        data.channel[0] = {
            .name = {'D', 'I', 'S', 'T', '1'},
            .scale = static_cast<float>(unit_mm_),
            .start_1e4deg = static_cast<std::int32_t>(std::floor((degrees(model.angle_min_rad) + 90.0) * 1e4 + 0.5)),
            .step_1e4deg = static_cast<std::int16_t>(rounded(step_deg * 1e4)),
            .count = static_cast<std::uint16_t>(model.beams)};
    }

    [[nodiscard]] std::string name() const override {
        return (model_.name == "lms1xx" ? "LMS1xx" : "LMS5xx") + std::string(", simulated");
    }
    void on_connect() override { device_.on_connect(); }
    [[nodiscard]] ByteVector on_bytes(std::span<const std::uint8_t> bytes, Stamp now) override {
        device_.on_bytes(bytes, now);
        return said();
    }
    [[nodiscard]] ByteVector on_sweep(Stamp begin, Stamp end, std::span<const int> range_mm) override {
        const int no_return_mm = static_cast<int>(rounded(1000.0 * model_.range_max_m));
        LmdScandata& data = device_.measurement();
        std::transform(range_mm.begin(), range_mm.end(), data.values.begin(), [&](int mm) {
            return static_cast<std::uint16_t>(mm >= no_return_mm ? 0 : std::max(mm / unit_mm_, 1));
        });
        device_.on_sweep(begin, end);
        return said();
    }

 private:
    [[nodiscard]] ByteVector said() {
        ByteVector bytes(device_.output().begin(), device_.output().end());
        device_.clear_output();
        return bytes;
    }

    LidarModel model_;
    int unit_mm_;
    SickDevice device_;
};

}  // namespace

std::unique_ptr<StreamSensor> stream_sensor(const SourceConfig& source, const LidarModel& model) {
    switch (model.driver) {
        case SourceDriver::kScip: return std::make_unique<Hokuyo>(model);
        case SourceDriver::kSick: return std::make_unique<Sick>(source.sick, model);
        case SourceDriver::kLms2xx:
        case SourceDriver::kLd06:
        case SourceDriver::kVelodyne:
        case SourceDriver::kCan:
        case SourceDriver::kMotion: break;
    }
    throw InputError("--lidar " + model.name + ": captures hold urg, scan270, lms1xx, lms5xx, velodyne or hdl32e");
}

}  // namespace crspf::sim
