// Whatever the bytes of a map's description and image: a whole map or an InputError. One input holds both: the image
// begins at the first line that begins with P2 or P5.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "platform/files/input_error.hpp"
#include "platform/files/map_server_format.hpp"

namespace {

void require(bool promise) {
    if (!promise) {
        std::abort();
    }
}

void check(const crspf::GridMap& map) {
    require(map.width > 0 && map.height > 0);
    require(map.cells.size() == static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height));
    require(map.resolution_m > 0.0 && std::isfinite(map.P_map_origin.x_m) && std::isfinite(map.P_map_origin.y_m));
    for (const crspf::GridCell cell : map.cells) {
        require(cell <= crspf::GridCell::kOccupied);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string input(data, data + size);
    const std::size_t image = std::min(input.find("\nP2"), input.find("\nP5"));
    const std::string_view yaml = std::string_view(input).substr(0, image);
    const std::string_view pgm = image == input.npos ? "" : std::string_view(input).substr(image + 1);
    try {
        check(crspf::parse_pgm(pgm, crspf::parse_map_yaml(yaml, "fuzz.yaml"), "fuzz.pgm"));
    } catch (const crspf::InputError& e) {
        require(std::string_view(e.what()).starts_with("fuzz."));
    }
    return 0;
}
