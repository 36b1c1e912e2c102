// A real car's bus: an IMU on it at 100 Hz, GNSS at 1 Hz, replies of OBD-II.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/trig.hpp"
#include "core/odometry/odometry.hpp"
#include "drivers/can/dbc_reader.hpp"
#include "drivers/can/motion_decoders.hpp"
#include "platform/capture/capture_reader.hpp"
#include "platform/capture/frames.hpp"
#include "tests/support/heap_guard.hpp"
#include "tests/unit/drivers/can/can_files.hpp"
#include "tests/unit/eval/recordings.hpp"

using namespace crspf;
using namespace crspf::test;

namespace {

struct LoggedFrame {
    Stamp stamp;
    std::string interface;
    CanFrame frame;
};

std::vector<LoggedFrame> read_log(const std::filesystem::path& file) {
    std::vector<LoggedFrame> out;
    const auto capture = open_capture(file);
    CaptureRecord record;
    while (capture->next(record)) {
        LoggedFrame logged;
        REQUIRE(can_of(record.link, record.bytes, logged.frame) == FrameContent::kFound);
        logged.stamp = record.stamp;
        logged.interface = capture->sources().at(record.source).name;
        out.push_back(logged);
    }
    CHECK(capture->counts().unusable == 0);
    return out;
}

/// East and north of a place a few kilometres around the first one. [m]
struct LocalMap {
    double latitude_deg;
    double longitude_deg;

    [[nodiscard]] Pose2 place(double latitude, double longitude) const {
        constexpr double kMetresPerDegree = 111'320.0;
        return {.x_m = (longitude - longitude_deg) * kMetresPerDegree * sin_cos(radians(90.0 - latitude_deg)).sin,
                .y_m = (latitude - latitude_deg) * kMetresPerDegree,
                .theta_rad = 0.0};
    }
};

}  // namespace

TEST_CASE("car log: every frame is read, and decodes by its DBC file") {
    const auto file = recording("can/car_imu.candump.log.xz");
    const auto dbc = recording("can/canmod-gps.dbc");
    CRSPF_NEED_RECORDING(file);
    CRSPF_NEED_RECORDING(dbc);
    const std::string text = file_text(dbc);
    struct Message {
        std::uint16_t bytes = 0;
        std::vector<CanSignal> signals;
    };
    std::map<std::uint32_t, Message> messages;
    DbcReader reader(text);
    DbcReader::Item item = reader.next();
    for (; item != DbcReader::Item::kEnd && item != DbcReader::Item::kError; item = reader.next()) {
        if (item == DbcReader::Item::kMessage) {
            messages[reader.message().id].bytes = reader.message().bytes;
        } else if (item == DbcReader::Item::kSignal) {
            messages[reader.message().id].signals.push_back(reader.signal().layout);
        }
    }
    REQUIRE(item == DbcReader::Item::kEnd);
    CHECK(messages.size() == 9);

    std::uint64_t of_gnss = 0;
    std::uint64_t of_obd = 0;
    std::uint64_t others = 0;
    std::uint64_t values = 0;
    std::uint64_t wrong = 0;
    for (const LoggedFrame& line : read_log(file)) {
        if (line.interface == "can1") {
            // Replies of the car's diagnostics: to 11-bit requests 0x7E8, and to 29-bit ones.
            of_obd += line.frame.id == 0x7E8 || (line.frame.extended && line.frame.id == 0x17F00010) ? 1U : 0U;
            others += line.frame.id == 0x7E8 || line.frame.id == 0x17F00010 ? 0U : 1U;
            continue;
        }
        const auto message = messages.find(line.frame.id);
        if (message == messages.end()) {
            ++others;
            continue;
        }
        ++of_gnss;
        wrong += line.frame.length == message->second.bytes ? 0U : 1U;
        for (const CanSignal& signal : message->second.signals) {
            const auto value = decode(signal, line.frame.payload());
            const bool within = value && *value >= signal.minimum - 1e-6 && *value <= signal.maximum + 1e-6;
            wrong += within ? 0U : 1U;
            ++values;
            if (value) {  // and back to the same bits
                CanFrame again = line.frame;
                wrong += encode(signal, again.data, *value) && again == line.frame ? 0U : 1U;
            }
        }
    }
    std::cout << "car log: " << of_gnss << " frames of the sensor, " << of_obd << " of diagnostics, " << values
              << " values\n";
    CHECK(of_gnss + of_obd == 73799);
    CHECK(of_obd == 8459);
    CHECK(others == 0);
    CHECK(wrong == 0);
}

