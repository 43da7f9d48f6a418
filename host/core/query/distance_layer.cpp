#include "host/core/query/distance_layer.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <utility>

namespace octoskin {
namespace {

constexpr int kBricksPerAxis = kVoxelsPerAxis / kBrickEdge;
constexpr std::uint64_t kAllOfSlice = ~std::uint64_t{0};
constexpr auto kRow = static_cast<std::size_t>(kBrickEdge);

/// By place along z, y and x: the order of the sweeps.
struct BrickPlace {
    std::array<int, 3> at{};
};

BrickPlace place_of(std::uint64_t key) {
    constexpr std::uint64_t kMask = kBricksPerAxis - 1;
    return {{static_cast<int>(key >> 26U & kMask), static_cast<int>(key >> 13U & kMask),
             static_cast<int>(key & kMask)}};
}
std::uint64_t brick_key(const BrickPlace& place) {
    const auto part = [&](std::size_t axis) { return static_cast<std::uint64_t>(place.at.at(axis)); };
    return part(0) << 26U | part(1) << 13U | part(2);
}
std::uint64_t brick_key(VoxelKey voxel) {
    return brick_key({{voxel.z / kBrickEdge, voxel.y / kBrickEdge, voxel.x / kBrickEdge}});
}
bool is_in_octree(int place) {
    return place >= 0 && place < kBricksPerAxis;
}

/// Compilers make a few wide instructions of each of these.
template <class Slab, class Value>
void lower(Slab& least, const Slab& values, Value square) {
    for (std::size_t i = 0; i < least.size(); ++i) {
        const auto sum = static_cast<Value>(values[i] + square);
        least[i] = sum < least[i] ? sum : least[i];
    }
}
template <class Slab>
auto largest_of(const Slab& values) {
    auto largest = values[0];
    for (const auto value : values) largest = value > largest ? value : largest;
    return largest;
}
template <class Slab>
auto least_of(const Slab& values) {
    auto least = values[0];
    for (const auto value : values) least = value < least ? value : least;
    return least;
}

}  // namespace

DistanceLayer::DistanceLayer(bool is_site_elsewhere, int reach)
    : reach_(reach),
      brick_reach_((reach + kBrickEdge - 1) / kBrickEdge),
      beyond_(static_cast<Value>(reach * reach + 1)),
      elsewhere_(is_site_elsewhere ? Value{0} : beyond_) {
    assert(reach >= 1 && reach <= kReachMax);
    plain_.sites.fill(is_site_elsewhere ? kAllOfSlice : 0);
    for (Values& values : plain_.after) {
        for (Slab& slab : values.slabs) slab.fill(elsewhere_);
        values.least.fill(elsewhere_);
    }
}

/// One that is not there is plain.
const DistanceLayer::Brick* DistanceLayer::find(BrickKey key) const noexcept {
    const auto found = bricks_.find(key);
    return found == bricks_.end() ? &plain_ : found->second.get();
}

DistanceLayer::Brick& DistanceLayer::open(BrickKey key) {
    auto& brick = bricks_[key];
    if (!brick) brick = std::make_unique<Brick>(plain_);
    return *brick;
}

bool DistanceLayer::set_sites(MortonCode brick, const SiteSlices& sites) {
    const BrickKey key = brick_key(key_of_morton(brick));
    if (find(key)->sites == sites) return false;
    open(key).sites = sites;
    changed_.push_back(key);
    return true;
}

/// Changes travel along z, then along y, then along x: each sweep begins with what the one before changed.
std::size_t DistanceLayer::settle() {
    std::size_t worked = 0;
    std::vector<BrickKey> changed = std::exchange(changed_, {});
    std::vector<BrickKey> touched = changed;
    for (const Axis axis : kAxes) {
        const std::vector<BrickKey> keys = neighbours(changed, axis);
        worked += keys.size();
        changed.clear();
        for (const BrickKey key : keys)
            if (sweep(key, axis)) changed.push_back(key);
        touched.insert(touched.end(), changed.begin(), changed.end());
    }
    drop_plain(touched);
    return worked;
}

std::vector<DistanceLayer::BrickKey> DistanceLayer::neighbours(const std::vector<BrickKey>& changed,
                                                               Axis axis) const {
    std::vector<BrickKey> keys;
    keys.reserve(changed.size() * static_cast<std::size_t>(2 * brick_reach_ + 1));
    for (const BrickKey key : changed) {
        for (int step = -brick_reach_; step <= brick_reach_; ++step) {
            BrickPlace place = place_of(key);
            int& at = place.at.at(static_cast<std::size_t>(axis));
            at += step;
            if (is_in_octree(at)) keys.push_back(brick_key(place));
        }
    }
    std::ranges::sort(keys);
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    return keys;
}

/// Whether the brick's values after this axis are others than before.
bool DistanceLayer::sweep(BrickKey key, Axis axis) {
    const Values values = axis == Axis::z ? along_z(key) : along(key, axis);
    const auto number = static_cast<std::size_t>(axis);
    if (find(key)->after.at(number).slabs == values.slabs) return false;
    open(key).after.at(number) = values;
    return true;
}

/// Of 64 columns at once: those that meet a site one step further away than any before get that distance.
DistanceLayer::Values DistanceLayer::along_z(BrickKey key) const {
    std::vector<std::uint64_t> column;
    column.reserve(static_cast<std::size_t>(2 * brick_reach_ + 1) * kRow);
    for (int step = -brick_reach_; step <= brick_reach_; ++step) {
        BrickPlace place = place_of(key);
        place.at[0] += step;
        const SiteSlices& sites = is_in_octree(place.at[0]) ? find(brick_key(place))->sites : plain_.sites;
        column.insert(column.end(), sites.begin(), sites.end());
    }
    Values values;
    for (Slab& slab : values.slabs) slab.fill(beyond_);
    values.least.fill(beyond_);
    const auto middle = static_cast<std::ptrdiff_t>(brick_reach_) * kBrickEdge;
    for (std::size_t z = 0; z < kRow; ++z) {
        const std::uint64_t* const centre = column.data() + middle + static_cast<std::ptrdiff_t>(z);
        std::uint64_t met = 0;
        for (int step = 0; step <= reach_ && met != kAllOfSlice; ++step) {
            const auto square = static_cast<Value>(step * step);
            for (auto fresh = (centre[step] | centre[-step]) & ~met; fresh != 0; fresh &= fresh - 1) {
                const auto bit = static_cast<std::size_t>(std::countr_zero(fresh));
                values.slabs[bit / kRow][bit % kRow + kRow * z] = square;
                values.least[bit / kRow] = std::min(values.least[bit / kRow], square);
            }
            met |= centre[step] | centre[-step];
        }
    }
    return values;
}

/// Slab by slab outwards, until what comes is too far away to be less for any voxel.
DistanceLayer::Values DistanceLayer::along(BrickKey key, Axis axis) const {
    const auto number = static_cast<std::size_t>(axis);
    std::vector<const Values*> column;
    for (int step = -brick_reach_; step <= brick_reach_; ++step) {
        BrickPlace place = place_of(key);
        place.at.at(number) += step;
        const Brick* const brick = is_in_octree(place.at.at(number)) ? find(brick_key(place)) : &plain_;
        column.push_back(&brick->after.at(number - 1));
    }
    Values values;
    for (int at = 0; at < kBrickEdge; ++at) {
        const int middle = brick_reach_ * kBrickEdge + at;
        const auto slab_at = [&](int place) -> const Slab& {
            return column[static_cast<std::size_t>(place / kBrickEdge)]
                ->slabs[static_cast<std::size_t>(place % kBrickEdge)];
        };
        const auto least_at = [&](int place) {
            return column[static_cast<std::size_t>(place / kBrickEdge)]
                ->least[static_cast<std::size_t>(place % kBrickEdge)];
        };
        Slab least = slab_at(middle);
        Value worst = largest_of(least);
        for (int step = 1; step <= reach_ && step * step < worst; ++step) {
            const auto square = static_cast<Value>(step * step);
            bool is_lowered = false;
            for (const int place : {middle - step, middle + step}) {
                if (least_at(place) + square >= worst) continue;
                lower(least, slab_at(place), square);
                is_lowered = true;
            }
            if (is_lowered) worst = largest_of(least);
        }
        for (Value& value : least) value = std::min(value, beyond_);
        if (axis == Axis::x) {
            values.slabs[static_cast<std::size_t>(at)] = least;
        } else {
            // The next sweep goes along x: of row z, voxel x goes to slab x.
            for (std::size_t i = 0; i < kSlab; ++i)
                values.slabs[i % kRow][static_cast<std::size_t>(at) + kRow * (i / kRow)] = least[i];
        }
    }
    for (std::size_t i = 0; i < kRow; ++i) values.least[i] = least_of(values.slabs[i]);
    return values;
}

/// Bricks that are as they would be if nobody had spoken of them.
void DistanceLayer::drop_plain(const std::vector<BrickKey>& touched) {
    const auto is_plain = [&](const Brick& brick) {
        for (std::size_t i = 0; i < brick.after.size(); ++i)
            if (brick.after[i].slabs != plain_.after[i].slabs) return false;
        return brick.sites == plain_.sites;
    };
    for (const BrickKey key : touched) {
        const auto found = bricks_.find(key);
        if (found != bricks_.end() && is_plain(*found->second)) bricks_.erase(found);
    }
}

std::optional<int> DistanceLayer::squared(VoxelKey key) const noexcept {
    const auto in_brick = [](std::uint16_t place) { return static_cast<std::size_t>(place % kBrickEdge); };
    const Values& values = find(brick_key(key))->after.back();
    const Value value = values.slabs[in_brick(key.x)][in_brick(key.y) + kRow * in_brick(key.z)];
    if (value >= beyond_) return std::nullopt;
    return value;
}

std::size_t DistanceLayer::memory_bytes() const noexcept {
    constexpr std::size_t kEntry = 64;  // what the table takes for it, about
    return bricks_.size() * (sizeof(Brick) + kEntry);
}

}  // namespace octoskin
