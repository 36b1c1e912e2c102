// The match field (paper 4.3, formula (10)): the inner sum of (10) for every cell, so that a ray costs one look-up.
//
// (10)'s block around a point is a fixed kernel: 1 in the middle, delta_1 = 2/3 on the ring around it, delta_2 = 1/3 on
// the next. m is linear in the pixel values c, so F = c (*) kernel holds the block sum of every cell. Three times the
// kernel is 3, 2, 1: the field is kept in whole numbers, and a sum over rays is the same on any processor.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/base/kernel.hpp"
#include "core/base/pose.hpp"
#include "core/slam/occupancy.hpp"
#include "core/slam/tile_grid.hpp"

namespace crspf {

/// Three times the block sum of (10) around a cell, in the low 15 bits; the top bit: the map has seen the cell.
using FieldValue = std::uint16_t;
inline constexpr FieldValue kSeen = 0x8000;
inline constexpr FieldValue kSumMask = 0x7FFF;

struct FieldTile {
    std::array<FieldValue, TileGeometry::kCells> cells;
};

/// The kernel's reach in cells: K of (10).
inline constexpr int kBlockReach = 2;
/// Three times the kernel's weight on ring 0, 1 and 2.
inline constexpr std::array<int, kBlockReach + 1> kRingWeight{3, 2, 1};
inline constexpr int kFieldScale = 3;
/// The largest field value: every cell of the block at 255.
inline constexpr int kFieldMax = 255 * (3 + 8 * 2 + 16 * 1);
static_assert(kFieldMax <= kSumMask);
/// The largest m of (10), the scale on which the match thresholds are read: 2975.
inline constexpr double kMatchMax = static_cast<double>(kFieldMax) / kFieldScale;

/// Points to be placed by a pose. Frame: base_link. [cells]
/// Vector kernels read whole blocks: the arrays must be readable up to kPointLanes - 1 past the last point.
inline constexpr std::uint32_t kPointLanes = 8;
struct FieldPoints {
    const float* x = nullptr;
    const float* y = nullptr;
    std::uint32_t count = 0;
};

/// A pose in the coordinates of a FieldView. [cells], single precision: exact to 2^-10 of a cell there.
struct FieldPose {
    float cos = 1.0F;
    float sin = 0.0F;
    float x = 0.0F;
    float y = 0.0F;
};

/// The field seen from near the robot: coordinates count from the lower-left corner of a window of 128 x 128 tiles with
/// the robot near its middle, so that none is negative and single precision suffices.
/// Valid until the field changes. Every look-up must stay in the window: see MatchField::kReach.
struct FieldView {
    static constexpr std::int32_t kTiles = 128;
    const std::uint16_t* directory = nullptr;  ///< at the window's corner
    const FieldValue* pool = nullptr;
    Cell corner;

    [[nodiscard]] const FieldValue& cell(std::int32_t ix, std::int32_t iy) const {
        constexpr auto kRow = static_cast<std::size_t>(TileGeometry::kDirectorySide);
        const std::size_t slot = static_cast<std::size_t>(iy >> TileGeometry::kShift) * kRow +
                                 static_cast<std::size_t>(ix >> TileGeometry::kShift);
        return pool[(static_cast<std::size_t>(directory[slot]) << (2 * TileGeometry::kShift)) +
                    TileGeometry::offset({.x = ix, .y = iy})];
    }
    [[nodiscard]] FieldValue raw(std::int32_t ix, std::int32_t iy) const { return cell(ix, iy); }
    [[nodiscard]] int value(std::int32_t ix, std::int32_t iy) const { return cell(ix, iy) & kSumMask; }

    /// Four neighbours, two by two: the value to the left in the low half, the value to the right in the high half.
    struct Square {
        std::uint32_t lower = 0;  ///< at a cell and right of it
        std::uint32_t upper = 0;  ///< above these
    };
    /// Of a cell in row or column kMask of its tile; slower.
    [[nodiscard]] Square square_at_edge(std::int32_t ix, std::int32_t iy) const;
    /// Of another cell, by its place in the window's directory and in its tile.
    [[nodiscard]] Square square_within(std::int32_t slot, std::int32_t offset) const {
        constexpr std::ptrdiff_t kRow = TileGeometry::kSide;
        const FieldValue* at =
            pool + (static_cast<std::ptrdiff_t>(directory[slot]) << (2 * TileGeometry::kShift)) + offset;
        return {.lower = pair(at[0], at[1]), .upper = pair(at[kRow], at[kRow + 1])};
    }

    /// `P_map_base` in the view's coordinates.
    [[nodiscard]] FieldPose place(const Pose2& P_map_base, double cells_per_metre) const;

 private:
    [[nodiscard]] static std::uint32_t pair(FieldValue left, FieldValue right) {
        constexpr std::uint32_t kBoth = (std::uint32_t{kSumMask} << 16U) | kSumMask;
        return (std::uint32_t{left} | std::uint32_t{right} << 16U) & kBoth;
    }
};

/// Sum of the field over points at a pose: the numerator of (10) for rays of equal weight, times 3. One look-up a ray.
/// The kernels give the same sum; AVX2 or NEON is taken where the processor has it. Wait-free, linear in the points.
using FieldSum = std::uint32_t (*)(const FieldView&, const FieldPoints&, const FieldPose&);
[[nodiscard]] std::uint32_t field_sum_portable(const FieldView& view, const FieldPoints& points, const FieldPose& pose);
#if defined(__x86_64__)
[[nodiscard]] std::uint32_t field_sum_avx2(const FieldView& view, const FieldPoints& points, const FieldPose& pose);
#endif
#if defined(__ARM_NEON)
[[nodiscard]] std::uint32_t field_sum_neon(const FieldView& view, const FieldPoints& points, const FieldPose& pose);
#endif

[[nodiscard]] FieldSum field_sum_kernel(Kernel kernel);

/// The filter's own image of the map. Follows the map by its changes; nobody else writes it.
/// No heap, no throw. One owner.
class MatchField {
 public:
    /// Brings the field up to date: 25 cells for each change. Linear in the changes, whatever the map's size.
    void follow(const ChangeList& changes);
    void follow(std::span<const CellChange> changes);

    /// Three times the block sum around a cell; 0 where nothing is.
    [[nodiscard]] int at(Cell c) const { return field_.at(c) & kSumMask; }
    /// Whether the map has seen the cell.
    [[nodiscard]] bool seen(Cell c) const { return (field_.at(c) & kSeen) != 0; }

    /// The view with `robot` near its middle. False when it would reach past the directory: the robot has left the
    /// map's extent.
    [[nodiscard]] bool view_around(Cell robot, FieldView& view) const;

    /// No point that is looked up through a view may be farther than this from the robot. [cells]
    static constexpr std::int32_t kReachTiles = FieldView::kTiles / 2 - 2;
    static constexpr double kReach = static_cast<double>(kReachTiles * TileGeometry::kSide);

    [[nodiscard]] const TileGrid<FieldTile>& tiles() const { return field_; }

 private:
    void add_tile(const TileChange& tile);
    void remove_tile(const TileChange& tile);
    void release_if_empty(Cell c);
    void add_block(Cell middle, int difference);

    TileGrid<FieldTile> field_;
};

}  // namespace crspf
