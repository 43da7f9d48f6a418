#include "host/core/query/unknown_pockets.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include "host/core/voxels/morton.hpp"

namespace octoskin {
namespace {

/// Checks whether the search is to end. Called for each voxel, it calls `is_ending` only every few thousand
/// times.
class End {
  public:
    explicit End(const std::function<bool()>& is_ending) : is_ending_(is_ending) {}
    /// Once true, it stays true.
    bool is_here() {
        constexpr std::size_t kAtOnce = 4096;
        if (!is_here_ && ++asked_ % kAtOnce == 0) is_here_ = is_ending_();
        return is_here_;
    }

  private:
    const std::function<bool()>& is_ending_;
    std::size_t asked_ = 0;
    bool is_here_ = false;
};

enum class Cell : std::uint8_t { outside, known, free, unknown, taken };

/// The region's box with a layer of `outside` around it, so that each of its voxels has six neighbours.
class Grid {
  public:
    Grid(const FusedMap& map, const PocketRegion& region, VoxelKey lowest, VoxelKey highest, End& end)
        : lowest_(lowest),
          size_{highest.x - lowest.x + 3U, highest.y - lowest.y + 3U, highest.z - lowest.z + 3U},
          cells_(size_[0] * size_[1] * size_[2], Cell::outside) {
        for (std::size_t i = 0; i < cells_.size() && !end.is_here(); ++i) {
            if (is_edge(i)) continue;
            const VoxelKey key = key_of(i);
            if (!is_within(region, map.centre_of(key))) continue;
            const Occupancy state = map.occupancy(key);
            cells_[i] = state == Occupancy::unknown ? Cell::unknown
                        : state == Occupancy::free  ? Cell::free
                                                    : Cell::known;
        }
    }
    [[nodiscard]] std::size_t size() const { return cells_.size(); }
    [[nodiscard]] Cell& operator[](std::size_t i) { return cells_[i]; }
    [[nodiscard]] std::array<std::size_t, 6> beside(std::size_t i) const {
        const std::size_t row = size_[0];
        const std::size_t slice = size_[0] * size_[1];
        return {i - 1, i + 1, i - row, i + row, i - slice, i + slice};
    }
    [[nodiscard]] VoxelKey key_of(std::size_t i) const {
        const auto at = [](std::uint16_t lowest, std::size_t place) {
            return static_cast<std::uint16_t>(lowest + place - 1);
        };
        return {at(lowest_.x, i % size_[0]), at(lowest_.y, i / size_[0] % size_[1]),
                at(lowest_.z, i / (size_[0] * size_[1]))};
    }

