#include "host/core/bricks/brick_sets.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "tests/support/instruction_sets.hpp"

namespace octoskin {
namespace {

TEST(BrickSets, have_what_a_look_at_each_voxel_finds_on_every_instruction_set) {
    on_each_instruction_set([](const std::string& name) {
        std::mt19937_64 random(9);
        for (int round = 0; round < 100; ++round) {
            BrickValues values;
            for (float& value : values) {
                const float one_of[] = {
                    kUnknownLogOdds, -2.0F, -0.0F, 0.5F, std::nextafter(0.5F, 0.0F), 3.5F};
                value = one_of[random() % 6];
            }
            const float limit = round % 2 == 0 ? 0.0F : 0.5F;
            for (std::size_t word = 0; word < kBrickVoxels / 64; ++word) {
                const WordSets sets = sets_of(values, word, limit);
                for (std::size_t i = 0; i < 64; ++i) {
                    const float value = values[64 * word + i];
                    ASSERT_EQ(sets.known >> i & 1U, std::isnan(value) ? 0U : 1U) << name;
                    ASSERT_EQ(sets.at_least >> i & 1U, value >= limit ? 1U : 0U) << name << ": " << value;
                }
            }
        }
    });
}

}  // namespace
}  // namespace octoskin
