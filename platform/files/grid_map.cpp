#include "platform/files/grid_map.hpp"

#include <array>
#include <charconv>
#include <string>
#include <string_view>

#include "platform/files/atomic_file.hpp"
#include "platform/files/input_error.hpp"
#include "platform/files/map_server_format.hpp"
#include "platform/files/read_file.hpp"

namespace crspf {
namespace {

constexpr std::size_t kYamlBytesMax = 65536;
constexpr std::size_t kImageBytesMax = kMapCellsMax + 65536;

// The shortest digits that read back as the same number.
std::string digits(double value) {
    std::array<char, 32> text{};
    return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

// As it is where that is safe, which every reader understands; else as a YAML string in single quotes.
std::string yaml_string(const std::string& text) {
    constexpr std::string_view kSafe = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._";
    if (text.find_first_not_of(std::string(kSafe) + "-") == text.npos && kSafe.find(text.front()) != kSafe.npos) {
        return text;
    }
    std::string quoted = "'";
    for (const char c : text) {
        quoted.append(c == '\'' ? 2 : 1, c);
    }
    return quoted + "'";
}

char shade(GridCell cell) {
    switch (cell) {
        case GridCell::kFree: return static_cast<char>(254);
        case GridCell::kOccupied: return 0;
        case GridCell::kUnknown: break;
    }
    return static_cast<char>(205);
}

}  // namespace

GridMap read_grid_map(const std::filesystem::path& yaml) {
    const MapDescription description = parse_map_yaml(read_file(yaml, kYamlBytesMax), yaml.string());
    const std::filesystem::path image = yaml.parent_path() / description.image;
    return parse_pgm(read_file(image, kImageBytesMax), description, image.string());
}

void write_grid_map(const GridMap& map, const std::filesystem::path& stem) {
    const std::string image = stem.string() + ".pgm";
    if (map.width <= 0 || map.height <= 0) {
        throw InputError(image + ": the map is empty, there is nothing to write; check that scans were read");
    }
    AtomicFile pgm(image);
    pgm.write("P5\n# CREATOR: crspf " + digits(map.resolution_m) + " m/pix\n" + std::to_string(map.width) + " " +
              std::to_string(map.height) + "\n255\n");
    std::string line(static_cast<std::size_t>(map.width), '\0');
    for (int row = map.height - 1; row >= 0; --row) {
        for (int column = 0; column < map.width; ++column) {
            line[static_cast<std::size_t>(column)] = shade(map.at(column, row));
        }
        pgm.write(line);
    }
    AtomicFile yaml(stem.string() + ".yaml");
    yaml.write("image: " + yaml_string(std::filesystem::path(image).filename().string()) +
               "\nmode: trinary\nresolution: " + digits(map.resolution_m) + "\norigin: [" +
               digits(map.P_map_origin.x_m) + ", " + digits(map.P_map_origin.y_m) + ", " +
               digits(map.P_map_origin.theta_rad) + "]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n");
    // The image first: a description never names an image that is not there.
    pgm.commit();
    yaml.commit();
}

}  // namespace crspf
