// The keeper of tiles that are far from the robot: on a disk, in a file without a name that ends with the process.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "core/slam/roaming_map.hpp"
#include "platform/files/unique_fd.hpp"

namespace crspf {

struct TileArchiveState {
    std::uint64_t tiles = 0;         ///< that have ever been away
    std::uint64_t brought_back = 0;  ///< in all
    std::uint64_t in_memory = 0;     ///< of the tiles: the disk did not take them
    std::uint64_t lost = 0;          ///< could not be read
    std::string problem;             ///< of the disk; empty: none
};

/// What it gives back, and in which order, follows from what it was given alone, whenever turn() is called. 4 KiB of
/// disk for each place where a tile has been; 4 MiB of memory once there is one. From any thread; waits for the disk.
class TileArchive {
 public:
    /// @param directory for the file, made when the first tile comes
    explicit TileArchive(std::filesystem::path directory) : directory_(std::move(directory)) {}

    /// Takes what has been sent away, and sends back what is near the robot.
    void turn(TileRings& rings);
    /// Keeps a tile, beside what it has of it.
    void keep(Cell corner, const TileCells& cells);

    using Visitor = std::function<void(Cell corner, const TileCells& cells)>;
    /// Every tile that has ever been away, as it was then. Where the map has it, the map is right.
    void for_each_tile(const Visitor& visit);
    /// Of these the ones that are away now, piecewise: `number` begins at 0 and goes on by at most `count` tiles. True
    /// where there are more.
    bool for_some_away(std::uint32_t& number, std::uint32_t count, const Visitor& visit);
    [[nodiscard]] TileArchiveState state() const;

 private:
    struct Place {
        std::uint32_t number = 0;  ///< in the file; 0: never been away
        bool away = false;
    };

    [[nodiscard]] bool open();
    [[nodiscard]] bool read(std::uint32_t number, TileCells& cells);
    void write(std::uint32_t number, const TileCells& cells);
    void keep_locked(Cell corner, const TileCells& cells);
    void bring_back_near(Cell robot, std::int32_t within);

    std::filesystem::path directory_;
    mutable std::mutex mutex_;
    std::vector<Place> places_;  ///< by TileGeometry::slot()
    std::vector<Cell> corners_;  ///< by number - 1
    UniqueFd file_;
    std::map<std::uint32_t, TileCells> unwritten_;  ///< by number
    std::deque<TileRecord> returning_;
    TileArchiveState state_;
};

}  // namespace crspf
