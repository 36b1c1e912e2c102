#include "tools/crspf/export_svg.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "platform/files/atomic_file.hpp"
#include "platform/files/base64.hpp"
#include "platform/files/png_image.hpp"
#include "tools/crspf/export_text.hpp"

namespace crspf {
namespace {

std::string digits(double value) {
    constexpr int kDecimals = 3;
    std::string text;
    append_fixed(text, value, kDecimals);
    return text;
}

std::string attribute(const char* name, double value) {
    return std::string(" ") + name + "=\"" + digits(value) + "\"";
}

std::string colour(const char* name, Rgb rgb) {
    return std::string(" ") + name + "=\"rgb(" + std::to_string(rgb.red) + "," + std::to_string(rgb.green) + "," +
           std::to_string(rgb.blue) + ")\"";
}

/// 1, 2 or 5 times a power of ten, and no longer than `most_m`.
double round_length(double most_m) {
    constexpr int kSteps = 30;  // from a millimetre to ten thousand kilometres
    double length_m = 1e-3;
    for (int i = 0; i < kSteps; ++i) {
        const double next_m = length_m * (i % 3 == 1 ? 2.5 : 2.0);
        if (next_m > most_m) {
            break;
        }
        length_m = next_m;
    }
    return length_m;
}

/// A point of the drawing: y runs down.
struct Spot {
    double x = 0.0;
    double y = 0.0;
};

class Drawing {
 public:
    explicit Drawing(const GridMap& map)
        : P_corner_map_(inverse(map.P_map_origin)),
          width_m_(map.width * map.resolution_m),
          height_m_(map.height * map.resolution_m),
          pen_m_(std::max(width_m_, height_m_) / 400.0) {}

    [[nodiscard]] std::string text(const GridMap& map, std::span<const TimedPose> path) const {
        return head() + picture(map) + way(path) + scale() + "</svg>\n";
    }

 private:
    [[nodiscard]] double foot_m() const { return 24.0 * pen_m_; }  // room for the scale

    [[nodiscard]] std::string head() const {
        constexpr double kWidth_px = 1000.0;
        const double height_m = height_m_ + foot_m();
        return R"(<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink")" +
               attribute("width", kWidth_px) + attribute("height", kWidth_px * height_m / width_m_) +
               " viewBox=\"0 0 " + digits(width_m_) + " " + digits(height_m) + "\">\n<rect" +
               attribute("width", width_m_) + attribute("height", height_m) + " fill=\"white\"/>\n";
    }

    [[nodiscard]] std::string picture(const GridMap& map) const {
        const RgbImage image = draw_map(map, {}, kPictureSide_px);
        // The lower left corners agree; to the right and above, cells that share a pixel may reach beyond.
        const double pixel_m = map.resolution_m * std::ceil(static_cast<double>(map.width) / image.width);
        return "<image" + attribute("x", 0.0) + attribute("y", height_m_ - pixel_m * image.height) +
               attribute("width", pixel_m * image.width) + attribute("height", pixel_m * image.height) +
               R"( style="image-rendering:pixelated" xlink:href="data:image/png;base64,)" +
               to_base64(encode_png(image)) + "\"/>\n";
    }

    [[nodiscard]] Spot spot(const Pose2& P_map_base) const {
        const Pose2 P = P_corner_map_ * P_map_base;
        return {.x = P.x_m, .y = height_m_ - P.y_m};
    }

    [[nodiscard]] std::string way(std::span<const TimedPose> path) const {
        std::string points;
        std::optional<Spot> first;
        Spot last;
        Spot drawn;
        for (const TimedPose& pose : path) {
            const Spot at = spot(pose.P_map_base);
            if (!std::isfinite(at.x) || !std::isfinite(at.y)) {
                continue;
            }
            last = at;
            if (!first || std::hypot(at.x - drawn.x, at.y - drawn.y) > pen_m_ / 2.0) {
                points.append(first ? " " : "").append(digits(at.x)).append(",").append(digits(at.y));
                drawn = at;
            }
            first = first.value_or(at);
        }
        if (!first) {
            return {};
        }
        return R"(<polyline fill="none" stroke-linejoin="round")" + colour("stroke", kPathColour) +
               attribute("stroke-width", pen_m_) + " points=\"" + points + "\"/>\n" + disc(*first, kStartColour) +
               disc(last, kEndColour);
    }

    [[nodiscard]] std::string disc(Spot at, Rgb ink) const {
        return "<circle" + attribute("cx", at.x) + attribute("cy", at.y) + attribute("r", 2.5 * pen_m_) +
               colour("fill", ink) + "/>\n";
    }

    [[nodiscard]] std::string scale() const {
        const double length_m = round_length(width_m_ / 3.0);
        const double left = 8.0 * pen_m_;
        const double y = height_m_ + 16.0 * pen_m_;
        std::string label;
        append_digits(label, std::round(length_m * 1e3) / 1e3);
        return R"(<path fill="none" stroke="black")" + attribute("stroke-width", pen_m_) + " d=\"M" + digits(left) +
               "," + digits(y - 3.0 * pen_m_) + " v" + digits(3.0 * pen_m_) + " h" + digits(length_m) + " v-" +
               digits(3.0 * pen_m_) + "\"/>\n<text font-family=\"sans-serif\"" + attribute("font-size", 9.0 * pen_m_) +
               attribute("x", left + length_m + 4.0 * pen_m_) + attribute("y", y) + ">" + label + " m</text>\n";
    }

    Pose2 P_corner_map_;
    double width_m_;
    double height_m_;
    double pen_m_;  ///< width of a line
};

}  // namespace

void write_svg(const GridMap& map, std::span<const TimedPose> path, const std::filesystem::path& file) {
    AtomicFile out(file);
    out.write(Drawing(map).text(map, path));
    out.commit();
}

}  // namespace crspf
