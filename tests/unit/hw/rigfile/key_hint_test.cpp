#include "hw/rigfile/key_hint.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace octoskin::rig {
namespace {

TEST(NearestWord, forgives_two_letters_and_no_more) {
    const std::vector<std::string> known{"simulate", "replay", "rig"};
    EXPECT_EQ(nearest_word("reply", known), "replay");
    EXPECT_EQ(nearest_word("simualte", known), "simulate");
    EXPECT_EQ(nearest_word("rig", known), "rig");
    EXPECT_EQ(nearest_word("rply", known), "replay");
    EXPECT_EQ(nearest_word("rpl", known), "rig");
    EXPECT_EQ(nearest_word("evaluate", known), std::nullopt);
    EXPECT_EQ(nearest_word(std::string(10'000, 'r'), known), std::nullopt);
    EXPECT_EQ(nearest_word("rig", {}), std::nullopt);
}

}  // namespace
}  // namespace octoskin::rig
