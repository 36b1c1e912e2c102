#include "platform/capture/stereo_folder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "platform/capture/stereo_record.hpp"
#include "platform/files/fields.hpp"
#include "platform/files/input_error.hpp"
#include "platform/files/read_file.hpp"

namespace crspf {

namespace {

using std::filesystem::path;

constexpr std::size_t kTextMax = std::size_t{1} << 26U;
constexpr Duration kPeriod{100'000'000};
constexpr double kSecondsMax = 4e9;

struct Layout {
    const char* left;
    const char* right;
};
constexpr std::array<Layout, 4> kLayouts{{{.left = "image_0", .right = "image_1"},
                                          {.left = "image_2", .right = "image_3"},
                                          {.left = "image_l", .right = "image_r"},
                                          {.left = "left", .right = "right"}}};

bool is_folder(const path& p) {
    std::error_code error;
    return std::filesystem::is_directory(p, error);
}

const Layout* layout_of(const path& directory) {
    const auto* const found = std::find_if(kLayouts.begin(), kLayouts.end(), [&](const Layout& l) {
        return is_folder(directory / l.left) && is_folder(directory / l.right);
    });
    return found == kLayouts.end() ? nullptr : found;
}

std::vector<path> pictures_in(const path& directory) {
    std::vector<path> names;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(directory, error)) {
        if (entry.path().extension() == ".png") {
            names.push_back(entry.path().filename());
        }
    }
    if (error) {
        throw InputError(directory.string() + ": cannot be read: " + error.message());
    }
    std::sort(names.begin(), names.end());
    return names;
}

std::vector<Stamp> stamps_in(const path& file, std::size_t count) {
    const std::string content = read_file(file, kTextMax);
    std::vector<Stamp> stamps;
    std::string_view rest = content;
    while (!rest.empty()) {
        const std::size_t end = rest.find('\n');
        Fields fields(rest.substr(0, end));
        rest.remove_prefix(end == rest.npos ? rest.size() : end + 1);
        if (fields.at_end()) {
            continue;
        }
        double seconds = 0.0;
        if (!fields.number(seconds) || !(std::abs(seconds) < kSecondsMax)) {
            throw InputError(file.string() + ":" + std::to_string(stamps.size() + 1) +
                             ": not a time in seconds, one a line for each pair of pictures");
        }
        stamps.push_back(Stamp{} + Duration::from_seconds(seconds));
    }
    if (stamps.size() < count) {
        throw InputError(file.string() + ": holds " + std::to_string(stamps.size()) + " times for " +
                         std::to_string(count) +
                         " pairs of pictures; add the rest, or remove the file: pairs are then "
                         "taken to be 0.1 s apart");
    }
    return stamps;
}

std::span<const std::uint8_t> bytes_of(const std::string& text) {
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes as bytes
    return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

class StereoFolder final : public CaptureReader {
 public:
    explicit StereoFolder(path directory) : directory_(std::move(directory)) {
        const Layout* const layout = layout_of(directory_);
        if (layout == nullptr) {
            throw InputError(directory_.string() + ": no folders of pictures in it; expected image_0 and image_1");
        }
        layout_ = *layout;
        names_ = pictures_in(directory_ / layout_.left);
        const std::vector<path> right = pictures_in(directory_ / layout_.right);
        const auto [l, r] = std::mismatch(names_.begin(), names_.end(), right.begin(), right.end());
        if (l != names_.end() || r != right.end()) {
            const bool no_right = r == right.end() || (l != names_.end() && *l < *r);
            throw InputError((directory_ / (no_right ? layout_.left : layout_.right) / (no_right ? *l : *r)).string() +
                             ": has no picture of the other camera; remove it or add that");
        }
        if (names_.empty()) {
            throw InputError((directory_ / layout_.left).string() + ": no .png pictures in it");
        }
        const path times = directory_ / "times.txt";
        std::error_code error;
        if (std::filesystem::exists(times, error)) {
            stamps_ = stamps_in(times, names_.size());
        }
    }

    bool next(CaptureRecord& record) override {
        if (at_ == names_.size()) {
            return false;
        }
        const std::string left = read_file(directory_ / layout_.left / names_[at_], CaptureRecord::kBytesMax);
        const std::string right = read_file(directory_ / layout_.right / names_[at_], CaptureRecord::kBytesMax);
        bytes_.clear();
        append_stereo_record(bytes_, {.left_png = bytes_of(left), .right_png = bytes_of(right)});
        record = {.source = 0,
                  .link = LinkKind::kStereo,
                  .direction = Direction::kReceived,
                  .stamp = stamps_.empty() ? Stamp{static_cast<std::int64_t>(at_) * kPeriod.ns} : stamps_[at_],
                  .bytes = bytes_};
        ++at_;
        ++counts_.records;
        return true;
    }

    [[nodiscard]] const std::vector<CaptureSource>& sources() const override { return sources_; }
    [[nodiscard]] const std::string& comment() const override { return comment_; }
    [[nodiscard]] const CaptureCounts& counts() const override { return counts_; }
    [[nodiscard]] double progress() const override {
        return static_cast<double>(at_) / static_cast<double>(names_.size());
    }
    [[nodiscard]] const char* format() const override { return "folder of pictures"; }

 private:
    path directory_;
    Layout layout_{};
    std::vector<path> names_;
    std::vector<Stamp> stamps_;
    std::size_t at_ = 0;
    std::vector<std::uint8_t> bytes_;
    std::vector<CaptureSource> sources_{{.name = "stereo", .description = {}, .link = LinkKind::kStereo}};
    std::string comment_;
    CaptureCounts counts_;
};

}  // namespace

bool is_stereo_folder(const path& directory) {
    return layout_of(directory) != nullptr;
}

std::unique_ptr<CaptureReader> open_stereo_folder(const path& directory) {
    return std::make_unique<StereoFolder>(directory);
}

path calibration_of(const path& directory) {
    std::error_code error;
    const path file = directory / "calib.txt";
    return std::filesystem::exists(file, error) ? file : path{};
}

}  // namespace crspf
