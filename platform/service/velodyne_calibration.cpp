#include "platform/service/velodyne_calibration.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <pugixml.hpp>

#include "core/base/trig.hpp"
#include "platform/files/fields.hpp"
#include "platform/files/input_error.hpp"
#include "platform/files/read_file.hpp"

namespace crspf {
namespace {

constexpr std::size_t kLargestFile_bytes = std::size_t{1} << 20U;  // Velodyne's have 72 kB
constexpr double kCentimetre_m = 0.01;
constexpr const char* kRemedy = "; give the db.xml that came with the sensor";

/// A number beside which stands what it may be.
struct Bounds {
    double least;
    double most;
    const char* text;
};
constexpr Bounds kVertical_deg{-90.0, 90.0, "-90 to 90 (degrees)"};
constexpr Bounds kRotation_deg{-180.0, 180.0, "-180 to 180 (degrees)"};
constexpr Bounds kDistance_cm{-1000.0, 1000.0, "-1000 to 1000 (centimetres)"};
constexpr Bounds kOffset_cm{-100.0, 100.0, "-100 to 100 (centimetres)"};
constexpr Bounds kFocal_cm{0.0, 13100.0, "0 to 13100 (centimetres)"};
constexpr Bounds kFocalSlope{-100.0, 100.0, "-100 to 100"};
constexpr Bounds kIntensity{0.0, 255.0, "0 to 255"};
constexpr Bounds kUnit_cm{0.0, 100.0, "0 to 100 (centimetres)"};
constexpr Bounds kId{0.0, kVelodyneLasers - 1.0, "0 to 63"};

class Reader {
 public:
    Reader(std::string_view text, const std::string& name, VelodyneModel model)
        : text_(text), name_(name), model_(model) {}

    VelodyneCalibration read() {
        // As it stands in memory, so that the places of errors are those of the file.
        const pugi::xml_parse_result result = document_.load_buffer(
            text_.data(), text_.size(), pugi::parse_default | pugi::parse_trim_pcdata, pugi::encoding_utf8);
        if (!result) {
            fail(result.offset, std::string("not well-formed XML (").append(result.description()).append(")"));
        }
        const pugi::xml_node root = child(document_, "boost_serialization");
        const pugi::xml_node db = child(root, "DB");
        check_unit(db);
        read_lasers(child(db, "points_"));
        read_bounds(db);
        return calibration_;
    }

 private:
    [[noreturn]] void fail(std::ptrdiff_t offset, const std::string& reason) const {
        const std::string_view before = text_.substr(0, static_cast<std::size_t>(std::max<std::ptrdiff_t>(offset, 0)));
        const auto line = 1 + std::count(before.begin(), before.end(), '\n');
        throw InputError(name_ + ":" + std::to_string(line) + ": " + reason + kRemedy);
    }
    [[noreturn]] void fail(const pugi::xml_node& at, const std::string& reason) const {
        fail(at.offset_debug(), reason);
    }

    [[nodiscard]] pugi::xml_node child(const pugi::xml_node& parent, const char* name) const {
        const pugi::xml_node found = parent.child(name);
        if (!found) {
            const bool top = parent.type() == pugi::node_document;
            fail(parent, top ? std::string("no <").append(name).append(">: no file of corrections")
                             : std::string("<").append(parent.name()).append("> without <").append(name).append(">"));
        }
        return found;
    }

    [[nodiscard]] double number(const pugi::xml_node& node, const Bounds& bounds) const {
        Fields fields(node.child_value());
        double value = 0.0;
        if (!fields.number(value) || !fields.at_end() || !(value >= bounds.least && value <= bounds.most)) {
            fail(node, std::string("<").append(node.name()).append("> is no number from ").append(bounds.text));
        }
        return value;
    }
    [[nodiscard]] std::uint8_t whole_number(const pugi::xml_node& node, const Bounds& bounds) const {
        const double value = number(node, bounds);
        const auto whole = static_cast<std::uint8_t>(value);
        if (static_cast<double>(whole) != value) {
            fail(node, std::string("<").append(node.name()).append("> is no whole number"));
        }
        return whole;
    }
    [[nodiscard]] double required(const pugi::xml_node& px, const char* name, const Bounds& bounds) const {
        return number(child(px, name), bounds);
    }
    [[nodiscard]] double optional(const pugi::xml_node& px, const char* name, const Bounds& bounds) const {
        const pugi::xml_node found = px.child(name);
        return found ? number(found, bounds) : 0.0;
    }

