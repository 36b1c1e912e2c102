// The capture of a simulated run, heard by the drivers as from the field, must tell what was simulated.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "config/config.hpp"
#include "drivers/can/canopen.hpp"
#include "drivers/can/wheel_decoder.hpp"
#include "drivers/scip/scip_session.hpp"
#include "drivers/sick/sick_listener.hpp"
#include "drivers/velodyne/velodyne_assembler.hpp"
#include "drivers/velodyne/velodyne_scan.hpp"
#include "platform/capture/capture_reader.hpp"
#include "platform/capture/frames.hpp"
#include "tests/unit/sim/command.hpp"
#include "tests/unit/sim/recorder.hpp"
#include "tools/crspf/sim_config.hpp"
#include "tools/sim/capture_writer.hpp"
#include "tools/sim/velodyne_sweep.hpp"

namespace crspf {

namespace {

namespace fs = std::filesystem;
using test::content;
using test::TemporaryFolder;

constexpr const char* kComment = "the configuration";

/// The records, and the capture, of one drive.
class Drive final : public sim::LogWriter {
 public:
    Drive(const sim::Scene& scene, sim::SimulationParams params, const fs::path& file, const char* lidar_setting = "") {
        params.start_us = sim::kCaptureStart_us + sim::kStandstill_us;
        std::string text = cli::sim_config(params, false, true);
        if (const std::size_t at = text.find("[source.base]"); at != std::string::npos) {
            text.insert(at, lidar_setting);
        }
        config = parse_config(text, "the simulated robot");
        std::ofstream out(file, std::ios::binary);
        sim::CaptureWriter writer(params, config, kComment, [&](std::string_view bytes) {
            out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        });
        capture_ = &writer;
        result = test::run(scene, params, *this);
        writer.finish();
        capture_ = nullptr;  // NOLINT(*-prefer-member-initializer): it was the writer's address until now
        out.close();
        reader = open_capture(file);
    }

    void odometry(const sim::OdometryRecord& record, std::string& out) override {
        recorder.odometry(record, out);
        capture_->odometry(record, out);
    }
    void scan(const sim::ScanRecord& record, std::string& out) override {
        recorder.scan(record, out);
        capture_->scan(record, out);
    }
    void packet(const sim::PacketRecord& record, std::string& out) override { capture_->packet(record, out); }

    Config config;
    test::Recorder recorder;
    sim::SimulationResult result;
    std::unique_ptr<CaptureReader> reader;

