#include <algorithm>
#include <cstddef>

#include "config/capacities.hpp"
#include "config/join.hpp"
#include "config/parameters.hpp"
#include "core/base/samples.hpp"

namespace crspf {

namespace {

std::string padded(std::string text, std::size_t width) {
    text.resize(std::max(width, text.size()), ' ');
    return text;
}

std::string type_of(const Parameter& p) {
    return is_boolean(p) ? "boolean" : !is_real(p) ? "integer" : p.whole ? "real, whole" : "real";
}

std::string mebibytes(std::size_t bytes) {
    constexpr std::size_t kMebi = std::size_t{1} << 20U;
    return join({std::to_string((bytes + kMebi / 2) / kMebi), " MiB"});
}

}  // namespace

std::string print_config(const Config& config) {
    const Config defaults;
    std::string out = "# The configuration in effect; `crspf config --reference` explains each key.\n";
    for (const Section& section : sections()) {
        out += join({"\n[", section.name, "]\n"});
        for (const Parameter& p : parameters()) {
            if (p.table == section.name) {
                const std::string value = text_of(p, config);
                const std::string default_value = text_of(p, defaults);
                out += padded(join({p.key, " = ", value}), 44);
                out += value == default_value ? "# default\n" : join({"# default: ", default_value, "\n"});
            }
        }
    }
    return out;
}

std::string config_reference() {
    const Config defaults;
    std::string out =
        "<!-- Generated: crspf config --reference > docs/configuration.md -->\n"
        "# Configuration reference\n\n"
        "A configuration is a TOML file. Every table and every key is optional; what is left out has its default.\n"
        "`crspf config --check FILE` names every mistake in a file, `crspf config --print FILE` shows what it amounts "
        "to.\nLengths are in metres, times in seconds, angles in degrees. A real number may be written as an integer. "
        "A key that\nis not listed here is an error.\n";
    for (const Section& section : sections()) {
        out += join({"\n## [", section.name, "]\n\n", section.meaning, "\n\n"});
        out += "| key | type | unit | default | range | meaning |\n|---|---|---|---|---|---|\n";
        for (const Parameter& p : parameters()) {
            if (p.table == section.name) {
                out += join({"| `", p.key, "` | ", type_of(p), " | ", p.unit, " | ", text_of(p, defaults), " | ",
                             range_of(p), " | ", p.meaning, " |\n"});
            }
        }
        const char* separator = "\nMust hold: ";
        for (const Order& o : orders()) {
            if (o.table == section.name) {
                out += join({separator, "`", o.lower, o.may_be_equal ? " <= " : " < ", o.upper, "`"});
                separator = ", ";
            }
        }
        out += *separator == ',' ? ".\n" : "";
    }
    return out;
}

std::string list_capacities() {
    constexpr std::size_t kTileCells = std::size_t{1} << (2U * capacity::kTileShift);
    constexpr std::size_t kTileBytes = kTileCells * 3;  // a byte of occupancy, two of match field
    struct Bound {
        const char* name;
        std::size_t value;
        std::string meaning;
    };
    const Bound bounds[] = {
        {"kBeams", capacity::kBeams,
         join({"beams in one scan; a scan takes ", std::to_string(sizeof(Scan)), " bytes"})},
        {"kTileShift", capacity::kTileShift, "log2 of a map tile's side in cells"},
        {"kTiles", capacity::kTiles,
         join({"tiles of the map; ", mebibytes(kTileBytes * capacity::kTiles), " when all are in use"})},
        {"kDirectoryTiles", capacity::kDirectoryTiles, "side of the map's directory in tiles"},
        {"kMotionHistory", capacity::kMotionHistory, "odometry poses kept for interpolation"},
        {"kCellChanges", capacity::kCellChanges, "cells that one map update may change"},
        {"kEvaluationsPerScan", capacity::kEvaluationsPerScan, "match evaluations for one scan"},
        {"kCloudColumns", capacity::kCloudColumns, "columns in one revolution of a Velodyne sensor"},
        {"kCloudPoints", capacity::kCloudPoints,
         join({"points in one revolution; together ", mebibytes(capacity::kCloudPoints * 14)})},
    };
    std::string out = "Compile-time bounds (config/capacities.hpp)\n";
    for (const Bound& b : bounds) {
        out += join({"  ", padded(b.name, 22), padded(std::to_string(b.value), 8), b.meaning, "\n"});
    }
    return out;
}

}  // namespace crspf
