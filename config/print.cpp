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

/// `key = value`, and whether that is the default.
template <class Owner>
std::string line_of(const ParameterOf<Owner>& p, const Owner& owner, const Owner& defaults) {
    const std::string value = text_of(p, owner);
    const std::string default_value = text_of(p, defaults);
    std::string line = join({p.key, " = ", value});
    if (default_value == "\"\"" || p.key == "driver") {
        return join({line, "\n"});
    }
    line = padded(line, 43);
    return value == default_value ? join({line, " # default\n"}) : join({line, " # default: ", default_value, "\n"});
}

std::string print_source(const SourceConfig& source) {
    const SourceConfig defaults;
    const std::string driver = text_of(source_parameters().front(), source);
    std::string out = join({"\n[source.", source.name, "]\n"});
    for (const SourceParameter& p : source_parameters()) {
        const bool ours = p.table.empty() || driver == join({"\"", p.table, "\""});
        // The text says what the file said, and a recording must not depend on the file.
        if (ours && p.key != "dbc") {
            out += line_of(p, source, defaults);
        }
    }
    for (const SignalConfig& signal : source.can.signals) {
        out += join({"\n[source.", source.name, ".", signal.role, "]\n"});
        for (const SignalParameter& p : signal_parameters()) {
            out += line_of(p, signal, SignalConfig{});
        }
    }
    return out;
}

template <class Owner>
std::string reference_row(const ParameterOf<Owner>& p, const Owner& defaults) {
    return join({"| `", p.key, "` | ", type_of(p), " | ", p.unit, " | ", text_of(p, defaults), " | ", range_of(p),
                 " | ", p.meaning, " |\n"});
}

constexpr const char* kTableHead = "| key | type | unit | default | range | meaning |\n|---|---|---|---|---|---|\n";

std::string source_reference() {
    const SourceConfig defaults;
    std::string out =
        "\n## [source.NAME]\n\n"
        "A sensor and the port it is at; NAME is also its name in recordings. A robot has one lidar and one odometer "
        "in use;\nfurther ones can be recorded.\n";
    std::string_view group = "-";
    for (const SourceParameter& p : source_parameters()) {
        if (p.table != group) {
            group = p.table;
            out += group.empty() ? join({"\nOf every source:\n\n", kTableHead})
                                 : join({"\nWith driver = \"", group, "\":\n\n", kTableHead});
        }
        out += reference_row(p, defaults);
    }
    out += "\n## [source.NAME.ROLE]\n\nA signal of a CAN bus and what it is to the odometry. ROLE is one of";
    const char* separator = " ";
    for (const std::string_view role : signal_roles()) {
        out += join({separator, "`", role, "`"});
        separator = ", ";
    }
    out +=
        join({".\nGive `left` and `right` (differential), `speed` and `steering` (Ackermann), or `speed` and "
              "`yaw_rate` (IMU);\n`yaw_rate` alone where nobody tells the speed, which the scans show then. With "
              "`second_speed`, such as of the other\nrear wheel, the speed is the mean of the two.\n\n",
              kTableHead});
    for (const SignalParameter& p : signal_parameters()) {
        out += reference_row(p, SignalConfig{});
    }
    return out;
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
                out += line_of(p, config, defaults);
            }
        }
    }
    for (const SourceConfig& source : config.sources) {
        out += print_source(source);
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
        out += kTableHead;
        for (const Parameter& p : parameters()) {
            if (p.table == section.name) {
                out += reference_row(p, defaults);
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
    out += source_reference();
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
        {"kTilesKept", capacity::kTilesKept,
         "tiles of these that are kept when the robot drives on; far ones go to the disk"},
        {"kDirectoryTiles", capacity::kDirectoryTiles, "side of the map's directory in tiles"},
        {"kMotionHistory", capacity::kMotionHistory, "odometry poses kept for interpolation"},
        {"kAttitudes", capacity::kAttitudes, "tilts of the vehicle kept for levelling a revolution"},
        {"kCellChanges", capacity::kCellChanges, "cells that one map update may change"},
        {"kEvaluationsPerScan", capacity::kEvaluationsPerScan, "match evaluations for one scan"},
        {"kCloudLasers", capacity::kCloudLasers, "lasers of a sensor of many"},
        {"kSectors", capacity::kSectors, "sectors in which obstacles are sought"},
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