// The sensor stands on edge: at rest it feels +9.7 m/s^2 along its x axis, so x points up, and a positive rate about x
// is counter-clockwise seen from above: yaw rate = +AngularRateX. The car never stands still in this log; the
// gyroscope's bias (steps of 0.25 deg/s) is taken from the GNSS heading of the first 100 s.
TEST_CASE("car log: yaw rate and speed integrated by the odometry follow the GNSS track") {
    const auto file = recording("can/car_imu.candump.log.xz");
    const auto dbc = recording("can/canmod-gps.dbc");
    CRSPF_NEED_RECORDING(file);
    CRSPF_NEED_RECORDING(dbc);
    const std::string text = file_text(dbc);
    const std::vector<LoggedFrame> log = read_log(file);
    const FrameSignal gravity = signal_of(text, "gnss_imu", "AccelerationX");
    const FrameSignal heading = signal_of(text, "gnss_attitude", "Heading");
    const FrameSignal latitude = signal_of(text, "gnss_pos", "Latitude");
    const FrameSignal longitude = signal_of(text, "gnss_pos", "Longitude");

    const auto drive = [&](const char* axis, double bias_radps, double& turned_rad, double until_s) {
        ImuParams params;
        params.speed.emplace().signal.signal = signal_of(text, "gnss_speed", "Speed");
        params.speed->signal.validity = signal_of(text, "gnss_speed", "SpeedValid");
        params.speed->signal.timeout = Duration::from_seconds(2.5);
        params.yaw_rate.signal = signal_of(text, "gnss_imu", axis);
        params.yaw_rate.scale = kPi / 180.0;
        params.yaw_rate.validity = signal_of(text, "gnss_imu", "ImuValid");
        params.yaw_rate_bias_radps = bias_radps;
        ImuDecoder decoder(params);
        const auto odometry = std::make_unique<Odometry>(OdometryParams{});
        struct Result {
            double error_m = 0.0;  ///< at the end
            double travelled_m = 0.0;
            double heading_rad = 0.0;  ///< odometry less GNSS at the end
            double gnss_turned_rad = 0.0;
            double seconds = 0.0;
            std::uint64_t samples = 0;
            std::uint64_t heap_calls = 0;
        } result;
        std::optional<LocalMap> map;
        std::optional<double> heading_before;
        std::optional<Stamp> begin;
        Stamp last;
        turned_rad = 0.0;
        for (const LoggedFrame& line : log) {
            if (line.interface != "can2" || (begin && (line.stamp - *begin).seconds() > until_s)) {
                continue;
            }
            const HeapGuard guard;
            const std::optional<ImuSample> sample = decoder.on_frame(line.frame, line.stamp);
            result.heap_calls += guard.calls();
            if (const auto north_cw_deg = value_in(heading, line.frame)) {
                const double east_ccw_rad = radians(90.0 - *north_cw_deg);
                if (heading_before) {
                    result.gnss_turned_rad += wrap_angle(east_ccw_rad - *heading_before);
                } else {
                    odometry->set_pose({.x_m = 0.0, .y_m = 0.0, .theta_rad = wrap_angle(east_ccw_rad)});
                    begin = line.stamp;
                    last = line.stamp;
                }
                heading_before = east_ccw_rad;
                result.heading_rad = wrap_angle(odometry->pose().theta_rad - east_ccw_rad);
            }
            if (begin && sample) {
                odometry->add(*sample);
                turned_rad += sample->yaw_rate_radps * (line.stamp - last).seconds();
                result.travelled_m += sample->speed_mps * (line.stamp - last).seconds();
                last = line.stamp;
                ++result.samples;
            }
            const auto at_latitude = value_in(latitude, line.frame);
            const auto at_longitude = value_in(longitude, line.frame);
            if (begin && at_latitude && at_longitude) {
                if (!map) {
                    map = LocalMap{.latitude_deg = *at_latitude, .longitude_deg = *at_longitude};
                    odometry->set_pose({.x_m = 0.0, .y_m = 0.0, .theta_rad = odometry->pose().theta_rad});
                }
                const Pose2 gnss = map->place(*at_latitude, *at_longitude);
                const Pose2 here = odometry->pose();
                result.error_m = std::hypot(here.x_m - gnss.x_m, here.y_m - gnss.y_m);
            }
        }
        result.seconds = begin ? (last - *begin).seconds() : 0.0;
        return result;
    };

    double gravity_sum = 0.0;
    std::uint64_t gravity_count = 0;
    for (const LoggedFrame& line : log) {
        if (const auto value = line.interface == "can2" ? value_in(gravity, line.frame) : std::nullopt) {
            gravity_sum += *value;
            ++gravity_count;
        }
    }
    CHECK(gravity_sum / static_cast<double>(gravity_count) == Approx(9.81).margin(0.5));  // x points up

    constexpr double kAll = std::numeric_limits<double>::infinity();
    double turned = 0.0;
    const auto first = drive("AngularRateX", 0.0, turned, 100.0);
    const double bias = (turned - first.gnss_turned_rad) / first.seconds;
    const auto raw = drive("AngularRateX", 0.0, turned, kAll);
    const auto corrected = drive("AngularRateX", bias, turned, kAll);
    const auto wrong_axis = drive("AngularRateZ", bias, turned, kAll);
    std::cout << "car log: " << corrected.travelled_m << " m in " << corrected.seconds << " s; end error "
              << corrected.error_m << " m = " << 100.0 * corrected.error_m / corrected.travelled_m << " %, heading "
              << degrees(corrected.heading_rad) << " deg, with a bias of " << degrees(bias)
              << " deg/s found in the first 100 s; without it " << raw.error_m << " m; by the z axis "
              << wrong_axis.error_m << " m\n";
    CHECK(corrected.samples > 60000);
    CHECK(corrected.travelled_m == Approx(11'600).margin(1000));
    CHECK(corrected.error_m < 0.25 * corrected.travelled_m);
    // The test can tell: another axis, or no bias, ends much farther off.
    CHECK(wrong_axis.error_m > 2.0 * corrected.error_m);
    CHECK(raw.error_m > corrected.error_m);
    if (HeapGuard::available()) {
        CHECK(corrected.heap_calls == 0);
    }
}
