#include "host/core/bricks/brick_runs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "host/core/bricks/brick.hpp"
#include "tests/support/instruction_sets.hpp"

namespace octoskin {
namespace {

/// Each mostly beside the one before, as a ray's; with luck somewhere else.
std::vector<VoxelUpdate> wandering(std::mt19937_64& random, std::size_t count) {
    std::vector<VoxelUpdate> updates;
    VoxelKey key{32767, 32768, 0};
    for (std::size_t i = 0; i < count; ++i) {
        updates.push_back({key, random() % 2 == 0 ? -0.4F : 0.7F});
        std::uint16_t* const axes[] = {&key.x, &key.y, &key.z};
        std::uint16_t& axis = *axes[random() % 3];
        axis = static_cast<std::uint16_t>(random() % 16 == 0 ? random() : axis + random() % 3 - 1);
    }
    return updates;
}

/// Oracle: one update after the other.
void expect_runs(const std::vector<VoxelUpdate>& updates, const std::string& where) {
    const auto found = std::make_unique<BrickRuns>();
    find_runs(updates, *found);
    std::size_t count = 0;
    std::size_t runs = 0;
    for (; count < std::min(updates.size(), BrickRuns::kUpdatesMax); ++count) {
        const VoxelUpdate& update = updates[count];
        if (!std::isfinite(update.log_odds) || update.log_odds == 0.0F) break;
        if (count == 0 || brick_of(update.key) != brick_of(updates[count - 1].key)) {
            ASSERT_EQ(found->first_of[runs], count) << where;
            ++runs;
        }
        ASSERT_EQ(found->cell_of[count], cell_of(update.key)) << where << ", update " << count;
    }
    ASSERT_EQ(found->updates, count) << where;
    ASSERT_EQ(found->runs, runs) << where;
}

TEST(BrickRuns, are_those_of_updates_one_by_one_on_every_instruction_set) {
    on_each_instruction_set([](const std::string& name) {
        std::mt19937_64 random(3);
        for (std::size_t count = 0; count < 300; ++count)
            expect_runs(wandering(random, count), name + ", " + std::to_string(count) + " updates");
    });
}

TEST(BrickRuns, end_before_the_first_term_that_is_none) {
    constexpr float kMax = std::numeric_limits<float>::max();
    constexpr float kLeast = std::numeric_limits<float>::denorm_min();
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    on_each_instruction_set([](const std::string& name) {
        std::mt19937_64 random(4);
        for (const float term :
             {0.0F, -0.0F, kInfinity, -kInfinity, kNan, -kNan, kMax, -kMax, kLeast, -kLeast}) {
            for (const std::size_t place : {0U, 1U, 3U, 15U, 16U, 17U, 39U}) {
                std::vector<VoxelUpdate> updates = wandering(random, 40);
                updates[place].log_odds = term;
                expect_runs(updates, name + ", " + std::to_string(term) + " at " + std::to_string(place));
            }
        }
    });
}

}  // namespace
}  // namespace octoskin
