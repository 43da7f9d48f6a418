#include "tests/bench/bridge/sheets.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace octoskin::bridge_bench {
namespace {

constexpr int kSurfaces = 4;
constexpr int kFreeBefore = 4;
constexpr int kBetweenSurfaces = 60;
constexpr double kWaveHeight = 12.0;
constexpr double kWaveLength = 37.0;

int height_of(int x, int y) {
    return static_cast<int>(std::lround(kWaveHeight * std::sin(x / kWaveLength) * std::cos(y / kWaveLength)));
}

}  // namespace

Sheets::Sheets(std::size_t occupied, double resolution_m) : resolution_m_(resolution_m) {
    const int side = static_cast<int>(std::lround(std::sqrt(static_cast<double>(occupied) / kSurfaces)));
    std::uniform_int_distribution<int> noise(0, 1);
    for (int surface = 0; surface < kSurfaces; ++surface)
        for (int x = 0; x < side; ++x)
            for (int y = 0; y < side; ++y)
                add_column(x, y, surface * kBetweenSurfaces + height_of(x, y) + noise(chance_));
    log_odds_.for_each([this](MortonCode brick, const BrickView&) { bricks_.push_back(brick); });
}

void Sheets::add_column(int x, int y, int z) {
    std::uniform_int_distribution<int> hits(1, 4);
    const auto key_of = [](int voxel) { return static_cast<std::uint16_t>(kOriginKey + voxel); };
    set({key_of(x), key_of(y), key_of(z)}, 0.85F * static_cast<float>(hits(chance_)));
    for (int i = 1; i <= kFreeBefore; ++i)
        set({key_of(x), key_of(y), key_of(z + i)}, -0.4F * static_cast<float>(hits(chance_)));
}

void Sheets::set(VoxelKey key, float log_odds) {
    log_odds_.open(brick_of(key))[cell_of(key)] = log_odds;
    stamps_.open(brick_of(key))[cell_of(key)] = static_cast<std::uint16_t>(4 * clock_ + 2);
    ++known_;
}

watch::BrickCodes Sheets::change(double share) {
    watch::BrickCodes changed;
    const auto count = static_cast<std::size_t>(share * static_cast<double>(bricks_.size()));
    std::ranges::sample(bricks_, std::back_inserter(changed), static_cast<std::ptrdiff_t>(count), chance_);
    for (const MortonCode brick : changed) change_brick(brick);
    return changed;
}

void Sheets::change_brick(MortonCode brick) {
    BrickValues& values = log_odds_.open(brick);
    std::vector<std::size_t> occupied;
    std::vector<std::size_t> free;
    for (std::size_t cell = 0; cell < kBrickVoxels; ++cell)
        if (!std::isnan(values[cell])) (values[cell] >= 0.0F ? occupied : free).push_back(cell);
    std::ranges::shuffle(occupied, chance_);
    std::ranges::shuffle(free, chance_);
    const std::size_t count = std::min(occupied.size(), free.size()) / 4;
    for (std::size_t i = 0; i < count; ++i) std::swap(values[occupied[i]], values[free[i]]);
    for (std::uint16_t& stamp : stamps_.open(brick))
        if (stamp != 0) stamp = static_cast<std::uint16_t>(4 * clock_ + 2);
}

FusedMap Sheets::map() const {
    const MapConfig config{.resolution_m = resolution_m_};
    MapLayers layers{.log_odds = log_odds_, .counts = {}, .ages = {}, .known_voxels = known_};
    layers.ages = VoxelAges({.has_begun = true, .now = clock_}, stamps_);
    return {config, std::move(layers), false};
}

}  // namespace octoskin::bridge_bench
