#include "host/io/watch/watched_map.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <utility>

#include "host/io/snapshot/brick_records.hpp"
#include "host/io/watch/brick_form.hpp"

namespace octoskin::watch {
namespace {

using snapshot::ByteReader;

constexpr std::uint64_t kBricks = (std::uint64_t{1} << 48U) / kBrickVoxels;

bool is_value(float value) {
    return std::isfinite(value) ||
           std::bit_cast<std::uint32_t>(value) == std::bit_cast<std::uint32_t>(kUnknownLogOdds);
}
bool is_value(std::uint16_t) {
    return true;
}

std::size_t known_in(const BrickView& brick) {
    if (brick.values == nullptr) return brick.is_unknown() ? 0 : kBrickVoxels;
    const auto is_known = [](float log_odds) { return !std::isnan(log_odds); };
    return static_cast<std::size_t>(std::ranges::count_if(*brick.values, is_known));
}

template <class Value>
bool take_layer(ByteReader& reader, BrickTreeOf<Value>& tree, MortonCode brick) {
    const auto form = reader.get<std::uint8_t>();
    if (form == static_cast<std::uint8_t>(BrickForm::unknown)) {
        tree.forget(brick);
    } else if (form == static_cast<std::uint8_t>(BrickForm::alike)) {
        const auto value = reader.get<Value>();
        if (!reader.is_sound() || UnknownValue<Value>::is(value) || !is_value(value)) return false;
        tree.set_all(brick, value);
    } else if (form == static_cast<std::uint8_t>(BrickForm::runs)) {
        BrickValuesOf<Value> values;
        snapshot::get_values(reader, values);
        if (!reader.is_sound() || !std::ranges::all_of(values, [](Value one) { return is_value(one); }))
            return false;
        tree.open(brick) = values;
    } else {
        return false;
    }
    return reader.is_sound();
}

}  // namespace

WatchedMap::Taken WatchedMap::take(const FrameHeader& header, std::string_view payload) {
    const bool begins = (header.flags & kBegins) != 0;
    if (begins) *this = WatchedMap(bytes_max_);
    is_complete_ = false;
    ByteReader reader(payload);
    if (!take_head(reader, begins)) return Taken::malformed;
    while (!reader.is_over()) {
        if (!take_brick(reader)) return Taken::malformed;
        if (bytes() > bytes_max_) return Taken::no_room;
    }
    time_ = header.time;
    is_complete_ = (header.flags & kComplete) != 0;
    is_whole_ = is_whole_ || is_complete_;
    return Taken::all;
}

bool WatchedMap::take_head(ByteReader& reader, bool begins) {
    Head head;
    head.resolution_m = reader.get<double>();
    head.occupied_from = reader.get<float>();
    head.has_begun = reader.get_flag();
    head.clock = reader.get<std::uint32_t>();
    head.stale_stamp = reader.get<std::uint16_t>();
    const bool is_sound = reader.is_sound() && std::isfinite(head.resolution_m) && head.resolution_m > 0.0 &&
                          std::isfinite(head.occupied_from);
    const bool continues = has_begun_ && head.resolution_m == head_.resolution_m;
    if (!is_sound || (!begins && !continues)) return false;
    has_begun_ = true;
    head_ = head;
    return true;
}

bool WatchedMap::take_brick(ByteReader& reader) {
    const std::uint64_t number = reader.get_count();
    if (!reader.is_sound() || number >= kBricks) return false;
    const MortonCode brick = number * kBrickVoxels;
    known_voxels_ -= known_in(log_odds_.find(brick));
    const bool is_taken = take_layer(reader, log_odds_, brick);
    const BrickView now = log_odds_.find(brick);
    known_voxels_ += known_in(now);
    widen_clamps(now);
    return is_taken && take_layer(reader, stamps_, brick);
}

void WatchedMap::widen_clamps(const BrickView& brick) {
    const std::size_t values = brick.values == nullptr ? 1 : kBrickVoxels;
    for (std::size_t cell = 0; cell < values; ++cell) {
        const float log_odds = brick.at(cell);  // a NaN changes neither
        lowest_ = log_odds < lowest_ ? log_odds : lowest_;
        highest_ = log_odds > highest_ ? log_odds : highest_;
    }
}

std::size_t WatchedMap::bytes() const noexcept {
    return log_odds_.nodes() * BrickTree::kNodeBytes + log_odds_.bricks() * BrickTree::kBrickBytes +
           stamps_.nodes() * StampTree::kNodeBytes + stamps_.bricks() * StampTree::kBrickBytes;
}

Occupancy WatchedMap::occupancy(VoxelKey key) const noexcept {
    const float log_odds = log_odds_.find(brick_of(key)).at(cell_of(key));
    if (std::isnan(log_odds)) return Occupancy::unknown;
    return log_odds >= head_.occupied_from ? Occupancy::occupied : Occupancy::free;
}

/// The inverse of VoxelAges::stamp_before.
std::uint32_t WatchedMap::stale_after_s() const noexcept {
    constexpr unsigned kKindBits = 2;
    const auto newest_stale = static_cast<std::uint32_t>(head_.stale_stamp >> kKindBits);
    return head_.stale_stamp == 0 || newest_stale > head_.clock ? 0 : head_.clock + 1 - newest_stale;
}

FusedMap WatchedMap::map() const {
    assert(is_whole_);
    MapConfig config{.resolution_m = head_.resolution_m, .log_odds_occupied = head_.occupied_from};
    config.log_odds_min = std::min(config.log_odds_min, lowest_);
    config.log_odds_max = std::max(config.log_odds_max, highest_);
    config.age.stale_after_s = stale_after_s();
    MapLayers layers{.log_odds = log_odds_, .counts = {}, .ages = {}, .known_voxels = known_voxels_};
    layers.ages = VoxelAges({.has_begun = head_.has_begun, .now = head_.clock}, stamps_);
    return {config, std::move(layers), false};
}

std::optional<Confirmation> WatchedMap::confirmation(VoxelKey key) const noexcept {
    if (occupancy(key) == Occupancy::unknown) return std::nullopt;
    const VoxelAges ages({.has_begun = head_.has_begun, .now = head_.clock}, {});
    return ages.confirmation_of(stamps_.find(brick_of(key)).at(cell_of(key)));
}

bool WatchedMap::is_stale(VoxelKey key) const noexcept {
    return occupancy(key) != Occupancy::unknown &&
           stamps_.find(brick_of(key)).at(cell_of(key)) < head_.stale_stamp;
}

}  // namespace octoskin::watch
