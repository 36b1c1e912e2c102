#include "platform/service/stereo_calibration.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>

#include "drivers/stereo/calibration_fault.hpp"
#include "platform/files/fields.hpp"
#include "platform/files/input_error.hpp"
#include "platform/files/read_file.hpp"
#include "platform/service/opencv_yaml.hpp"

namespace crspf {
namespace {

constexpr std::size_t kLargestCalibration_bytes = std::size_t{1} << 20U;

bool is_rectified(const StereoCalibration& c) {
    const std::array<double, 9> straight = StereoCalibration{}.R;
    const auto pure = [&](const CameraIntrinsics& camera) {
        return camera.fx_px == camera.fy_px && camera.fx_px == c.left.fx_px && camera.cx_px == c.left.cx_px &&
               camera.cy_px == c.left.cy_px &&
               std::all_of(camera.distortion.begin(), camera.distortion.end(), [](double k) { return k == 0.0; });
    };
    return pure(c.left) && pure(c.right) && c.R == straight && c.T_m[1] == 0.0 && c.T_m[2] == 0.0;
}

/// Where in OpenCV's file the fault is.
const char* key_of(CalibrationFault fault) {
    switch (fault) {
        case CalibrationFault::kSize: return "image_width";
        case CalibrationFault::kLeftCamera: return "M1";
        case CalibrationFault::kRightCamera: return "M2";
        case CalibrationFault::kRotation: return "R";
        default: return "T";
    }
}

class YamlReader {
 public:
    /// `more` of two files may hold what the first has not.
    explicit YamlReader(const OpenCvYaml& yaml, const OpenCvYaml* more) : yaml_(yaml), more_(more) {}

    [[nodiscard]] StereoCalibration read() const {
        StereoCalibration calibration;
        calibration.width = side("image_width");
        calibration.height = side("image_height");
        calibration.left = camera("M1", "D1");
        calibration.right = camera("M2", "D2");
        const YamlMatrix R = matrix("R", 3, 3);
        std::copy(R.data.begin(), R.data.end(), calibration.R.begin());
        const YamlMatrix T = column("T", 3);
        std::copy(T.data.begin(), T.data.end(), calibration.T_m.begin());
        calibration.rectified = is_rectified(calibration);
        if (const CalibrationFault fault = fault_of(calibration); fault != CalibrationFault::kNone) {
            const char* const key = key_of(fault);
            holder(key).fail(holder(key).line_of(key), std::string(key) + ": " + text_of(fault));
        }
        return calibration;
    }

 private:
    [[nodiscard]] const OpenCvYaml& holder(std::string_view key) const {
        return more_ != nullptr && !yaml_.has(key) && more_->has(key) ? *more_ : yaml_;
    }

    [[nodiscard]] int side(const char* key) const { return holder(key).whole_number(key).value_or(0); }

    [[nodiscard]] YamlMatrix matrix(const char* key, std::size_t rows, std::size_t cols) const {
        const OpenCvYaml& yaml = holder(key);
        std::optional<YamlMatrix> found = yaml.matrix(key);
        if (!found) {
            yaml.fail(1, std::string(key) + " is missing");
        }
        if (found->rows != rows || found->cols != cols) {
            yaml.fail(found->line, std::string(key) + " is not " + std::to_string(rows) + " x " + std::to_string(cols));
        }
        return *std::move(found);
    }

    /// A column or a row.
    [[nodiscard]] YamlMatrix column(const char* key, std::size_t count) const {
        const std::optional<YamlMatrix> found = holder(key).matrix(key);
        return found && found->rows == 1 ? matrix(key, 1, count) : matrix(key, count, 1);
    }

