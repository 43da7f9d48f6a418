// Lines 12 to 15 of EXTI, as RM0440 has them. Whether an edge on a masked line becomes pending it does not
// say clearly: the port must do either way.
#include "firmware/port/stm32g4/data_ready_lines.hpp"

#include <gtest/gtest.h>

#include "tests/support/stm32g4/address_space.hpp"

namespace octoskin::stm32g4 {
namespace {

constexpr Address kExtiCr4 = 0x4001'0014;
constexpr Address kImr1 = 0x4001'0400;
constexpr Address kFtsr1 = 0x4001'040C;
constexpr Address kPr1 = 0x4001'0414;
constexpr Address kApb2Enr = 0x4002'1060;
constexpr std::uint32_t kImr1AfterReset = 0xFF82'0000;

class DataReadyLinesTest : public testing::TestWithParam<bool> {
  protected:
    DataReadyLinesTest() {
        space_[kImr1] = kImr1AfterReset;
        space_.on_write(kPr1, [](std::uint32_t& word, std::uint32_t value) { word &= ~value; });
    }
    [[nodiscard]] bool is_masked(unsigned line) { return (space_[kImr1] >> line & 1U) == 0; }
    /// An edge, and the interrupt if there is one.
    void fall(unsigned line) {
        if ((space_[kFtsr1] >> line & 1U) == 0) return;
        if (!is_masked(line) || GetParam()) space_[kPr1] |= 1U << line;
        if ((space_[kPr1] & space_[kImr1]) == 0) return;
        ++interrupts_;
        lines_.on_interrupt();
        ASSERT_EQ(space_[kPr1] & space_[kImr1], 0U) << "it would come again at once";
    }

    test::AddressSpace space_;
    DataReadyLines lines_;
    int interrupts_ = 0;
};

TEST_P(DataReadyLinesTest, listens_to_falls_of_the_pins_in_use_and_to_nothing_else) {
    lines_.start(0b1010);
    EXPECT_EQ(space_[kApb2Enr], 1U) << "SYSCFG's clock";
    EXPECT_EQ(space_[kExtiCr4], 0x1010U) << "port B";
    EXPECT_EQ(space_[kFtsr1], 0b1010U << 12U);
    EXPECT_EQ(space_[kImr1], kImr1AfterReset | 0b1010U << 12U);
    EXPECT_EQ(space_[0xE000'E104], 1U << (40 - 32));
}

TEST_P(DataReadyLinesTest, touches_nothing_without_a_line) {
    lines_.start(0);
    EXPECT_TRUE(space_.writes().empty());
}

TEST_P(DataReadyLinesTest, tells_a_fall_once_and_of_its_own_bus) {
    lines_.start(0b1111);
    EXPECT_FALSE(lines_.take_fall(2));
    fall(14);
    EXPECT_TRUE(lines_.has_event());
    EXPECT_FALSE(lines_.take_fall(0));
    EXPECT_TRUE(lines_.take_fall(2));
    EXPECT_FALSE(lines_.take_fall(2));
    fall(14);
    EXPECT_TRUE(lines_.take_fall(2)) << "listened to again";
}

TEST_P(DataReadyLinesTest, keeps_the_other_lines_falls_and_masks) {
    lines_.start(0b0111);
    fall(12);
    fall(13);
    EXPECT_TRUE(lines_.take_fall(0));
    EXPECT_TRUE(is_masked(13));
    EXPECT_FALSE(is_masked(14));
    EXPECT_TRUE(is_masked(15));
    EXPECT_TRUE(lines_.take_fall(1));
    EXPECT_EQ(space_[kImr1], kImr1AfterReset | 0b0111U << 12U);
}

TEST_P(DataReadyLinesTest, takes_no_more_interrupts_of_a_line_that_chatters_than_questions_are_asked) {
    lines_.start(0b0001);
    for (int question = 0; question < 10; ++question) {
        for (int edge = 0; edge < 1'000; ++edge) fall(12);
        EXPECT_EQ(interrupts_, question + 1);
        EXPECT_TRUE(lines_.take_fall(0));
        EXPECT_EQ(space_[kPr1], 0U) << "what came while masked is not told as new";
    }
}

TEST_P(DataReadyLinesTest, wakes_the_loop_once_for_a_fall_that_nobody_asks_about) {
    lines_.start(0b0001);
    fall(12);
    EXPECT_TRUE(lines_.has_event());
    lines_.acknowledge_event();
    fall(12);
    EXPECT_FALSE(lines_.has_event());
}

INSTANTIATE_TEST_SUITE_P(MaskedEdges, DataReadyLinesTest, testing::Bool(),
                         [](const auto& tested) { return tested.param ? "become_pending" : "are_lost"; });

}  // namespace
}  // namespace octoskin::stm32g4