    void check_unit(const pugi::xml_node& db) const {
        const pugi::xml_node unit = db.child("distLSB_");
        const double model_cm = traits_of(model_).distance_unit_m / kCentimetre_m;
        if (unit && std::abs(number(unit, kUnit_cm) - model_cm) > 1e-3) {
            fail(unit, "<distLSB_> is not this model's unit of distance");
        }
    }

    void read_lasers(const pugi::xml_node& points) {
        const std::uint32_t lasers = traits_of(model_).lasers;
        std::array<bool, kVelodyneLasers> read{};
        for (const pugi::xml_node& item : points.children("item")) {
            const pugi::xml_node px = child(item, "px");
            const pugi::xml_node id = child(px, "id_");
            const std::uint8_t laser = whole_number(id, kId);
            if (laser >= lasers) {
                fail(id, "the model has " + std::to_string(lasers) + " lasers, and no number " + std::to_string(laser));
            }
            if (read[laser]) {
                fail(id, "laser " + std::to_string(laser) + " stands twice");
            }
            read[laser] = true;
            calibration_[laser] = laser_of(px);
        }
        for (std::uint32_t laser = 0; laser < lasers; ++laser) {
            if (!read[laser]) {
                fail(points, "laser " + std::to_string(laser) + " is missing");
            }
        }
    }

    [[nodiscard]] VelodyneLaser laser_of(const pugi::xml_node& px) const {
        VelodyneLaser laser;
        laser.vertical_rad = radians(required(px, "vertCorrection_", kVertical_deg));
        laser.rotation_rad = radians(required(px, "rotCorrection_", kRotation_deg));
        laser.distance_m = kCentimetre_m * required(px, "distCorrection_", kDistance_cm);
        laser.distance_x_m = kCentimetre_m * optional(px, "distCorrectionX_", kDistance_cm);
        laser.distance_y_m = kCentimetre_m * optional(px, "distCorrectionY_", kDistance_cm);
        laser.vertical_offset_m = kCentimetre_m * required(px, "vertOffsetCorrection_", kOffset_cm);
        laser.horizontal_offset_m = kCentimetre_m * required(px, "horizOffsetCorrection_", kOffset_cm);
        laser.focal_distance_m = kCentimetre_m * optional(px, "focalDistance_", kFocal_cm);
        laser.focal_slope = optional(px, "focalSlope_", kFocalSlope);
        return laser;
    }

    /// One bound of each laser, in their order; absent from the files of early sensors.
    template <typename Set>
    void read_bound(const pugi::xml_node& db, const char* name, Set set) {
        const pugi::xml_node list = db.child(name);
        if (!list) {
            return;
        }
        const std::uint32_t lasers = traits_of(model_).lasers;
        std::uint32_t laser = 0;
        for (const pugi::xml_node& item : list.children("item")) {
            if (laser < lasers) {
                set(calibration_[laser], whole_number(item, kIntensity));
            }
            ++laser;
        }
        if (laser != lasers) {
            fail(list, std::string("<").append(name).append("> has ") + std::to_string(laser) + " items, the model " +
                           std::to_string(lasers) + " lasers");
        }
    }

    void read_bounds(const pugi::xml_node& db) {
        read_bound(db, "minIntensity_", [](VelodyneLaser& l, std::uint8_t value) { l.min_intensity = value; });
        read_bound(db, "maxIntensity_", [](VelodyneLaser& l, std::uint8_t value) { l.max_intensity = value; });
        for (std::uint32_t laser = 0; laser < traits_of(model_).lasers; ++laser) {
            if (calibration_[laser].min_intensity > calibration_[laser].max_intensity) {
                fail(db.child("minIntensity_"),
                     "the least intensity of laser " + std::to_string(laser) + " is above its most");
            }
        }
    }

    std::string_view text_;
    const std::string& name_;
    VelodyneModel model_;
    pugi::xml_document document_;
    VelodyneCalibration calibration_{};
};

}  // namespace

VelodyneCalibration parse_velodyne_calibration(std::string_view text, const std::string& name, VelodyneModel model) {
    return Reader(text, name, model).read();
}

VelodyneCalibration read_velodyne_calibration(const std::filesystem::path& file, VelodyneModel model) {
    return parse_velodyne_calibration(read_file(file, kLargestFile_bytes), file.string(), model);
}

}  // namespace crspf