    [[nodiscard]] CameraIntrinsics camera(const char* matrix_key, const char* distortion_key) const {
        const YamlMatrix M = matrix(matrix_key, 3, 3);
        CameraIntrinsics camera{.fx_px = M.data[0], .fy_px = M.data[4], .cx_px = M.data[2], .cy_px = M.data[5]};
        // Neither skew nor anything else that a pinhole has not.
        const std::array<double, 9> pinhole{M.data[0], 0.0, M.data[2], 0.0, M.data[4], M.data[5], 0.0, 0.0, 1.0};
        if (!std::equal(pinhole.begin(), pinhole.end(), M.data.begin())) {
            holder(matrix_key).fail(M.line, std::string(matrix_key) + " is no camera matrix (f 0 c, 0 f c, 0 0 1)");
        }
        const OpenCvYaml& yaml = holder(distortion_key);
        const std::optional<YamlMatrix> D = yaml.matrix(distortion_key);
        if (!D) {
            return camera;
        }
        // OpenCV's models of more coefficients leave those that are not in use at 0.
        const std::size_t used = std::min(D->data.size(), camera.distortion.size());
        const bool known = D->data.size() == 4 || D->data.size() == 5 || D->data.size() >= 8;
        const bool no_more = std::all_of(D->data.begin() + static_cast<std::ptrdiff_t>(used), D->data.end(),
                                         [](double k) { return k == 0.0; });
        if ((D->rows != 1 && D->cols != 1) || !known || !no_more) {
            yaml.fail(D->line,
                      std::string(distortion_key) + " is not 4, 5 or 8 coefficients (k1 k2 p1 p2 k3 k4 k5 k6)");
        }
        std::copy_n(D->data.begin(), used, camera.distortion.begin());
        return camera;
    }

    const OpenCvYaml& yaml_;
    const OpenCvYaml* more_;
};

/// A projection matrix, K (I | t).
using Projection = std::array<double, 12>;

class KittiReader {
 public:
    KittiReader(std::string_view text, const std::string& name) : text_(text), name_(name) {}

    [[nodiscard]] StereoCalibration read() {
        while (!text_.empty()) {
            ++line_;
            const std::size_t end = text_.find('\n');
            read_line(Fields(text_.substr(0, end)));
            text_ = end == std::string_view::npos ? std::string_view{} : text_.substr(end + 1);
        }
        if (!left_ || !right_) {
            fail(std::string(left_ ? "P1" : "P0") + " is missing");
        }
        const CameraIntrinsics left = camera_of(*left_);
        const CameraIntrinsics right = camera_of(*right_);
        StereoCalibration calibration;
        calibration.left = left;
        calibration.right = right;
        calibration.T_m[0] = ((*right_)[3] - (*left_)[3]) / left.fx_px;
        calibration.rectified = true;
        if (const CalibrationFault fault = fault_of(calibration); fault != CalibrationFault::kNone) {
            fail(text_of(fault));
        }
        return calibration;
    }

 private:
    [[noreturn]] void fail(const std::string& reason) const {
        throw InputError(name_ + ":" + std::to_string(line_) + ": " + reason +
                         "; give KITTI's calib.txt, or YAML that `crspf calibrate stereo` or OpenCV wrote");
    }

    void read_line(Fields fields) {
        if (fields.at_end()) {
            return;
        }
        double first = 0.0;
        if (fields.number(first)) {
            std::optional<Projection>& next = left_ ? right_ : left_;
            if (!right_) {
                next = projection(fields, {first}, 1);
            }
            return;
        }
        const std::string_view key = fields.word();
        if (key == "P0:" || key == "P1:") {
            std::optional<Projection>& named = key == "P0:" ? left_ : right_;
            if (named) {
                fail(std::string(key.substr(0, 2)) + " stands twice");
            }
            named = projection(fields, {}, 0);
        } else if (!key.ends_with(':')) {
            fail("neither \"P0: \" and twelve numbers, nor these alone");
        }
    }

