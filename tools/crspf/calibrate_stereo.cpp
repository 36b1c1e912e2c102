#include "tools/crspf/calibrate_stereo.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/trig.hpp"
#include "drivers/stereo/rectifier.hpp"
#include "platform/files/input_error.hpp"
#include "tools/calibrate/stereo_pictures.hpp"

namespace crspf {
namespace {

constexpr Duration kSpacing{500'000'000};  // between pairs of a recording
constexpr double kMoved = 0.02;            // of the width: the board is at another place
constexpr std::size_t kPairsMax = 120;     // more cost minutes and tell little
constexpr double kCovered = 0.6;           // of width and height, by corners
constexpr double kFocalDoubt = 0.005;      // standard deviation as a share
constexpr double kRowsDoubt_px = 0.5;
constexpr double kWorse = 3.0;  // than the median

std::string percent(double share) {
    return std::to_string(std::lround(100.0 * share)) + " %";
}

/// 180 degrees of a chessboard look the same; the cameras agree about which end is up.
void align(const std::vector<BoardCorner>& left, std::vector<BoardCorner>& right) {
    const auto& [l0, l1] = std::pair{left.front(), left.back()};
    const auto& [r0, r1] = std::pair{right.front(), right.back()};
    if ((l1.x_px - l0.x_px) * (r1.x_px - r0.x_px) + (l1.y_px - l0.y_px) * (r1.y_px - r0.y_px) < 0.0) {
        std::reverse(right.begin(), right.end());
    }
}

class Collection {
 public:
    explicit Collection(const StereoCalibrateJob& job) : job_(job) {}

    void run(StereoCalibrateOutcome& out) {
        for (const std::filesystem::path& input : job_.inputs) {
            for_each_pair(input, kSpacing, [&](const NamedPair& pair) { look_at(pair, out); });
        }
        if (pairs_.size() > kPairsMax) {
            out.left_out = pairs_.size() - kPairsMax;
            std::vector<BoardPair> some;
            for (std::size_t i = 0; i < kPairsMax; ++i) {
                some.push_back(std::move(pairs_[i * pairs_.size() / kPairsMax]));
            }
            pairs_ = std::move(some);
        }
    }

    [[nodiscard]] const std::vector<BoardPair>& pairs() const { return pairs_; }
    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }

 private:
    void look_at(const NamedPair& pair, StereoCalibrateOutcome& out) {
        check_size(pair, pair.view.left);
        check_size(pair, pair.view.right);
        ++out.looked_at;
        BoardPair found{.name = pair.name, .left = find_board(pair.view.left, job_.board), .right = {}};
        if (!found.left.empty()) {
            found.right = find_board(pair.view.right, job_.board);
        }
        if (found.right.empty()) {
            out.without_board.push_back(pair.name);
        } else if (pair.recorded && !moved(found)) {
            ++out.not_moved;
        } else {
            align(found.left, found.right);
            pairs_.push_back(std::move(found));
        }
        if (job_.progress) {
            job_.progress(out.looked_at, pairs_.size());
        }
    }

    void check_size(const NamedPair& pair, const GrayView& picture) {
        if (width_ == 0) {
            width_ = picture.width;
            height_ = picture.height;
        }
        if (picture.width != width_ || picture.height != height_) {
            throw InputError(pair.name + ": " + std::to_string(picture.width) + "x" + std::to_string(picture.height) +
                             " pixels, others have " + std::to_string(width_) + "x" + std::to_string(height_) +
                             "; all must come from one pair of cameras at one setting");
        }
    }

    [[nodiscard]] bool moved(const BoardPair& now) const {
        if (pairs_.empty()) {
            return true;
        }
        const std::vector<BoardCorner>& before = pairs_.back().left;
        double furthest = 0.0;
        for (std::size_t i = 0; i < before.size(); ++i) {
            furthest =
                std::max(furthest, std::hypot(now.left[i].x_px - before[i].x_px, now.left[i].y_px - before[i].y_px));
        }
        return furthest > kMoved * width_;
    }

    const StereoCalibrateJob& job_;
    std::vector<BoardPair> pairs_;
    int width_ = 0;
    int height_ = 0;
};

void find_worst(StereoCalibrateOutcome& out) {
    const auto error_of = [](const PairError& pair) { return std::max({pair.left_px, pair.right_px, pair.rows_px}); };
    std::vector<double> errors;
    for (const PairError& pair : out.estimate.pairs) {
        errors.push_back(error_of(pair));
    }
    const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
    std::nth_element(errors.begin(), middle, errors.end());
    for (const PairError& pair : out.estimate.pairs) {
        if (error_of(pair) > kWorse * *middle) {
            out.worst.push_back(pair.name);
        }
    }
}

void doubt(StereoCalibrateOutcome& out) {
    const StereoEstimate& e = out.estimate;
    for (const auto& [name, camera] : {std::pair{"left", &e.left}, std::pair{"right", &e.right}}) {
        if (camera->wide < kCovered || camera->high < kCovered) {
            out.doubts.push_back(
                "the board was seen only in " + percent(camera->wide) + " of the width and " + percent(camera->high) +
                " of the height of the " + name +
                " pictures, so the distortion beyond is a guess; hold the board into their corners, too");
        }
        if (camera->stddev.fx_px > kFocalDoubt * camera->value.fx_px) {
            out.doubts.push_back(std::string("the focal length of the ") + name +
                                 " camera is not well known; tilt the board by 30 degrees to each side, near and far");
        }
    }
    if (e.rows_px > kRowsDoubt_px) {
        out.doubts.emplace_back(
            "rows do not match well after rectification; is the board flat, was it held still, and do both cameras "
            "take "
            "their pictures at one moment?");
    }
}

}  // namespace

StereoCalibrateOutcome run_stereo_calibration(const StereoCalibrateJob& job) {
    StereoCalibrateOutcome out;
    Collection collection(job);
    collection.run(out);
    if (collection.pairs().empty()) {
        throw InputError(job.inputs.front().string() + ": no board of " + std::to_string(job.board.columns) + "x" +
                         std::to_string(job.board.rows) + " inner corners is seen whole by both cameras in any of " +
                         std::to_string(out.looked_at) +
                         " pairs; count where four squares meet, give it as --board, and leave a white margin around "
                         "the squares");
    }
    out.estimate = estimate_stereo(collection.pairs(), job.board, collection.width(), collection.height());
    CalibrationFault fault = CalibrationFault::kNone;
    if (!StereoRectifier::make(out.estimate.calibration, fault)) {
        throw InputError(job.inputs.front().string() + ": what was found cannot be: " + text_of(fault) +
                         (fault == CalibrationFault::kNotToTheRight ? "; exchange the left and right pictures"
                                                                    : "; take pictures of the board at more places"));
    }
    find_worst(out);
    doubt(out);
    return out;
}

}  // namespace crspf
