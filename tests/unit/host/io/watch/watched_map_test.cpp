// The map that a reader of `watch` puts together is the map, brick by brick.
#include "host/io/watch/watched_map.hpp"

#include <gtest/gtest.h>

#include <random>

#include "host/core/bricks/cell_term.hpp"
#include "host/io/watch/image_pace.hpp"
#include "host/io/watch/map_changes.hpp"
#include "tests/support/cases.hpp"
#include "tests/support/evidence.hpp"

namespace octoskin::watch {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

/// Changes a map at random places of some cubic metres, also by ageing.
class Changer {
  public:
    explicit Changer(unsigned seed) : random_(seed) {}
    void change(FusedMap& map, int voxels) {
        now_.ns += std::uniform_int_distribution<std::int64_t>(0, kSecond / 2)(random_);
        map.advance_time(now_);
        std::vector<VoxelUpdate> updates;
        for (int i = 0; i < voxels; ++i) updates.push_back({key(), term()});
        feed(map, updates, pick() ? SensorKind::camera : SensorKind::range);
    }

  private:
    bool pick() { return std::uniform_int_distribution<int>(0, 1)(random_) == 1; }
    VoxelKey key() {
        std::uniform_int_distribution<int> place(-40, 40);
        const auto at = [&] { return static_cast<std::uint16_t>(32'768 + place(random_)); };
        return {at(), at(), at()};
    }
    float term() { return std::uniform_real_distribution<float>(-1.5F, 1.5F)(random_); }

    std::mt19937 random_;
    HostTime now_{kSecond};
};

MapConfig ageing() {
    MapConfig config{.resolution_m = 0.05};
    config.age = {.stale_after_s = 3, .unknown_after_s = 9};
    return config;
}

/// Everything that the reader knows is so in the map, and the other way round.
void expect_equal(const WatchedMap& watched, const FusedMap& map) {
    EXPECT_TRUE(watched.is_complete());
    EXPECT_EQ(watched.map().known_voxels(), map.known_voxels());
    EXPECT_EQ(watched.map().stale_stamp(), map.stale_stamp());
    BrickCodes bricks = bricks_of(map);
    std::size_t there = 0;
    watched.log_odds().for_each([&](MortonCode, const BrickView&) { ++there; });
    EXPECT_EQ(there, map.layers().log_odds.bricks());
    for (const MortonCode brick : bricks) {
        const BrickView expected = map.layers().log_odds.find(brick);
        const BrickView found = watched.log_odds().find(brick);
        const StampView dated = map.layers().ages.find(brick);
        for (std::size_t cell = 0; cell < kBrickVoxels; ++cell) {
            ASSERT_EQ(std::bit_cast<std::uint32_t>(found.at(cell)),
                      std::bit_cast<std::uint32_t>(expected.at(cell)));
            ASSERT_EQ(watched.stamps().find(brick).at(cell), dated.at(cell));
            const VoxelKey key = key_of_morton(brick + cell);
            ASSERT_EQ(watched.occupancy(key), map.occupancy(key));
            ASSERT_EQ(watched.confirmation(key), map.confirmation(key));
            ASSERT_EQ(watched.is_stale(key), map.is_stale(key));
        }
    }
}

/// A reader that takes as many payloads at a time as it is given.
class Reader {
  public:
    void on_map(const FusedMap& now, const FusedMap* before) {
        lacks_.on_map(now, before == nullptr ? BrickCodes{} : changed_bricks(now, *before));
    }
    /// False if it lacks nothing.
    bool read(const FusedMap& now, std::size_t bytes_max, const BrickRecords& made = {}) {
        const auto piece = lacks_.next(now, bytes_max, made);
        if (!piece) return false;
        EXPECT_EQ(map.take({.kind = FrameKind::map, .flags = piece->flags}, piece->payload),
                  WatchedMap::Taken::all);
        return (piece->flags & kComplete) == 0;
    }
    WatchedMap map;

  private:
    MapReader lacks_;
};

// A reader that reads all, one that reads a little of each, and one that stalls and begins anew.
TEST(WatchedMap, is_the_map_after_a_hundred_thousand_random_changes_however_slowly_it_is_read) {
    std::mt19937 random(5);
    FusedMap map(ageing());
    Changer changer(7);
    Reader quick;
    Reader slow;
    std::optional<Reader> again;
    std::optional<FusedMap> before;
    const unsigned rounds = testing_support::cases(500);
    for (unsigned round = 0; round < rounds; ++round) {
        changer.change(map, 200);
        FusedMap now = map.copy();
        if (round % 50 == 0) again.reset();
        const FusedMap* const last = before ? &*before : nullptr;
        quick.on_map(now, last);
        slow.on_map(now, last);
        const bool is_new = !again;
        if (is_new) again.emplace();
        again->on_map(now, is_new ? nullptr : last);
        const BrickRecords made(now, last == nullptr ? BrickCodes{} : changed_bricks(now, *last));
        while (quick.read(now, 4'000, made)) continue;
        if (round % 25 == 0) expect_equal(quick.map, now);
        if (random() % 3 != 0) (void)slow.read(now, 2'000);
        if (round % 50 > 25) (void)again->read(now, 100'000);
        before = std::move(now);
    }
    while (slow.read(*before, 2'000)) continue;
    while (again->read(*before, 2'000)) continue;
    expect_equal(slow.map, *before);
    expect_equal(again->map, *before);
}

TEST(WatchedMap, forgets_what_the_map_forgets) {
    FusedMap map(ageing());
    map.advance_time({kSecond});
    feed(map, std::vector<VoxelUpdate>{{{32'768, 32'768, 32'768}, 1.0F}}, SensorKind::camera);
    Reader reader;
    const FusedMap first = map.copy();
    reader.on_map(first, nullptr);
    (void)reader.read(first, 1'000);
    EXPECT_EQ(reader.map.occupancy({32'768, 32'768, 32'768}), Occupancy::occupied);
    for (int s = 2; s < 40; ++s) map.advance_time({s * kSecond});
    ASSERT_EQ(map.known_voxels(), 0U);
    reader.on_map(map, &first);
    (void)reader.read(map, 1'000);
    EXPECT_EQ(reader.map.occupancy({32'768, 32'768, 32'768}), Occupancy::unknown);
    EXPECT_EQ(reader.map.log_odds().bricks(), 0U);
}

TEST(WatchedMap, takes_no_payload_that_is_cut_or_changed_to_something_impossible) {
    FusedMap map(ageing());
    Changer(3).change(map, 400);
    MissingBricks missing;
    missing.add(bricks_of(map));
    const std::string payload = missing.take(map, 1U << 20U);
    const FrameHeader begins{.kind = FrameKind::map, .flags = kBegins | kComplete};
    EXPECT_EQ(WatchedMap().take({.kind = FrameKind::map}, payload), WatchedMap::Taken::malformed)
        << "no begin";
    EXPECT_EQ(WatchedMap(1'000).take(begins, payload), WatchedMap::Taken::no_room);
    std::mt19937 random(11);
    for (unsigned i = 0; i < testing_support::cases(2'000); ++i) {
        std::string other = payload.substr(0, random() % payload.size());
        if (!other.empty()) other[random() % other.size()] ^= static_cast<char>(1U << random() % 8);
        WatchedMap watched(std::size_t{8} << 20U);
        (void)watched.take(begins, other);  // ends, within its memory
        EXPECT_LE(watched.log_odds().bricks() * BrickTree::kBrickBytes, std::size_t{9} << 20U);
    }
}

TEST(BrickRecords, are_those_of_a_payload_and_of_no_other_brick) {
    FusedMap map(ageing());
    Changer(9).change(map, 400);
    const BrickCodes bricks = bricks_of(map);
    ASSERT_GT(bricks.size(), 20U);
    BrickCodes half;
    for (std::size_t i = 0; i < bricks.size(); i += 2) half.push_back(bricks[i]);
    const BrickRecords made(map, half);
    for (std::size_t i = 0; i < bricks.size(); ++i) {
        MissingBricks alone;
        alone.add({bricks[i]});
        const std::string payload = alone.take(map, 1);
        if (i % 2 == 0)
            EXPECT_TRUE(payload.ends_with(made.find(bricks[i])) && !made.find(bricks[i]).empty());
        else
            EXPECT_TRUE(made.find(bricks[i]).empty());
    }
    MissingBricks all;
    all.add(bricks);
    MissingBricks again = all;
    EXPECT_EQ(all.take(map, 1U << 20U, made), again.take(map, 1U << 20U));
}

TEST(ImagePace, lets_one_image_in_200_ms_through_of_each_camera) {
    ImagePace pace;
    constexpr std::int64_t kMs = 1'000'000;
    EXPECT_TRUE(pace.takes(1, {0}));
    EXPECT_FALSE(pace.takes(1, {199 * kMs}));
    EXPECT_TRUE(pace.takes(0, {199 * kMs})) << "another camera";
    EXPECT_TRUE(pace.takes(1, {200 * kMs}));
    EXPECT_TRUE(pace.takes(1, {100 * kMs})) << "its clock has stepped back";
    EXPECT_FALSE(pace.takes(1, {150 * kMs}));
}

TEST(MissingBricks, come_in_turn_so_that_none_waits_for_ever) {
    FusedMap map(ageing());
    Changer changer(9);
    changer.change(map, 5'000);
    MissingBricks missing;
    const BrickCodes all = bricks_of(map);
    ASSERT_GT(all.size(), 50U);
    missing.add(all);
    for (std::size_t i = 0; i < all.size(); ++i) {
        (void)missing.take(map, 1);                       // one brick
        missing.add({all.front(), all[all.size() / 2]});  // these change all the time
    }
    EXPECT_LE(missing.size(), 3U) << "each of the others had its turn";
}

}  // namespace
}  // namespace octoskin::watch
