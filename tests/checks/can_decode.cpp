// usage: can_decode DBC LOG [INTERFACE]   prints what our drivers make of a candump log: "id signal raw value" a line
//        can_decode --poses               prints a candump log of poses as the service sends them
//        can_decode --base CONFIG         prints one of what the simulated base of a configuration says
// For dbc_against_candied.sh, which holds it against another program's word.
#include <bit>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "config/config.hpp"
#include "core/base/rng.hpp"
#include "drivers/can/dbc_reader.hpp"
#include "drivers/can/pose_frames.hpp"
#include "platform/capture/capture_reader.hpp"
#include "platform/capture/frames.hpp"
#include "tools/sim/base_bus.hpp"
#include "tools/sim/carried.hpp"

using namespace crspf;

namespace {

void print_frame(double stamp_s, const CanFrame& frame) {
    std::printf("(%.6f) can0 %03X#", stamp_s, frame.id);
    for (const std::uint8_t byte : frame.payload()) {
        std::printf("%02X", byte);
    }
    std::puts("");
}

int print_poses() {
    PoseEncoder encoder;
    Rng rng(4);
    for (int i = 0; i < 2000; ++i) {
        PoseReport report;
        report.P_map_base = {
            .x_m = 9000 * rng.symmetric(), .y_m = 9000 * rng.symmetric(), .theta_rad = 3 * rng.symmetric()};
        report.speed_mps = 40 * rng.symmetric();
        report.yaw_rate_radps = rng.symmetric();
        report.covariance = {.xx = 1 + rng.symmetric(), .xy = rng.symmetric(), .yy = 1 + rng.symmetric(), .tt = 0.1};
        report.M = 1500 + 1500 * rng.symmetric();
        report.age = Duration::from_seconds(0.05);
        report.matched = rng.next() % 2 == 0;
        report.lost = rng.next() % 2 == 0;
        report.resets = static_cast<std::uint8_t>(rng.next() % 256);
        const auto frames = encoder.encode(report);
        for (const CanFrame& frame : frames.value()) {
            print_frame(0.025 * i, frame);
        }
    }
    return 0;
}

int print_base(const char* file) {
    const Config config = load_config(file);
    sim::BaseBus bus(sim::carried(config).base->can, config.slam.odometry, sim::SimulationParams{},
                     [](Stamp stamp, const CanFrame& frame) { print_frame((stamp - Stamp{}).seconds(), frame); });
    Rng rng(4);
    sim::OdometryRecord odometry;
    for (int i = 0; i < 500; ++i) {
        odometry.speed_mps = 30 * rng.symmetric();
        odometry.turn_rate_radps = rng.symmetric();
        odometry.counts = {.left = static_cast<std::int64_t>(1e9 * rng.symmetric()),
                           .right = static_cast<std::int64_t>(1e9 * rng.symmetric())};
        odometry.imu = {.rate_radps = {.x = rng.symmetric(), .y = rng.symmetric(), .z = rng.symmetric()},
                        .force_mps2 = {.x = rng.symmetric(), .y = rng.symmetric(), .z = 10 * rng.symmetric()}};
        odometry.curvature = rng.symmetric();
        bus.send(Stamp{} + Duration::from_seconds(0.02 * i), odometry);
    }
    return 0;
}

struct Named {
    std::string name;
    CanSignal layout;
};

int print_values(const char* dbc, const char* log, std::string_view interface) {
    std::ifstream in(dbc, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    std::map<std::uint32_t, std::vector<Named>> messages;
    DbcReader reader(text);
    DbcReader::Item item = reader.next();
    for (; item != DbcReader::Item::kEnd && item != DbcReader::Item::kError; item = reader.next()) {
        if (item == DbcReader::Item::kSignal) {
            messages[reader.message().id].push_back({std::string(reader.signal().name), reader.signal().layout});
        }
    }
    if (item == DbcReader::Item::kError) {
        std::cerr << dbc << ':' << reader.error().line << ": " << reader.error().reason << '\n';
        return 1;
    }
    const auto capture = open_capture(log);
    CaptureRecord record;
    while (capture->next(record)) {
        CanFrame frame;
        if (can_of(record.link, record.bytes, frame) != FrameContent::kFound) {
            continue;
        }
        const auto message = messages.find(frame.id);
        if (message == messages.end() ||
            (!interface.empty() && capture->sources().at(record.source).name != interface)) {
            continue;
        }
        for (const Named& signal : message->second) {
            const std::uint64_t raw = extract_bits(signal.layout, frame.payload());
            CanSignal bare = signal.layout;
            bare.factor = 1.0;
            bare.offset = 0.0;
            // Hexadecimal floats would be exact, too, but JavaScript does not read them; 17 digits are.
            std::printf("%u %s %.17g %.17g\n", frame.id, signal.name.c_str(), value_of(bare, raw),
                        value_of(signal.layout, raw));
        }
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc == 2 && std::string_view(argv[1]) == "--poses") {
        return print_poses();
    }
    if (argc == 3 && std::string_view(argv[1]) == "--base") {
        return print_base(argv[2]);
    }
    if (argc != 3 && argc != 4) {
        std::cerr << "usage: can_decode DBC LOG [INTERFACE] | --poses | --base CONFIG\n";
        return 2;
    }
    return print_values(argv[1], argv[2], argc == 4 ? argv[3] : "");
} catch (const std::exception& e) {
    std::fprintf(stderr, "can_decode: %s\n", e.what());
    return 1;
}
