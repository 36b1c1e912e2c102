#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/rng.hpp"
#include "platform/files/input_error.hpp"
#include "platform/service/velodyne_calibration.hpp"
#include "tests/unit/platform/scratch.hpp"
#include "tests/unit/platform/velodyne_db_xml.hpp"

using namespace crspf;

namespace {

constexpr VelodyneModel kModel = VelodyneModel::kHdl64eS2;

VelodyneCalibration random_calibration() {
    Rng rng(7);
    VelodyneCalibration calibration{};
    for (VelodyneLaser& l : calibration) {
        l = {.vertical_rad = 0.4 * rng.symmetric(),
             .rotation_rad = 0.17 * rng.symmetric(),
             .distance_m = 1.4 + 0.2 * rng.symmetric(),
             .distance_x_m = 1.4 + 0.2 * rng.symmetric(),
             .distance_y_m = 1.4 + 0.2 * rng.symmetric(),
             .vertical_offset_m = 0.2 * rng.symmetric(),
             .horizontal_offset_m = 0.026 * rng.symmetric(),
             .focal_distance_m = 10.0 + 5.0 * rng.symmetric(),
             .focal_slope = 1.0 + rng.symmetric(),
             .min_intensity = static_cast<std::uint8_t>(rng.next() % 100),
             .max_intensity = static_cast<std::uint8_t>(150 + rng.next() % 106)};
    }
    return calibration;
}

std::string sound() {
    return test::velodyne_db_xml(random_calibration(), 64);
}

/// The first of it replaced.
std::string with(std::string text, const std::string& what, const std::string& instead) {
    const std::size_t at = text.find(what);
    REQUIRE(at != std::string::npos);
    return text.replace(at, what.size(), instead);
}

/// Between the `n`-th of this tag and the next one.
std::string with_value(std::string text, const std::string& tag, const std::string& value, int n = 0) {
    std::size_t at = text.find(tag);
    for (; n > 0; --n) {
        at = text.find(tag, at + 1);
    }
    REQUIRE(at != std::string::npos);
    const std::size_t begin = at + tag.size();
    return text.replace(begin, text.find('<', begin) - begin, value);
}

std::string error_of(const std::string& text, VelodyneModel model = kModel) {
    try {
        static_cast<void>(parse_velodyne_calibration(text, "db.xml", model));
    } catch (const InputError& e) {
        return e.what();
    }
    return "";
}

/// Of the first line that holds `what`.
std::string at_line(const std::string& text, const std::string& what) {
    const std::size_t end = text.find(what);
    REQUIRE(end != std::string::npos);
    int line = 1;
    for (std::size_t i = 0; i < end; ++i) {
        line += text[i] == '\n' ? 1 : 0;
    }
    return "db.xml:" + std::to_string(line) + ": ";
}

}  // namespace

TEST_CASE("velodyne calibration: what was written is read") {
    const VelodyneCalibration written = random_calibration();
    const VelodyneCalibration read = parse_velodyne_calibration(sound(), "db.xml", kModel);
    for (std::uint32_t i = 0; i < kVelodyneLasers; ++i) {
        const VelodyneLaser& a = written[i];
        const VelodyneLaser& b = read[i];
        const std::vector<double> differences = {a.vertical_rad - b.vertical_rad,
                                                 a.rotation_rad - b.rotation_rad,
                                                 a.distance_m - b.distance_m,
                                                 a.distance_x_m - b.distance_x_m,
                                                 a.distance_y_m - b.distance_y_m,
                                                 a.vertical_offset_m - b.vertical_offset_m,
                                                 a.horizontal_offset_m - b.horizontal_offset_m,
                                                 a.focal_distance_m - b.focal_distance_m,
                                                 a.focal_slope - b.focal_slope};
        for (const double difference : differences) {
            CHECK(std::abs(difference) < 1e-14);
        }
        CHECK(a.min_intensity == b.min_intensity);
        CHECK(a.max_intensity == b.max_intensity);
    }
}

TEST_CASE("velodyne calibration: degrees and centimetres, in whatever order the lasers stand") {
    // Two lasers of a real HDL-64E S2.1, at the places of each other.
    std::string text = sound();
    const std::size_t begin = text.find("            <item>\n                <px");
    const std::size_t third = text.find("<id_>2</id_>");
    const std::size_t end = text.rfind("            <item>", third);
    text.replace(begin, end - begin, R"(            <item>
                <px class_id="9" tracking_level="1" version="1" object_id="_1">
                    <id_> 1 </id_>
                    <rotCorrection_>-3.967427</rotCorrection_>
                    <vertCorrection_>-8.3563347</vertCorrection_>
                    <distCorrection_>151.45139</distCorrection_>
                    <vertOffsetCorrection_>19.601112</vertOffsetCorrection_>
                    <horizOffsetCorrection_>-2.5999999</horizOffsetCorrection_>
                </px>
            </item>
            <item>
                <px class_id_reference="9" object_id="_2">
                    <id_>0</id_>
                    <rotCorrection_>-7.1559157</rotCorrection_>
                    <vertCorrection_>-8.7686234</vertCorrection_>
                    <distCorrection_>151.95264</distCorrection_>
                    <distCorrectionX_>155.00304</distCorrectionX_>
                    <distCorrectionY_>152.31381</distCorrectionY_>
                    <vertOffsetCorrection_>19.548199</vertOffsetCorrection_>
                    <horizOffsetCorrection_>2.5999999</horizOffsetCorrection_>
                    <focalDistance_>1200</focalDistance_>
                    <focalSlope_>1.4</focalSlope_>
                </px>
            </item>
)");
    const VelodyneCalibration read = parse_velodyne_calibration(text, "db.xml", kModel);
    CHECK(read[0].rotation_rad == Approx(-0.1248942900).epsilon(1e-9));
    CHECK(read[0].vertical_rad == Approx(-0.1530413492).epsilon(1e-9));
    CHECK(read[0].distance_m == Approx(1.5195264));
    CHECK(read[0].distance_x_m == Approx(1.5500304));
    CHECK(read[0].distance_y_m == Approx(1.5231381));
    CHECK(read[0].vertical_offset_m == Approx(0.19548199));
    CHECK(read[0].horizontal_offset_m == Approx(0.025999999));
    CHECK(read[0].focal_distance_m == Approx(12.0));
    CHECK(read[0].focal_slope == Approx(1.4));
    CHECK(read[1].distance_m == Approx(1.5145139));
    CHECK(read[1].distance_x_m == 0.0);  // an early sensor's file has none
    CHECK(read[1].focal_slope == 0.0);
}