    [[nodiscard]] Projection projection(Fields fields, Projection begun, std::size_t from) const {
        for (std::size_t i = from; i < begun.size(); ++i) {
            if (!fields.number(begun[i])) {
                fail("not twelve numbers");
            }
        }
        const bool finite = std::all_of(begun.begin(), begun.end(), [](double v) { return std::isfinite(v); });
        if (!fields.at_end() || !finite) {
            fail("not twelve numbers");
        }
        return begun;
    }

    [[nodiscard]] CameraIntrinsics camera_of(const Projection& P) const {
        const CameraIntrinsics camera{.fx_px = P[0], .fy_px = P[5], .cx_px = P[2], .cy_px = P[6]};
        const std::array<double, 5> others{P[1], P[4], P[8], P[9], P[10] - 1.0};
        if (std::any_of(others.begin(), others.end(), [](double v) { return v != 0.0; })) {
            fail("not the projection of a rectified camera (f 0 c t, 0 f c t, 0 0 1 t)");
        }
        return camera;
    }

    std::string_view text_;
    const std::string& name_;
    std::size_t line_ = 0;
    std::optional<Projection> left_;
    std::optional<Projection> right_;
};

void append(std::string& text, double value) {
    std::array<char, 32> digits{};
    char* const end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    text.append(digits.data(), end);
    // FileStorage takes a number without a point for a whole one.
    if (std::string_view(digits.data(), end).find_first_of(".e") == std::string_view::npos) {
        text += '.';
    }
}

void append(std::string& text, const char* key, std::size_t rows, std::size_t cols, std::span<const double> data) {
    text.append(key).append(": !!opencv-matrix\n   rows: ").append(std::to_string(rows));
    text.append("\n   cols: ").append(std::to_string(cols)).append("\n   dt: d\n   data: [ ");
    for (std::size_t i = 0; i < data.size(); ++i) {
        text.append(i == 0 ? "" : i % 3 == 0 ? ",\n       " : ", ");
        append(text, data[i]);
    }
    text.append(" ]\n");
}

void append(std::string& text, const char* matrix_key, const char* distortion_key, const CameraIntrinsics& c) {
    append(text, matrix_key, 3, 3, std::array{c.fx_px, 0.0, c.cx_px, 0.0, c.fy_px, c.cy_px, 0.0, 0.0, 1.0});
    append(text, distortion_key, 1, c.distortion.size(), c.distortion);
}

}  // namespace

StereoCalibration parse_stereo_calibration(std::string_view text, const std::string& name) {
    if (OpenCvYaml::is_one(text)) {
        const OpenCvYaml yaml(text, name);
        return YamlReader(yaml, nullptr).read();
    }
    return KittiReader(text, name).read();
}

StereoCalibration read_stereo_calibration(const std::filesystem::path& file) {
    const std::string text = read_file(file, kLargestCalibration_bytes);
    const std::filesystem::path intrinsics = file.parent_path() / "intrinsics.yml";
    const std::filesystem::path extrinsics = file.parent_path() / "extrinsics.yml";
    if (file.filename() != intrinsics.filename() && file.filename() != extrinsics.filename()) {
        return parse_stereo_calibration(text, file.string());
    }
    const std::filesystem::path other = file.filename() == intrinsics.filename() ? extrinsics : intrinsics;
    const std::string more_text = read_file(other, kLargestCalibration_bytes);
    const OpenCvYaml yaml(text, file.string());
    const OpenCvYaml more(more_text, other.string());
    return YamlReader(yaml, &more).read();
}

std::string write_stereo_calibration(const StereoCalibration& calibration) {
    const StereoCalibration& c = calibration;
    std::string text = "%YAML:1.0\n---\n";
    text.append("image_width: ").append(std::to_string(c.width)).append("\n");
    text.append("image_height: ").append(std::to_string(c.height)).append("\n");
    append(text, "M1", "D1", c.left);
    append(text, "M2", "D2", c.right);
    append(text, "R", 3, 3, c.R);
    append(text, "T", 3, 1, c.T_m);
    return text;
}

}  // namespace crspf