 private:
    sim::CaptureWriter* capture_ = nullptr;
};

sim::SimulationParams ten_seconds(const std::string& lidar) {
    sim::SimulationParams params;
    params.lidar = sim::lidar_model(lidar);
    params.duration_s = 10.0;
    return params;
}

}  // namespace

TEST_CASE("capture: the conversation with a SCIP sensor gives the simulated scans, in their time") {
    for (const char* lidar : {"urg", "scan270"}) {
        CAPTURE(lidar);
        const TemporaryFolder folder;
        const sim::SimulationParams params = ten_seconds(lidar);
        Drive drive(sim::make_scene("office"), params, folder / "run.pcapng");
        const auto session = std::make_unique<ScipSession>(ScipParams{});
        const std::vector<test::Recorder::Scan>& scans = drive.recorder.scans();
        const double period_s = 1.0 / params.lidar.scan_rate_hz;
        std::size_t sent = 0;
        std::size_t seen = 0;
        double worst_s = 0.0;
        Stamp before;
        CaptureRecord record;
        while (drive.reader->next(record)) {
            REQUIRE(record.stamp >= before);
            before = record.stamp;
            if (drive.reader->sources().at(record.source).name != "lidar") {
                continue;
            }
            REQUIRE(record.link == LinkKind::kStream);
            session->on_time(record.stamp);
            if (record.direction == Direction::kSent) {
                // The same host would say the same again.
                const Bytes says = session->to_send();
                REQUIRE(std::vector(says.begin(), says.end()) == std::vector(record.bytes.begin(), record.bytes.end()));
                session->sent(record.stamp);
                ++sent;
            } else if (record.bytes.empty()) {
                session->on_open(record.stamp);
            }
            session->on_bytes(record.bytes, record.stamp, [&](const Scan& scan) {
                REQUIRE(seen < scans.size());
                const sim::ScanRecord& simulated = scans[seen].record;
                REQUIRE(scan.count == simulated.range_mm.size());
                CHECK(scan.angle_min_rad == Approx(params.lidar.angle_min_rad));
                CHECK(scan.angle_increment_rad == Approx(params.lidar.increment_rad));
                CHECK(scan.time_per_beam_s == Approx(params.lidar.time_per_beam_s()));
                for (std::uint32_t i = 0; i < scan.count; ++i) {
                    REQUIRE(session->listener().ranges().range_mm[i] ==
                            static_cast<std::uint32_t>(simulated.range_mm[i]));
                    const bool in_range = simulated.range_mm[i] * 1e-3 >= params.lidar.range_min_m &&
                                          simulated.range_mm[i] * 1e-3 <= params.lidar.range_max_m;
                    REQUIRE((scan.beam[i] == Beam::kHit) == in_range);
                }
                const double error_s = (scan.stamp - Stamp{simulated.stamp_us * 1000}).seconds();
                worst_s = std::max(worst_s, std::abs(error_s));
                ++seen;
            });
        }
        CHECK(drive.reader->comment() == kComment);
        CHECK(drive.reader->counts().unusable == 0);
        CHECK(sent > 15);  // QT PP TM0 10 TM1 TM2 BM MD
        CHECK(seen == scans.size());
        CHECK(static_cast<double>(seen) == Approx(10.0 / period_s).margin(1.5));
        CHECK(session->counters().failures == 0);
        CHECK(session->listener().counters().lost_scans == 0);
        CHECK(session->listener().counters().bad_stamps == 0);
        CHECK(worst_s < 2.5e-3);
        CHECK(worst_s > 0.0);
    }
}

TEST_CASE("capture: the conversation with a SICK gives the simulated scans, in their time, in either dialect") {
    struct Case {
        const char* lidar;
        const char* setting;
        ColaDialect dialect;
        int unit_mm;
    };
    for (const Case& one : {Case{"lms1xx", "dialect = \"ascii\"\n\n", ColaDialect::kAscii, 1},
                            Case{"lms5xx", "", ColaDialect::kBinary, 2}}) {
        CAPTURE(one.lidar);
        const TemporaryFolder folder;
        const sim::SimulationParams params = ten_seconds(one.lidar);
        Drive drive(sim::make_scene("hall"), params, folder / "run.pcapng", one.setting);
        const std::vector<test::Recorder::Scan>& scans = drive.recorder.scans();
        const auto listener = std::make_unique<SickListener>();
        const auto scan = std::make_unique<Scan>();
        SickClock clock;
        LidarParams believed;
        believed.range_min_m = params.lidar.range_min_m;
        believed.range_max_m = params.lidar.range_max_m;
        std::size_t seen = 1;  // the first follows from nothing, and is withheld
        double worst_s = 0.0;
        CaptureRecord record;
        while (drive.reader->next(record)) {
            if (record.link != LinkKind::kStream || record.direction == Direction::kSent) {
                continue;
            }
            if (record.bytes.empty()) {
                listener->on_open();
            }
            const auto visit = [&](const ColaTelegram& telegram, Stamp, const std::optional<SickTiming>& timing) {
                CHECK(telegram.dialect == one.dialect);
                if (!timing) {
                    return;
                }
                REQUIRE(fill_scan(listener->data(), believed, clock.beam0(*timing), *scan) == SickScanResult::kFilled);
                REQUIRE(seen < scans.size());
                const sim::ScanRecord& simulated = scans[seen].record;
                REQUIRE(scan->count == simulated.range_mm.size());
                CHECK(scan->angle_min_rad == Approx(params.lidar.angle_min_rad));
                CHECK(scan->angle_increment_rad == Approx(params.lidar.increment_rad));
                CHECK(scan->time_per_beam_s == Approx(params.lidar.time_per_beam_s()));
                for (std::uint32_t i = 0; i < scan->count; ++i) {
                    const int mm = simulated.range_mm[i];
                    if (std::abs(mm * 1e-3 - params.lidar.range_min_m) < one.unit_mm * 1e-3) {
                        continue;
                    }
                    const bool far = mm * 1e-3 >= params.lidar.range_max_m;
                    const Beam beam = far ? Beam::kNoReturn : mm == 0 ? Beam::kInvalid : Beam::kHit;
                    REQUIRE(scan->beam[i] == beam);
                    if (beam == Beam::kHit) {
                        REQUIRE(std::abs(static_cast<double>(scan->range_m[i]) - mm * 1e-3) < one.unit_mm * 1e-3);
                    }
                }
                const double error_s = (scan->stamp - Stamp{simulated.stamp_us * 1000}).seconds();
                worst_s = std::max(worst_s, std::abs(error_s));
                ++seen;
            };
            listener->on_bytes(record.bytes, record.stamp, visit);
        }
        CHECK(seen == scans.size());
        CHECK(listener->undecodable() + listener->sequence_counters().lost + listener->parser_counters().bad_sums == 0);
        CHECK(listener->sequence_counters().withheld == 1);
        CHECK(worst_s < 2.5e-3);
        CHECK(worst_s > 0.0);
    }
}

TEST_CASE("capture: the base's frames are the driven way, and the nodes live") {
    const TemporaryFolder folder;
    sim::SimulationParams params = test::ideal();
    params.duration_s = 10.0;
    Drive drive(sim::make_scene("office"), params, folder / "run.pcapng");
    WheelDecoder decoder(std::get<WheelParams>(drive.config.sources.at(0).can.odometer));
    std::array<HeartbeatWatch, 2> nodes{HeartbeatWatch(1, {1'200'000'000}), HeartbeatWatch(2, {1'200'000'000})};
    const std::vector<sim::OdometryRecord>& odometry = drive.recorder.odometry();
    Pose2 P_odom_base;
    std::size_t samples = 0;
    Stamp last;
    CaptureRecord record;
    while (drive.reader->next(record)) {
        CanFrame frame;
        if (can_of(record.link, record.bytes, frame) != FrameContent::kFound) {
            continue;
        }
        REQUIRE(record.direction == Direction::kReceived);
        last = record.stamp;
        for (HeartbeatWatch& node : nodes) {
            REQUIRE_FALSE(node.on_frame(frame, record.stamp));
        }
        if (const std::optional<DifferentialSample> sample = decoder.on_frame(frame, record.stamp)) {
            ++samples;
            const double turn_rad = (sample->right_m - sample->left_m) / params.robot.wheel_span_m;
            P_odom_base = P_odom_base * sim::arc((sample->left_m + sample->right_m) / 2.0, turn_rad);
        }
    }
    // 25 ticks of standing still, then the drive; the first pair is the reference.
    CHECK(samples == 25 + odometry.size() - 1);
    CHECK(decoder.counters().unpaired == 0);
    CHECK(decoder.counters().jumps == 0);
    CHECK(P_odom_base.x_m == Approx(odometry.back().P_odom_base.x_m).margin(1e-6));
    CHECK(P_odom_base.y_m == Approx(odometry.back().P_odom_base.y_m).margin(1e-6));
    CHECK(drive.result.driven_m > 3.0);
    CHECK(std::hypot(P_odom_base.x_m, P_odom_base.y_m) > 2.0);
    const double late_s = (last - Stamp{odometry.back().stamp_us * 1000}).seconds();
    CHECK(late_s > 0.0);
    CHECK(late_s < 0.005);
    for (const HeartbeatWatch& node : nodes) {
        CHECK(node.counters().heartbeats == 22);  // 10.5 s at 2 Hz, from the first moment on
        CHECK(node.operational(last));
    }
}

TEST_CASE("capture: its DBC texts stand in the project's own DBC files") {
    for (const auto& [odometer, name] :
         {std::pair{sim::Odometer::kWheels, "canopen_402.dbc"}, std::pair{sim::Odometer::kImu, "xsens_mti.dbc"}}) {
        sim::SimulationParams params = ten_seconds("urg");
        params.odometer = odometer;
        const std::string text = cli::sim_config(params, false, true);
        const std::string file = content(fs::path(CRSPF_SOURCE_DIR) / "config/dbc" / name);
        std::istringstream lines{text};
        int found = 0;
        for (std::string line; std::getline(lines, line);) {
            const bool own = line.find("Speed") != std::string::npos || line.find("Steering") != std::string::npos;
            if (line.starts_with(" SG_ ") && !own) {
                CAPTURE(line);
                CHECK(file.find(line + "\n") != std::string::npos);
                ++found;
            }
        }
        CHECK(found >= 2);
    }
}

TEST_CASE("capture: a Velodyne's points lie on walls, ground and kerbs") {
    const TemporaryFolder folder;
    const std::string lidar = GENERATE(as<std::string>{}, "velodyne", "hdl32e");
    CAPTURE(lidar);
    sim::SimulationParams params = ten_seconds(lidar);
    const VelodyneModel model = params.lidar.velodyne;
    params.duration_s = 4.0;
    params.P_base_lidar = {.x_m = 0.1, .y_m = 0.05, .theta_rad = 0.2};
    const sim::Scene scene = test::room(16.0, 12.0);
    const sim::World3d world(scene, sim::Terrain{});
    REQUIRE_FALSE(world.islands().empty());
    Drive drive(scene, params, folder / "run.pcapng");
    const std::vector<TimedPose>& truth = drive.result.truth;
    REQUIRE(truth.size() == 40);
    const auto assembler = std::make_unique<VelodyneAssembler>(VelodyneParams{.model = model});
    const auto scanner = std::make_unique<VelodyneScanner>(VelodyneScanParams{}, model,
                                                           nominal_calibration(model).value_or(VelodyneCalibration{}));
    const auto scan = std::make_unique<Scan>();
    double worst_s = 0.0;
    std::size_t revolutions = 0;
    std::size_t positions = 0;
    std::size_t points = 0;
    std::size_t on_walls = 0;
    std::size_t on_ground = 0;
    std::size_t on_kerbs = 0;
    std::size_t nowhere = 0;
    std::size_t nowhere_if_shifted = 0;  // the control: half a metre off must be seen
    // Nearest surface to a point of the world, at the given height above the slope.
    const auto off_m = [&](sim::Point p, double above_m, bool count) {
        const double wall_m = above_m < 2.6 ? scene.world.clearance(p, 1.0) : 1.0;
        const double ground_m = std::abs(above_m);
        double kerb_m = 1.0;
        for (const sim::Island& i : world.islands()) {
            const double dx = std::max({i.lower.x_m - p.x_m, p.x_m - i.upper.x_m, 0.0});
            const double dy = std::max({i.lower.y_m - p.y_m, p.y_m - i.upper.y_m, 0.0});
            const double aside_m = std::hypot(dx, dy);
            // Its top, or its side.
            kerb_m = std::min(kerb_m, std::max(aside_m, std::abs(above_m - sim::World3d::kKerbHeight_m)));
            kerb_m = above_m < sim::World3d::kKerbHeight_m ? std::min(kerb_m, std::max(aside_m, 0.0)) : kerb_m;
        }
        if (count) {
            on_walls += wall_m < std::min(ground_m, kerb_m) ? 1U : 0U;
            on_ground += ground_m < std::min(wall_m, kerb_m) ? 1U : 0U;
            on_kerbs += kerb_m < std::min(wall_m, ground_m) ? 1U : 0U;
        }
        return std::min({wall_m, ground_m, kerb_m});
    };
    const auto pose_at = [&](double stamp_s) {
        const double at = std::clamp((stamp_s - truth.front().stamp_s) * 10.0, 0.0, 38.999);
        const auto i = static_cast<std::size_t>(at);
        return interpolate(truth[i].P_map_base, truth[i + 1].P_map_base, at - std::floor(at));
    };
    auto visit = [&](const VelodyneCloud& cloud) {
        if (!cloud.complete) {
            return;
        }
        ++revolutions;
        CHECK(cloud.missing_columns == 0);
        // Beam 0 of a planar scan is measured last, when the head comes to the cut again.
        REQUIRE(scanner->scan(cloud, VelodyneParams{}.cut_rad, *scan));
        const double scan_s = static_cast<double>(scan->stamp.ns) * 1e-9;
        worst_s = std::max(worst_s, std::abs(scan_s - truth.at(revolutions + 1).stamp_s));
        for (std::uint32_t column = 0; column < cloud.columns; column += 3) {
            const double stamp_s = static_cast<double>(cloud.stamp[column].ns) * 1e-9;
            const Pose2 P_world_base = pose_at(stamp_s);
            const sim::Frame base =
                sim::frame_on(world.terrain(), P_world_base, params.robot.wheel_base_m, params.robot.wheel_span_m);
            for (std::uint32_t laser = 0; laser < cloud.lasers; ++laser) {
                const std::size_t i = cloud.at(column, laser);
                if (cloud.beam[i] != Beam::kHit) {
                    continue;
                }
                const Pose2 in_base = params.P_base_lidar * Pose2{.x_m = static_cast<double>(cloud.x_m[i]),
                                                                  .y_m = static_cast<double>(cloud.y_m[i]),
                                                                  .theta_rad = 0.0};
                const Vector3 p =
                    base.origin +
                    base.turned({.x = in_base.x_m,
                                 .y = in_base.y_m,
                                 .z = sim::RobotParams{}.lidar_height_m + static_cast<double>(cloud.z_m[i])});
                const sim::Point at{p.x, p.y};
                const double above_m = p.z - world.terrain().height_m(at);
                ++points;
                nowhere += off_m(at, above_m, true) > 0.12 ? 1U : 0U;
                nowhere_if_shifted += off_m({at.x_m + 0.5, at.y_m + 0.5}, above_m + 0.5, false) > 0.12 ? 1U : 0U;
            }
        }
    };
    CaptureRecord record;
    while (drive.reader->next(record)) {
        UdpDatagram datagram;
        if (udp_of(record.link, record.bytes, datagram) != FrameContent::kFound) {
            continue;
        }
        REQUIRE(datagram.destination_address == 0xFFFFFFFF);
        if (datagram.destination_port == sim::kVelodyneDataPort) {
            assembler->on_data(datagram.payload, datagram.source_address, record.stamp, visit);
        } else {
            REQUIRE(datagram.destination_port == sim::kVelodynePositionPort);
            REQUIRE(assembler->on_position(datagram.payload, datagram.source_address));
            ++positions;
        }
    }
    const VelodyneCounters& counters = assembler->counters();
    CHECK(counters.packets == (model == VelodyneModel::kVlp16 ? 3014 : 7233));  // 4 s of 1.327 or 0.553 ms each
    CHECK(counters.foreign + counters.bad_flag + counters.bad_azimuth + counters.lost + counters.breaks == 0);
    CHECK(positions == 4);
    CHECK(worst_s < 1e-3);
    CHECK(revolutions == 38);  // whose both ends were seen
    CAPTURE(points, on_walls, on_ground, on_kerbs, nowhere, nowhere_if_shifted);
    CHECK(points > 200'000);
    CHECK(on_walls > 100'000);
    CHECK(on_ground > 20'000);
    CHECK(on_kerbs > 500);
    CHECK(static_cast<double>(nowhere) < 0.001 * static_cast<double>(points));
    CHECK(static_cast<double>(nowhere_if_shifted) > 0.3 * static_cast<double>(points));
}

}  // namespace crspf
