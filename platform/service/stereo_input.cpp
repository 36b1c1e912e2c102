#include "platform/service/stereo_input.hpp"

#include <array>
#include <optional>
#include <string>
#include <utility>

#include "drivers/stereo/rectifier.hpp"
#include "drivers/stereo/stereo_odometry.hpp"
#include "platform/capture/stereo_record.hpp"
#include "platform/files/gray_png.hpp"
#include "platform/files/input_error.hpp"
#include "platform/service/stereo_calibration.hpp"

namespace crspf {

namespace {

StereoCalibration calibration_of(const StereoConfig& config) {
    if (!config.calibration_text.empty()) {
        return parse_stereo_calibration(config.calibration_text, "[stereo] calibration_text");
    }
    if (config.calibration.empty()) {
        throw InputError(
            "[stereo]: has no calibration; name the file that `crspf calibrate stereo` writes, or KITTI's calib.txt");
    }
    return read_stereo_calibration(config.calibration);
}

KittiPose rows_of(const RigidMotion& m) {
    KittiPose rows{};
    auto* to = rows.begin();
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            *to++ = m.R(row, column);
        }
        *to++ = m.t(row);
    }
    return rows;
}

class OpenCvStereoInput final : public StereoInput {
 public:
    explicit OpenCvStereoInput(const StereoConfig& config)
        : params_(config.odometry), calibration_(calibration_of(config)) {}

    void on_pair(const StereoView& pair, Stamp exposed, SampleSink& sink) override {
        if (!odometry_ && !begin(pair)) {
            ++wrong_size_;
            return;
        }
        const StereoView rectified = rectifier_->rectify(pair);
        if (rectified.left.pixels == nullptr) {
            ++wrong_size_;
            return;
        }
        if (odometry_->add(exposed, rectified, motion_)) {
            ++blindness_.at(static_cast<std::size_t>(motion_.blindness));
            path_.push_back(rows_of(motion_.P_first_camera));
            sink.on_motion(motion_.sample);
        }
    }

    void on_record(std::span<const std::uint8_t> bytes, Stamp exposed, SampleSink& sink) override {
        const std::optional<StereoRecord> record = split_stereo_record(bytes);
        if (!record) {
            ++damaged_;
            return;
        }
        try {
            const GrayImage left = decode_gray_png(record->left_png, "left picture");
            const GrayImage right = decode_gray_png(record->right_png, "right picture");
            on_pair({.left = left.view(), .right = right.view()}, exposed, sink);
        } catch (const InputError&) {
            ++damaged_;
        }
    }

    [[nodiscard]] const char* sight() const override { return name_of(motion_.blindness); }

    [[nodiscard]] SourceCounts counts() const override {
        const StereoCounters c = odometry_ ? odometry_->counters() : StereoCounters{};
        SourceCounts out{{"pairs", c.pairs},    {"blind", c.blind},         {"ran back", c.ran_back},
                         {"gaps", c.gaps},      {"wide", c.wide},           {"references", c.references},
                         {"damaged", damaged_}, {"wrong size", wrong_size_}};
        for (std::size_t i = 1; i < blindness_.size(); ++i) {
            out.append({{name_of(static_cast<Blindness>(i)), blindness_.at(i)}});
        }
        return out;
    }

    [[nodiscard]] std::vector<KittiPose> take_path() override { return std::exchange(path_, {}); }

 private:
    /// KITTI's calibration does not tell how large the pictures are: the first pair does.
    bool begin(const StereoView& pair) {
        StereoCalibration calibration = calibration_;
        if (calibration.width == 0) {
            calibration.width = pair.left.width;
            calibration.height = pair.left.height;
        }
        if (pair.left.width != calibration.width || pair.left.height != calibration.height) {
            return false;
        }
        CalibrationFault fault = CalibrationFault::kNone;
        rectifier_ = StereoRectifier::make(calibration, fault);
        if (!rectifier_) {
            throw InputError(std::string("[stereo] calibration: ") + text_of(fault));
        }
        odometry_.emplace(rectifier_->camera(), params_);
        return true;
    }

    StereoParams params_;
    StereoCalibration calibration_;
    std::optional<StereoRectifier> rectifier_;
    std::optional<StereoOdometry> odometry_;
    StereoMotion motion_;
    std::array<std::uint64_t, 6> blindness_{};  ///< pairs, by why they told nothing
    std::uint64_t damaged_ = 0;
    std::uint64_t wrong_size_ = 0;
    std::vector<KittiPose> path_;
};

}  // namespace

std::unique_ptr<StereoInput> make_stereo_input(const StereoConfig& config) {
    return std::make_unique<OpenCvStereoInput>(config);
}

}  // namespace crspf
