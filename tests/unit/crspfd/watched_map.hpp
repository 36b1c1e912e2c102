// Somebody who watches: what he has been told, put together.
#pragma once

#include <array>
#include <catch2/catch.hpp>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "platform/crspfd/watch_board.hpp"
#include "platform/service/map_image.hpp"
#include "tools/view/watch_line.hpp"

namespace crspf::test {

/// The map of the tiles that he was sent.
class WatchedMap {
 public:
    void take(const view::TilesEvent& event) {
        if (event.fresh) {
            tiles_.clear();
            ++beginnings;
        }
        resolution_m = event.resolution_m;
        for (const TileImage& tile : event.tiles) {
            tiles_[{tile.corner.y, tile.corner.x}] = tile.cells;
            ++sent;
        }
    }
    [[nodiscard]] std::size_t size() const { return tiles_.size(); }
    /// Nullptr: he was sent none there.
    [[nodiscard]] const std::array<std::uint8_t, TileGeometry::kCells>* at(Cell corner) const {
        const auto found = tiles_.find({corner.y, corner.x});
        return found != tiles_.end() ? &found->second : nullptr;
    }
    /// As it would be saved.
    [[nodiscard]] GridMap grid() const {
        return export_map(
            [this](const TileVisitor& visit) {
                for (const auto& [corner, percent] : tiles_) {
                    TileCells cells;
                    for (std::size_t i = 0; i < cells.size(); ++i) {
                        cells[i] = percent[i] == TileImage::kUnseen ? kUnseen
                                   : percent[i] >= 50               ? kOccupiedCell
                                                                    : kFreeCell;
                    }
                    visit({.x = corner.second, .y = corner.first}, cells);
                }
            },
            resolution_m);
    }

    std::size_t beginnings = 0;
    std::size_t sent = 0;  ///< tiles
    double resolution_m = 0.0;

 private:
    std::map<std::pair<std::int32_t, std::int32_t>, std::array<std::uint8_t, TileGeometry::kCells>> tiles_;
};

/// One watcher of a board, without a socket.
class Watcher {
 public:
    /// The next line as an event; none where he has had all there is.
    std::optional<view::RunEvent> next(WatchBoard& board) {
        const std::string line = board.next(cursor);
        if (line.empty()) {
            return std::nullopt;
        }
        REQUIRE(line.back() == '\n');
        REQUIRE(line.find('\n') == line.size() - 1);
        REQUIRE(line.size() < view::kWatchLineMax / 8);
        view::WatchLine parsed = view::parse_watch_line(std::string_view(line).substr(0, line.size() - 1));
        INFO(line);
        INFO(parsed.text);
        REQUIRE(parsed.kind == view::WatchLine::Kind::kEvent);
        return std::move(parsed.event);
    }
    std::vector<view::RunEvent> all(WatchBoard& board) {
        std::vector<view::RunEvent> events;
        while (std::optional<view::RunEvent> event = next(board)) {
            if (const auto* const tiles = std::get_if<view::TilesEvent>(&*event)) {
                map.take(*tiles);
            }
            events.push_back(std::move(*event));
        }
        return events;
    }

    WatchCursor cursor;
    WatchedMap map;
};

template <class Event>
std::vector<Event> only(const std::vector<view::RunEvent>& events) {
    std::vector<Event> out;
    for (const view::RunEvent& event : events) {
        if (const auto* const found = std::get_if<Event>(&event)) {
            out.push_back(*found);
        }
    }
    return out;
}

}  // namespace crspf::test
