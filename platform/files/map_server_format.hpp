// The two file formats of map_server, as pure functions of their bytes.
#pragma once

#include <string>
#include <string_view>

#include "core/base/pose.hpp"
#include "platform/files/grid_map.hpp"

namespace crspf {

/// Bounds of what is read: a hostile header allocates nothing beyond them, nor beyond a small multiple of its own file.
inline constexpr int kMapSideMax = 65536;               ///< [cells]
inline constexpr std::size_t kMapCellsMax = 1U << 28U;  ///< [cells] 256 MiB

/// What the YAML file says. Thresholds are on occupancy, 0 to 1: at or between them a cell is unknown.
struct MapDescription {
    std::string image;          ///< path of the PGM file as written
    double resolution_m = 0.0;  ///< [m] side of a cell
    Pose2 P_map_origin;         ///< lower-left corner of the image
    bool negate = false;        ///< black is free
    double occupied_thresh = 0.0;
    double free_thresh = 0.0;
};

/// Reads the subset of YAML that map_server's files use: `key: value` lines, `#` comments, quoted strings, lists in
/// brackets or one item a line. Keys that map_server does not know are passed over, as it does. In `mode: scale` the
/// shades between the thresholds become unknown: a GridMap is trinary.
/// `name` is the file in messages. Throws InputError.
[[nodiscard]] MapDescription parse_map_yaml(std::string_view text, const std::string& name);

/// Reads a PGM image, P5 or P2, maxval 1 to 255. Throws InputError.
[[nodiscard]] GridMap parse_pgm(std::string_view bytes, const MapDescription& description, const std::string& name);

}  // namespace crspf
