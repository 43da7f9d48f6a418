#include "host/io/watch/map_changes.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "host/io/snapshot/brick_records.hpp"
#include "host/io/watch/brick_form.hpp"
#include "host/io/watch/watch_frame.hpp"

namespace octoskin::watch {
namespace {

using snapshot::ByteWriter;

/// Two sorted lists as one, each brick once.
BrickCodes merged(const BrickCodes& a, const BrickCodes& b) {
    BrickCodes all;
    all.reserve(a.size() + b.size());
    std::ranges::set_union(a, b, std::back_inserter(all));
    return all;
}

void put_head(ByteWriter& writer, const FusedMap& map) {
    const VoxelAges::Clock& clock = map.layers().ages.clock();
    writer.put(map.resolution_m());
    writer.put(static_cast<float>(map.config().log_odds_occupied));
    writer.put_flag(clock.has_begun);
    writer.put(clock.now);
    writer.put(map.stale_stamp());
}

template <class Value>
void put_layer(ByteWriter& writer, const BrickViewOf<Value>& view) {
    if (view.is_unknown()) return writer.put(static_cast<std::uint8_t>(BrickForm::unknown));
    const bool is_dense = view.values != nullptr;
    writer.put(static_cast<std::uint8_t>(is_dense ? BrickForm::runs : BrickForm::alike));
    is_dense ? snapshot::put_values(writer, *view.values) : writer.put(view.value);
}

void put_brick(ByteWriter& writer, const FusedMap& map, MortonCode brick) {
    writer.put_count(brick / kBrickVoxels);
    put_layer(writer, map.layers().log_odds.find(brick));
    put_layer(writer, map.layers().ages.find(brick));
}

}  // namespace

BrickCodes bricks_of(const FusedMap& map) {
    BrickCodes known;
    BrickCodes dated;
    map.layers().log_odds.for_each([&](MortonCode brick, const BrickView&) { known.push_back(brick); });
    map.layers().ages.stamps().for_each([&](MortonCode brick, const StampView&) { dated.push_back(brick); });
    return merged(known, dated);
}

BrickCodes changed_bricks(const FusedMap& now, const FusedMap& before) {
    BrickCodes written;
    BrickCodes dated;
    now.layers().log_odds.for_each_difference(before.layers().log_odds,
                                              [&](MortonCode brick) { written.push_back(brick); });
    now.layers().ages.stamps().for_each_difference(before.layers().ages.stamps(),
                                                   [&](MortonCode brick) { dated.push_back(brick); });
    return merged(written, dated);
}

BrickRecords::BrickRecords(const FusedMap& map, const BrickCodes& bricks) {
    ByteWriter writer(bytes_);
    for (auto brick = bricks.begin(); brick != bricks.end() && bytes_.size() < kBytesMax; ++brick) {
        put_brick(writer, map, *brick);
        codes_.push_back(*brick);
        ends_.push_back(bytes_.size());
    }
}

std::string_view BrickRecords::find(MortonCode brick) const noexcept {
    const auto found = std::ranges::lower_bound(codes_, brick);
    if (found == codes_.end() || *found != brick) return {};
    const auto index = static_cast<std::size_t>(found - codes_.begin());
    const std::size_t begin = index == 0 ? 0 : ends_[index - 1];
    return std::string_view(bytes_).substr(begin, ends_[index] - begin);
}

void MissingBricks::add(const BrickCodes& bricks) {
    codes_ = merged(codes_, bricks);
}

std::string MissingBricks::take(const FusedMap& map, std::size_t bytes_max, const BrickRecords& made) {
    std::string payload;
    ByteWriter writer(payload);
    put_head(writer, map);
    auto first = std::ranges::lower_bound(codes_, next_);
    if (first == codes_.end()) first = codes_.begin();
    auto last = first;
    for (; last != codes_.end() && (last == first || payload.size() < bytes_max); ++last)
        if (const std::string_view record = made.find(*last); !record.empty())
            payload += record;
        else
            put_brick(writer, map, *last);
    next_ = last == codes_.end() ? 0 : *last;
    codes_.erase(first, last);
    return payload;
}

void MapReader::on_map(const FusedMap& now, const BrickCodes& changed) {
    missing_.add(has_map_ ? changed : bricks_of(now));
    has_map_ = true;
    is_behind_ = true;
}

std::optional<MapReader::Piece> MapReader::next(const FusedMap& now, std::size_t bytes_max,
                                                const BrickRecords& made) {
    if (!is_behind_) return std::nullopt;
    Piece piece{0, missing_.take(now, bytes_max, made)};
    is_behind_ = !missing_.empty();
    if (!is_behind_) piece.flags |= kComplete;
    if (!std::exchange(has_begun_, true)) piece.flags |= kBegins;
    return piece;
}

}  // namespace octoskin::watch
