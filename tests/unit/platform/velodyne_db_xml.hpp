// Makes files of corrections as Velodyne's are.
#pragma once

#include <cstdint>
#include <sstream>
#include <string>

#include "drivers/velodyne/velodyne_models.hpp"

namespace crspf::test {

/// With all the digits of a double: degrees and centimetres. `unit_cm` is the distLSB_.
inline std::string velodyne_db_xml(const VelodyneCalibration& calibration, std::uint32_t lasers, double unit_cm = 0.2) {
    constexpr double kDegree_rad = 3.14159265358979323846 / 180.0;
    std::ostringstream out;
    out.precision(17);
    const auto list = [&](const char* name, auto value) {
        out << "        <" << name << ">\n            <count>" << lasers << "</count>\n";
        for (std::uint32_t i = 0; i < lasers; ++i) {
            out << "            <item>" << value(calibration[i]) << "</item>\n";
        }
        out << "        </" << name << ">\n";
    };
    out << "<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"yes\" ?>\n<!DOCTYPE boost_serialization>\n"
        << "<boost_serialization signature=\"serialization::archive\" version=\"4\">\n"
        << "    <DB class_id=\"0\" tracking_level=\"1\" version=\"0\" object_id=\"_0\">\n"
        << "        <distLSB_>" << unit_cm << "</distLSB_>\n";
    list("enabled_", [](const VelodyneLaser&) { return 1; });
    list("minIntensity_", [](const VelodyneLaser& l) { return static_cast<int>(l.min_intensity); });
    list("maxIntensity_", [](const VelodyneLaser& l) { return static_cast<int>(l.max_intensity); });
    out << "        <points_ class_id=\"7\" tracking_level=\"0\" version=\"0\">\n            <count>" << lasers
        << "</count>\n            <item_version>1</item_version>\n";
    for (std::uint32_t i = 0; i < lasers; ++i) {
        const VelodyneLaser& l = calibration[i];
        out << "            <item>\n                <px class_id_reference=\"9\" object_id=\"_" << i + 1 << "\">\n";
        const auto value = [&](const char* name, double v) {
            out << "                    <" << name << '>' << v << "</" << name << ">\n";
        };
        value("id_", i);
        value("rotCorrection_", l.rotation_rad / kDegree_rad);
        value("vertCorrection_", l.vertical_rad / kDegree_rad);
        value("distCorrection_", 100.0 * l.distance_m);
        value("distCorrectionX_", 100.0 * l.distance_x_m);
        value("distCorrectionY_", 100.0 * l.distance_y_m);
        value("vertOffsetCorrection_", 100.0 * l.vertical_offset_m);
        value("horizOffsetCorrection_", 100.0 * l.horizontal_offset_m);
        value("focalDistance_", 100.0 * l.focal_distance_m);
        value("focalSlope_", l.focal_slope);
        out << "                </px>\n            </item>\n";
    }
    out << "        </points_>\n    </DB>\n</boost_serialization>\n";
    return out.str();
}

}  // namespace crspf::test
