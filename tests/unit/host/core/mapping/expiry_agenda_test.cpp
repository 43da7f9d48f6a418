#include "host/core/mapping/expiry_agenda.hpp"

#include <gtest/gtest.h>

#include <map>
#include <new>
#include <set>

namespace octoskin {
namespace {

constexpr std::size_t kBricks = 640;

/// Bricks, and the earliest stamp that each has in truth.
class Bricks {
  public:
    Bricks() {
        for (MortonCode brick = 0; brick < kBricks; ++brick) put(512 * brick, 100);
    }
    void put(MortonCode brick, std::uint16_t stamp) {
        agenda_.make_room();
        agenda_.put(brick, stamp);
        oldest_[brick] = stamp;
    }
    std::multiset<MortonCode> look_at_due(std::uint16_t first, std::uint16_t limit) {
        std::multiset<MortonCode> looked;
        agenda_.look_at_due(first, limit, [&](MortonCode brick) {
            looked.insert(brick);
            return oldest_.at(brick);
        });
        return looked;
    }
    ExpiryAgenda agenda_;
    std::map<MortonCode, std::uint16_t> oldest_;
};

TEST(ExpiryAgenda, looks_at_all_that_may_be_too_old_and_at_few_others) {
    Bricks bricks;
    bricks.put(7, 50);
    bricks.put(9, 51);
    bricks.oldest_[7] = 80;  // confirmed meanwhile
    const auto looked = bricks.look_at_due(1, 60);
    EXPECT_EQ(looked.count(7), 1U);
    EXPECT_EQ(looked.count(9), 1U);
    EXPECT_LE(looked.size(), 2U + 11U);
    const auto later = bricks.look_at_due(1, 60);
    EXPECT_EQ(later.count(9), 1U) << "as old as before";
    EXPECT_LE(later.size(), 1U + 11U);
    EXPECT_LE(bricks.look_at_due(52, 60).count(9), 1U);
}

TEST(ExpiryAgenda, has_what_was_confirmed_meanwhile_come_due_bit_by_bit) {
    Bricks bricks;
    for (auto& [brick, stamp] : bricks.oldest_) stamp = 500;
    std::set<MortonCode> looked;
    for (int call = 0; call < 64; ++call) {
        const auto some = bricks.look_at_due(1, 60);
        EXPECT_LE(some.size(), 11U);
        looked.insert(some.begin(), some.end());
    }
    EXPECT_EQ(looked.size(), kBricks);
    EXPECT_LE(bricks.look_at_due(1, 400).size(), 11U) << "none is older than 500 any more";
}

TEST(ExpiryAgenda, lets_go_of_what_has_no_stamp_and_keeps_the_rest) {
    Bricks bricks;
    for (MortonCode brick = 0; brick < kBricks; brick += 3) bricks.oldest_[512 * brick] = 0;
    EXPECT_GE(bricks.look_at_due(1, 101).size(), kBricks);
    const auto left = bricks.look_at_due(1, 101);
    for (const auto& [brick, stamp] : bricks.oldest_) EXPECT_EQ(left.count(brick) > 0, stamp > 0) << brick;
    for (auto& [brick, stamp] : bricks.oldest_) stamp = 0;
    (void)bricks.look_at_due(1, 101);
    EXPECT_EQ(bricks.agenda_.heap_bytes(), 0U);
    EXPECT_TRUE(bricks.look_at_due(1, 101).empty());
}

TEST(ExpiryAgenda, is_left_as_it_was_by_what_throws) {
    Bricks bricks;
    EXPECT_THROW(
        bricks.agenda_.look_at_due(1, 101, [](MortonCode) -> std::uint16_t { throw std::bad_alloc(); }),
        std::bad_alloc);
    const auto looked = bricks.look_at_due(1, 101);
    EXPECT_EQ(std::set<MortonCode>(looked.begin(), looked.end()).size(), kBricks);
}

TEST(ExpiryAgenda, is_not_kept_by_a_copy) {
    ExpiryAgenda agenda;
    agenda.begin();
    const ExpiryAgenda copy(agenda);
    EXPECT_TRUE(agenda.is_kept());
    EXPECT_FALSE(copy.is_kept());
}

}  // namespace
}  // namespace octoskin