TEST_CASE("velodyne calibration: of other models, and from a file") {
    const auto vlp32c = *nominal_calibration(VelodyneModel::kVlp32c);
    const test::Scratch scratch;
    const auto file = scratch.file("VLP-32c.xml", test::velodyne_db_xml(vlp32c, 32, 0.4));
    const VelodyneCalibration read = read_velodyne_calibration(file, VelodyneModel::kVlp32c);
    CHECK(read[1].rotation_rad == Approx(vlp32c[1].rotation_rad));
    CHECK(read[29].vertical_rad == Approx(vlp32c[29].vertical_rad));
    CHECK_THROWS_AS(read_velodyne_calibration(scratch / "none.xml", VelodyneModel::kVlp32c), InputError);

    CHECK(error_of(sound(), VelodyneModel::kHdl32e).find("has 32 lasers, and no number 32; give") != std::string::npos);
    CHECK(error_of(test::velodyne_db_xml(vlp32c, 32, 0.4)).find("<distLSB_> is not this model's") != std::string::npos);
    CHECK(error_of(test::velodyne_db_xml(vlp32c, 32)).find("laser 32 is missing") != std::string::npos);
    CHECK(error_of(with(sound(), "<distLSB_>0.20000000000000001</distLSB_>", "")).empty());
}

TEST_CASE("velodyne calibration: damage is named with its line") {
    const std::string text = sound();
    CHECK(error_of(text).empty());
    CHECK(error_of("").starts_with("db.xml:1: "));
    CHECK(error_of("no XML at all").starts_with("db.xml:1: "));
    CHECK(error_of("<lasers/>").find("no <boost_serialization>: no file of corrections; give") != std::string::npos);

    const std::string cut = text.substr(0, text.size() / 2);
    CHECK(error_of(cut).find("not well-formed XML") != std::string::npos);
    CHECK(error_of(with(text, "points_", "dots_")).find("not well-formed") != std::string::npos);

    const std::string third = with(text, "<id_>3</id_>", "<id_>2</id_>");
    CHECK(error_of(third).find("laser 2 stands twice") != std::string::npos);
    CHECK(error_of(third).starts_with(at_line(text, "<id_>3</id_>")));
    CHECK(error_of(with(text, "<id_>3</id_>", "<id_>64</id_>")).find("<id_> is no number from 0 to 63") !=
          std::string::npos);
    CHECK(error_of(with(text, "<id_>3</id_>", "<id_>2.5</id_>")).find("whole number") != std::string::npos);
    CHECK(error_of(with(text, "<id_>3</id_>", "")).find("<px> without <id_>") != std::string::npos);

    // Each correction, of laser 5: what is no number, and numbers that no sensor has.
    for (const char* name :
         {"rotCorrection_", "vertCorrection_", "distCorrection_", "distCorrectionX_", "distCorrectionY_",
          "vertOffsetCorrection_", "horizOffsetCorrection_", "focalDistance_", "focalSlope_"}) {
        const std::string tag = std::string("<").append(name).append(">");
        CHECK(error_of(with_value(text, tag, " 1.5\n", 5)).empty());
        for (const char* value : {"", "seven", "1e999", "nan", "inf", "1 2", "99999", "-99999", "0x10", "1,5"}) {
            INFO(name << " " << value);
            CHECK(error_of(with_value(text, tag, value, 5)).find(tag + " is no number from ") != std::string::npos);
        }
    }

    const auto bound = [&](const std::string& name, const std::string& value) {
        return with_value(text, "<" + name + ">\n            <count>64</count>\n            <item>", value);
    };
    CHECK(error_of(bound("minIntensity_", "0")).empty());
    CHECK(error_of(bound("minIntensity_", "256")).find("<item> is no number from 0 to 255") != std::string::npos);
    CHECK(error_of(bound("maxIntensity_", "254.5")).find("<item> is no whole number") != std::string::npos);
    CHECK(error_of(bound("minIntensity_", "0</item><item>0")).find("<minIntensity_> has 65 items") !=
          std::string::npos);
    CHECK(error_of(bound("minIntensity_", "255")).find("the least intensity of laser 0 is above its most; give") !=
          std::string::npos);
}
