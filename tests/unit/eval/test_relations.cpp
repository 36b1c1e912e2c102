#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <fstream>
#include <string>

#include "platform/capture/log_reader.hpp"
#include "platform/files/input_error.hpp"
#include "tests/unit/eval/recordings.hpp"
#include "tools/eval/relations.hpp"

using namespace crspf;
using namespace crspf::eval;

namespace {

/// A file in the folder for temporary files, gone at the end of the test.
class TemporaryFile {
 public:
    explicit TemporaryFile(const std::string& content)
        : path_(std::filesystem::temp_directory_path() / ("crspf_test_" + std::to_string(::getpid()) + ".relations")) {
        std::ofstream(path_, std::ios::binary) << content;
    }
    ~TemporaryFile() { std::filesystem::remove(path_); }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
    std::filesystem::path path_;
};

/// A curved drive with a pose every 0.1 s.
std::vector<TimedPose> drive() {
    std::vector<TimedPose> trajectory;
    Pose2 pose;
    for (int i = 0; i < 100; ++i) {
        trajectory.push_back({.stamp_s = 100.0 + 0.1 * i, .P_map_base = pose});
        pose = pose * Pose2{.x_m = 0.05, .y_m = 0.0, .theta_rad = 0.02};
    }
    return trajectory;
}

/// What `trajectory` says about itself, from each pose to the one `ahead` places on.
std::vector<Relation> relations_of(const std::vector<TimedPose>& trajectory, std::size_t ahead) {
    std::vector<Relation> relations;
    for (std::size_t i = 0; i + ahead < trajectory.size(); ++i) {
        const TimedPose& a = trajectory[i];
        const TimedPose& b = trajectory[i + ahead];
        relations.push_back(
            {.stamp1_s = a.stamp_s, .stamp2_s = b.stamp_s, .P_1_2 = inverse(a.P_map_base) * b.P_map_base});
    }
    return relations;
}

std::string failure(const std::string& content) {
    const TemporaryFile file(content);
    try {
        static_cast<void>(read_relations(file.path()));
    } catch (const InputError& e) {
        return std::string(e.what()).substr(file.path().string().size());
    }
    return "no error";
}

/// The poses of a log's own odometry, from the identity on, with the stamps as recorded.
std::vector<TimedPose> raw_odometry(const std::filesystem::path& log) {
    const auto reader = open_log(log, LidarParams{}, WheelEncoderParams{});
    std::vector<TimedPose> trajectory;
    Pose2 pose;
    LogEvent event;
    while (reader->next(event)) {
        if (event.kind == LogEvent::Kind::kMotion) {
            pose = pose * event.motion.P_previous_base;
        } else if (event.kind == LogEvent::Kind::kScan) {
            trajectory.push_back({.stamp_s = event.recorded_stamp_s, .P_map_base = pose});
        }
    }
    return trajectory;
}

}  // namespace

TEST_CASE("A trajectory has no error against its own relations", "[eval][relations]") {
    const auto trajectory = drive();
    const RelationErrors errors = relation_errors(trajectory, relations_of(trajectory, 30));
    CHECK(errors.translation_m.count == 70);
    CHECK(errors.skipped == 0);
    CHECK(errors.translation_m.max < 1e-9);
    CHECK(errors.rotation_deg.max < 1e-9);
}

TEST_CASE("Where the trajectory's frame lies makes no difference", "[eval][relations]") {
    const auto relations = relations_of(drive(), 30);
    auto moved = drive();
    for (TimedPose& pose : moved) {
        pose.P_map_base = Pose2{.x_m = 5.0, .y_m = -3.0, .theta_rad = 2.5} * pose.P_map_base;
    }
    CHECK(relation_errors(moved, relations).translation_m.max < 1e-9);
}

TEST_CASE("The order of the poses in the file makes no difference", "[eval][relations]") {
    const auto relations = relations_of(drive(), 30);
    auto shuffled = drive();
    std::reverse(shuffled.begin(), shuffled.begin() + 50);
    std::rotate(shuffled.begin(), shuffled.begin() + 33, shuffled.end());
    const RelationErrors errors = relation_errors(shuffled, relations);
    CHECK(errors.translation_m.count == 70);
    CHECK(errors.translation_m.max < 1e-9);
}

