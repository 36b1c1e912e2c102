// The service's memory across restarts: the map and where the robot was on it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/pose.hpp"
#include "platform/files/grid_map.hpp"

namespace crspf {

/// A directory with the last two maps (map-N.pgm, map-N.yaml of map_server) and state.json, which names them with their
/// checksums and the robot's pose. state.json is written last and appears whole or not at all: whatever moment a crash
/// or a power cut picks, it names maps that are whole. One thread's; waits for the disk.
class MapStore {
 public:
    static constexpr int kVersion = 1;  ///< of state.json

    /// Makes the directory where it is missing. Throws InputError where that, or writing into it, is not possible, and
    /// for a state.json of another version or that is none.
    explicit MapStore(std::filesystem::path directory);

    [[nodiscard]] const std::filesystem::path& directory() const { return directory_; }

    struct Saved {
        GridMap map;
        std::optional<Pose2> P_map_base;  ///< none: unknown when it was saved
        std::filesystem::path yaml;
        std::string warning;  ///< the newest map was damaged and this is the one before; empty: all is well
    };
    /// Nothing where nothing was saved. Throws InputError where all that was saved is damaged.
    [[nodiscard]] std::optional<Saved> load() const;

    /// Throws InputError: disk full, not writable. What was saved before stays then.
    /// @return the YAML file
    std::filesystem::path save(const GridMap& map, const std::optional<Pose2>& P_map_base);
    /// The robot has moved on the map that was saved last. Nothing where none was.
    void save_pose(const Pose2& P_map_base);

 private:
    struct Entry {
        std::uint64_t number = 0;
        std::string pgm_sha256;
        std::string yaml_sha256;
        std::optional<Pose2> P_map_base;
    };

    [[nodiscard]] std::filesystem::path stem(std::uint64_t number) const;
    [[nodiscard]] std::string damage_of(const Entry& entry) const;
    void write_state() const;

    std::filesystem::path directory_;
    std::vector<Entry> entries_;  ///< newest first
};

}  // namespace crspf