  private:
    [[nodiscard]] bool is_edge(std::size_t i) const {
        const std::array place{i % size_[0], i / size_[0] % size_[1], i / (size_[0] * size_[1])};
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (place.at(axis) == 0 || place.at(axis) + 1 == size_.at(axis)) return true;
        return false;
    }
    VoxelKey lowest_;
    std::array<std::size_t, 3> size_;
    std::vector<Cell> cells_;
};

struct Component {
    std::vector<std::size_t> cells;
    std::vector<std::size_t> border;
};

/// Removes the voxels connected with `first` from the grid.
Component take_component(Grid& grid, std::size_t first, End& end) {
    Component component{{first}, {}};
    grid[first] = Cell::taken;
    // Bounded by the grid: each voxel is taken once.
    for (std::size_t i = 0; i < component.cells.size() && !end.is_here(); ++i) {
        bool is_border = false;
        for (const std::size_t other : grid.beside(component.cells[i])) {
            is_border = is_border || grid[other] == Cell::free;
            if (grid[other] != Cell::unknown) continue;
            grid[other] = Cell::taken;
            component.cells.push_back(other);
        }
        if (is_border) component.border.push_back(component.cells[i]);
    }
    return component;
}

UnknownPocket pocket_of(const FusedMap& map, const Grid& grid, const Component& component) {
    UnknownPocket pocket;
    pocket.voxels = component.cells.size();
    pocket.border_voxels = component.border.size();
    pocket.volume_m3 = static_cast<double>(pocket.voxels) * std::pow(map.resolution_m(), 3);
    for (const std::size_t cell : component.cells) pocket.centre += map.centre_of(grid.key_of(cell));
    pocket.centre /= static_cast<double>(pocket.voxels);
    double nearest_m = std::numeric_limits<double>::infinity();
    for (const std::size_t cell : component.border) {
        const VoxelKey key = grid.key_of(cell);
        const double distance_m = (map.centre_of(key) - pocket.centre).norm();
        if (distance_m >= nearest_m) continue;
        nearest_m = distance_m;
        pocket.nearest_border = key;
    }
    return pocket;
}

struct Corners {
    VoxelKey lowest;
    VoxelKey highest;
};

std::optional<Corners> corners_of(const FusedMap& map, const PocketRegion& region) {
    const Eigen::Vector3d lowest = region.centre.array() - region.radius_m;
    const auto first = map.key_of({lowest.x(), lowest.y(), std::max(lowest.z(), region.z_min_m)});
    const auto last = map.key_of(region.centre.array() + region.radius_m);
    if (!first || !last || first->z > last->z) return std::nullopt;
    // A product of three numbers below 2^17.
    const std::uint64_t voxels =
        (last->x - first->x + 3ULL) * (last->y - first->y + 3ULL) * (last->z - first->z + 3ULL);
    if (voxels > UnknownPockets::kVoxelsMax) return std::nullopt;
    return Corners{*first, *last};
}

}  // namespace

std::optional<UnknownPockets> UnknownPockets::find(const FusedMap& map, const PocketRegion& region,
                                                   std::size_t voxels_min,
                                                   const std::function<bool()>& is_ending) {
    if (!(region.radius_m > 0.0) || !std::isfinite(region.z_min_m)) return std::nullopt;
    const auto corners = corners_of(map, region);
    if (!corners) return std::nullopt;
    End end(is_ending);
    Grid grid(map, region, corners->lowest, corners->highest, end);
    UnknownPockets found;
    std::vector<Border> borders;
    for (std::size_t i = 0; i < grid.size() && !end.is_here(); ++i) {
        found.region_voxels_ += grid[i] != Cell::outside ? 1U : 0U;
        if (grid[i] != Cell::unknown) {
            found.unknown_voxels_ += grid[i] == Cell::taken ? 1U : 0U;
            continue;
        }
        ++found.unknown_voxels_;
        const Component component = take_component(grid, i, end);
        if (component.border.empty() || component.cells.size() < voxels_min) continue;
        const auto number = static_cast<std::uint32_t>(found.pockets_.size());
        found.pockets_.push_back(pocket_of(map, grid, component));
        for (const std::size_t cell : component.border)
            borders.push_back({morton_of(grid.key_of(cell)), number});
    }
    if (end.is_here()) return std::nullopt;
    std::vector<std::uint32_t> order(found.pockets_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::stable_sort(order, std::ranges::greater{},
                             [&](std::uint32_t pocket) { return found.pockets_[pocket].voxels; });
    std::vector<std::uint32_t> place(order.size());
    std::vector<UnknownPocket> sorted;
    for (std::uint32_t i = 0; i < order.size(); ++i) {
        place[order[i]] = i;
        sorted.push_back(found.pockets_[order[i]]);
    }
    found.pockets_ = std::move(sorted);
    for (Border& border : borders) border.pocket = place[border.pocket];
    std::ranges::sort(borders, {}, &Border::voxel);
    found.borders_ = std::move(borders);
    return found;
}

std::optional<std::size_t> UnknownPockets::border_of(VoxelKey key) const noexcept {
    const std::uint64_t voxel = morton_of(key);
    const auto found = std::ranges::lower_bound(borders_, voxel, {}, &Border::voxel);
    if (found == borders_.end() || found->voxel != voxel) return std::nullopt;
    return found->pocket;
}

}  // namespace octoskin