TEST_CASE("Known errors come out as they went in", "[eval][relations]") {
    const std::vector<TimedPose> trajectory = {
        {.stamp_s = 0.0, .P_map_base = {.x_m = 1.0, .y_m = 1.0, .theta_rad = kPi / 2.0}},
        {.stamp_s = 1.0, .P_map_base = {.x_m = 1.0, .y_m = 3.0, .theta_rad = kPi / 2.0}}};
    // True: 2 m ahead. The second relation says 2.3 m ahead and 0.4 m to the left, turned by -170 deg; the trajectory
    // is then wrong by 0.5 m and 170 deg.
    const std::vector<Relation> relations = {
        {.stamp1_s = 0.0, .stamp2_s = 1.0, .P_1_2 = {.x_m = 2.0}},
        {.stamp1_s = 0.0, .stamp2_s = 1.0, .P_1_2 = {.x_m = 2.3, .y_m = 0.4, .theta_rad = radians(-170.0)}}};
    const RelationErrors errors = relation_errors(trajectory, relations);
    CHECK(errors.translation_m.mean == Approx(0.25));
    CHECK(errors.translation_m.std == Approx(0.25));
    CHECK(errors.translation_m.max == Approx(0.5));
    CHECK(errors.translation_squared_m2.mean == Approx(0.125));
    CHECK(errors.rotation_deg.max == Approx(170.0));
    CHECK(errors.rotation_deg.mean == Approx(85.0));
    CHECK(errors.rotation_squared_deg2.mean == Approx(170.0 * 170.0 / 2.0));
}

TEST_CASE("A relation without a pose near either stamp is skipped and counted", "[eval][relations]") {
    const auto trajectory = drive();
    const std::vector<Relation> relations = {{.stamp1_s = 100.0, .stamp2_s = 101.0, .P_1_2 = {}},
                                             {.stamp1_s = 99.0, .stamp2_s = 101.0, .P_1_2 = {}},
                                             {.stamp1_s = 101.0, .stamp2_s = 110.5, .P_1_2 = {}}};
    const RelationErrors errors = relation_errors(trajectory, relations);
    CHECK(errors.translation_m.count == 1);
    CHECK(errors.skipped == 2);
    CHECK(relation_errors({}, relations).skipped == 3);
}

TEST_CASE("Relations are read with comments, blank lines and any line ending", "[eval][relations]") {
    const TemporaryFile file(
        "# t1 t2 dx dy dz roll pitch yaw\r\n"
        "\n"
        "  976052905.167303 976052911.885496 -0.5\t0.25 0 0 0 1.5\r\n"
        "1 2 3 4 0.0 -0.0 0 7");
    const auto relations = read_relations(file.path());
    REQUIRE(relations.size() == 2);
    CHECK(relations[0].stamp1_s == 976052905.167303);
    CHECK(relations[0].stamp2_s == 976052911.885496);
    CHECK(relations[0].P_1_2 == Pose2{.x_m = -0.5, .y_m = 0.25, .theta_rad = 1.5});
    CHECK(relations[1].P_1_2.theta_rad == Approx(7.0 - 2.0 * kPi));
}

TEST_CASE("What is not a relation is refused with its line", "[eval][relations]") {
    const std::string good = "1 2 3 4 0 0 0 0.5\n";
    CHECK(failure(good + "1 2 3 4 0 0 0\n").rfind(":2: ", 0) == 0);
    CHECK(failure(good + good + "1 2 3 4 0 0 0 0.5 9\n").rfind(":3: ", 0) == 0);
    CHECK(failure("1 2 3 4 0 0 0 nan\n").rfind(":1: ", 0) == 0);
    CHECK(failure("1 2 3m 4 0 0 0 0\n").rfind(":1: ", 0) == 0);
    CHECK(failure("1 2 3 4 0.1 0 0 0\n").find("plane") != std::string::npos);
    CHECK(failure("# nothing\n").find("no relations") != std::string::npos);
    CHECK(failure("").find("empty") != std::string::npos);
}

TEST_CASE("A file that cannot be read is refused by name", "[eval][relations]") {
    CHECK_THROWS_WITH(read_relations("/nonexistent/x.relations"), Catch::Contains("/nonexistent/x.relations"));
    CHECK_THROWS_AS(read_relations(std::filesystem::temp_directory_path()), InputError);
    // A gzip header with nothing behind it.
    const TemporaryFile cut(std::string("\x1f\x8b\x08\x00\x00\x00\x00\x00\x00\x03", 10));
    CHECK_THROWS_AS(read_relations(cut.path()), InputError);
}

TEST_CASE("The raw odometry of the Intel Research Lab is as wrong as it is known to be", "[eval][relations]") {
    const auto log = test::recording("carmen/intel.clf.xz");
    const auto truth = test::recording("carmen/intel.relations.xz");
    CRSPF_NEED_RECORDING(log)
    CRSPF_NEED_RECORDING(truth)
    const auto trajectory = raw_odometry(log);
    CHECK(trajectory.size() == 13631);
    const auto relations = read_relations(truth);
    CHECK(relations.size() == 2984);
    const RelationErrors errors = relation_errors(trajectory, relations);
    CHECK(errors.translation_m.count + errors.skipped == 2984);
    CHECK(errors.translation_m.mean == Approx(7.38).margin(0.02));
    CHECK(errors.rotation_deg.mean == Approx(39.3).margin(0.1));
}
