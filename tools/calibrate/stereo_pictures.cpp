#include "tools/calibrate/stereo_pictures.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "platform/capture/capture_reader.hpp"
#include "platform/capture/stereo_record.hpp"
#include "platform/files/gray_png.hpp"
#include "platform/files/input_error.hpp"
#include "platform/files/read_file.hpp"

namespace crspf {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestPicture_bytes = std::size_t{1} << 26U;
constexpr std::array<std::pair<const char*, const char*>, 3> kFolders{
    {{"image_0", "image_1"}, {"image_l", "image_r"}, {"left", "right"}}};
constexpr std::string_view kLeft = "left";
constexpr std::string_view kRight = "right";

using Files = std::pair<fs::path, fs::path>;

std::vector<fs::path> pictures_of(const fs::path& folder) {
    std::vector<fs::path> found;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        if (entry.path().extension() == ".png") {
            found.push_back(entry.path());
        }
    }
    std::sort(found.begin(), found.end());
    return found;
}

/// Each of the left pictures with its partner, whose path `right_of` makes.
template <typename RightOf>
std::vector<Files> paired(const std::vector<fs::path>& left, RightOf right_of) {
    std::vector<Files> pairs;
    for (const fs::path& file : left) {
        const fs::path right = right_of(file);
        if (!fs::exists(right)) {
            throw InputError(file.string() + ": the other camera's picture, " + right.string() +
                             ", is missing; remove the one or add the other");
        }
        pairs.emplace_back(file, right);
    }
    return pairs;
}

std::vector<Files> pairs_of(const fs::path& folder) {
    for (const auto& [left, right] : kFolders) {
        if (fs::is_directory(folder / left) && fs::is_directory(folder / right)) {
            return paired(pictures_of(folder / left),
                          [&, name = right](const fs::path& file) { return folder / name / file.filename(); });
        }
    }
    std::vector<fs::path> left = pictures_of(folder);
    std::erase_if(left, [](const fs::path& file) { return !file.filename().string().starts_with(kLeft); });
    return paired(left, [](const fs::path& file) {
        const std::string rest = file.filename().string().substr(kLeft.size());
        return file.parent_path() / std::string(kRight).append(rest);
    });
}

GrayImage read_picture(const fs::path& file) {
    const std::string bytes = read_file(file, kLargestPicture_bytes);
    const std::vector<std::uint8_t> data(bytes.begin(), bytes.end());
    return decode_gray_png(data, file.string());
}

void visit_folder(const fs::path& folder, const std::function<void(const NamedPair&)>& visit) {
    const std::vector<Files> pairs = pairs_of(folder);
    if (pairs.empty()) {
        throw InputError(folder.string() +
                         ": no pairs of PNG pictures; name them left1.png and right1.png and so on, or put them into "
                         "the folders image_0 and image_1 in it");
    }
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const GrayImage left = read_picture(pairs[i].first);
        const GrayImage right = read_picture(pairs[i].second);
        visit({.name = pairs[i].first.string(),
               .view = {.left = left.view(), .right = right.view()},
               .stamp = {},
               .recorded = false,
               .share = static_cast<double>(i + 1) / static_cast<double>(pairs.size())});
    }
}

void visit_recording(const fs::path& file, Duration spacing, const std::function<void(const NamedPair&)>& visit) {
    const auto reader = open_capture(file);
    std::optional<Stamp> last;
    std::uint64_t number = 0;
    for (CaptureRecord record; reader->next(record);) {
        if (record.link != LinkKind::kStereo) {
            continue;
        }
        ++number;
        if (record.cut || (last && record.stamp - *last < spacing)) {
            continue;
        }
        last = record.stamp;
        const std::string name = file.string() + ": pair " + std::to_string(number);
        const std::optional<StereoRecord> pair = split_stereo_record(record.bytes);
        if (!pair) {
            throw InputError(name + ": its lengths contradict each other; was it recorded by this program?");
        }
        const GrayImage left = decode_gray_png(pair->left_png, name + ", left");
        const GrayImage right = decode_gray_png(pair->right_png, name + ", right");
        visit({.name = name,
               .view = {.left = left.view(), .right = right.view()},
               .stamp = record.stamp,
               .recorded = true,
               .share = reader->progress()});
    }
    if (number == 0) {
        throw InputError(file.string() +
                         ": a recording without pictures; record the stereo camera, or give a folder of pictures");
    }
}

}  // namespace

void for_each_pair(const fs::path& input, Duration spacing, const std::function<void(const NamedPair&)>& visit) {
    try {
        if (fs::is_directory(input)) {
            visit_folder(input, visit);
        } else {
            visit_recording(input, spacing, visit);
        }
    } catch (const fs::filesystem_error& e) {
        throw InputError(input.string() + ": cannot be read: " + e.code().message() +
                         "; check the path and its permissions");
    }
}

}  // namespace crspf
