#include "platform/service/tile_archive.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <utility>

namespace crspf {
namespace {

constexpr std::int32_t kSide = TileGeometry::kSide;
constexpr std::size_t kSlots = std::size_t{TileGeometry::kDirectorySide} * TileGeometry::kDirectorySide;

::off_t offset_of(std::uint32_t number) {
    return static_cast<::off_t>(number - 1) * static_cast<::off_t>(sizeof(TileCells));
}

}  // namespace

void TileArchive::turn(TileRings& rings) {
    const std::lock_guard lock(mutex_);
    while (const TileRecord* const record = rings.away.front()) {
        if (record->kind == TileRecord::Kind::kTile) {
            keep_locked(record->cell, record->cells);
        } else if (!places_.empty()) {
            bring_back_near(record->cell, record->within);
        }
        rings.away.pop();
    }
    while (!returning_.empty() && !rings.back.full()) {
        rings.back.push(returning_.front());
        returning_.pop_front();
    }
    if (!unwritten_.empty()) {
        const auto [number, cells] = *unwritten_.begin();
        write(number, cells);
    }
}

void TileArchive::keep(Cell corner, const TileCells& cells) {
    const std::lock_guard lock(mutex_);
    keep_locked(corner, cells);
}

void TileArchive::keep_locked(Cell corner, const TileCells& cells) {
    if (places_.empty()) {
        places_.resize(kSlots);
    }
    Place& place = places_[TileGeometry::slot(corner)];
    place.away = true;
    if (place.number == 0) {
        corners_.push_back(corner);
        place.number = static_cast<std::uint32_t>(corners_.size());
        ++state_.tiles;
        write(place.number, cells);
        return;
    }
    // What the map has not seen of it since, because it was not brought back in time, is here.
    TileCells merged;
    if (!read(place.number, merged)) {
        merged = cells;
    }
    std::transform(cells.begin(), cells.end(), merged.begin(), merged.begin(),
                   [](Evidence seen, Evidence before) { return seen != kUnseen ? seen : before; });
    write(place.number, merged);
}

void TileArchive::bring_back_near(Cell robot, std::int32_t within) {
    const auto tile_of = [](std::int32_t cell) {
        return std::clamp(cell >> TileGeometry::kShift, -TileGeometry::kDirectorySide / 2,
                          TileGeometry::kDirectorySide / 2 - 1);
    };
    std::vector<std::pair<std::int64_t, Cell>> near;
    for (std::int32_t y = tile_of(robot.y - within); y <= tile_of(robot.y + within); ++y) {
        for (std::int32_t x = tile_of(robot.x - within); x <= tile_of(robot.x + within); ++x) {
            const Cell corner{.x = x * kSide, .y = y * kSide};
            const std::int64_t distance = squared_distance(corner, robot);
            if (places_[TileGeometry::slot(corner)].away && distance <= std::int64_t{within} * within) {
                near.emplace_back(distance, corner);
            }
        }
    }
    std::stable_sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [distance, corner] : near) {
        Place& place = places_[TileGeometry::slot(corner)];
        place.away = false;
        TileRecord& record = returning_.emplace_back();
        record.cell = corner;
        if (read(place.number, record.cells)) {
            ++state_.brought_back;
        } else {
            ++state_.lost;
            returning_.pop_back();
        }
    }
}

void TileArchive::for_each_tile(const Visitor& visit) {
    const std::lock_guard lock(mutex_);
    TileCells cells;
    for (std::uint32_t number = 1; number <= corners_.size(); ++number) {
        if (read(number, cells)) {
            visit(corners_[number - 1], cells);
        }
    }
}

bool TileArchive::for_some_away(std::uint32_t& number, std::uint32_t count, const Visitor& visit) {
    const std::lock_guard lock(mutex_);
    TileCells cells;
    for (; count > 0 && number < corners_.size(); --count) {
        const Cell corner = corners_[number++];
        if (places_[TileGeometry::slot(corner)].away && read(number, cells)) {
            visit(corner, cells);
        }
    }
    return number < corners_.size();
}

TileArchiveState TileArchive::state() const {
    const std::lock_guard lock(mutex_);
    TileArchiveState state = state_;
    state.in_memory = unwritten_.size();
    return state;
}

bool TileArchive::open() {
    if (!file_.valid()) {
        std::string name = (directory_ / "tiles-XXXXXX").string();
        file_ = UniqueFd(::mkostemp(name.data(), O_CLOEXEC));
        if (!file_.valid()) {
            state_.problem = directory_.string() +
                             ": no file for far tiles of the map can be made: " + ::strerrordesc_np(errno) +
                             "; they stay in memory";
            return false;
        }
        ::unlink(name.c_str());
    }
    return true;
}

bool TileArchive::read(std::uint32_t number, TileCells& cells) {
    if (const auto kept = unwritten_.find(number); kept != unwritten_.end()) {
        cells = kept->second;
        return true;
    }
    const ::ssize_t count = ::pread(file_.get(), cells.data(), cells.size(), offset_of(number));
    if (count != static_cast<::ssize_t>(cells.size())) {
        state_.problem = directory_.string() + ": a far tile of the map cannot be read: " +
                         (count < 0 ? ::strerrordesc_np(errno) : "the file is short");
        return false;
    }
    return true;
}

void TileArchive::write(std::uint32_t number, const TileCells& cells) {
    if (open()) {
        const ::ssize_t count = ::pwrite(file_.get(), cells.data(), cells.size(), offset_of(number));
        if (count == static_cast<::ssize_t>(cells.size())) {
            unwritten_.erase(number);
            if (unwritten_.empty()) {
                state_.problem.clear();
            }
            return;
        }
        state_.problem = directory_.string() +
                         ": far tiles of the map cannot be written: " + ::strerrordesc_np(count < 0 ? errno : ENOSPC) +
                         "; they stay in memory";
    }
    unwritten_[number] = cells;
}

}  // namespace crspf
