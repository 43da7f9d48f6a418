#include "host/core/ingest/joint_assembler.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace octoskin {
namespace {

constexpr double kRate = 100.0;
HostTime ms(std::int64_t value) {
    return {value * 1'000'000};
}

/// Sample `n`: joint j at n + j / 10 rad.
std::int32_t urad(int n, int joint) {
    return n * 1'000'000 + joint * 100'000;
}
wire::JointState part(int n, int index) {
    const auto sequence = static_cast<std::uint8_t>(n % 8);
    if (index == 3) {
        return wire::JointLast{
            sequence, urad(n, 6), {static_cast<std::uint32_t>(n) * 10'000U, wire::kFdTimeSpanUs}};
    }
    return wire::JointPair{
        static_cast<std::uint8_t>(index), sequence, {urad(n, 2 * index), urad(n, 2 * index + 1)}};
}

TEST(JointAssembler, joins_four_frames_in_any_order) {
    std::array<int, 4> order{0, 1, 2, 3};
    do {
        JointAssembler assembler(kRate);
        for (int i = 0; i < 4; ++i) {
            const auto outcome = assembler.on_frame(part(2, order[static_cast<std::size_t>(i)]), ms(100 + i));
            EXPECT_EQ(outcome.opened, i == 0);
            EXPECT_TRUE(outcome.given_up.empty());
            ASSERT_EQ(outcome.complete.has_value(), i == 3);
            if (outcome.complete) {
                for (int joint = 0; joint < 7; ++joint) {
                    EXPECT_NEAR(outcome.complete->position_rad[static_cast<std::size_t>(joint)],
                                2.0 + 0.1 * joint, 1e-12);
                }
                EXPECT_EQ(outcome.complete->sampled.value_us, 20'000U);
                EXPECT_EQ(outcome.complete->begun, ms(100));
            }
        }
        EXPECT_EQ(assembler.pending(), 0U);
    } while (std::ranges::next_permutation(order).found);
}

TEST(JointAssembler, completes_nothing_and_gives_up_once_for_every_way_to_lose_frames) {
    for (unsigned kept = 1; kept < 15; ++kept) {
        JointAssembler assembler(kRate);
        for (int index = 0; index < 4; ++index) {
            if ((kept & (1U << static_cast<unsigned>(index))) != 0) {
                EXPECT_FALSE(assembler.on_frame(part(0, index), ms(index)).complete.has_value());
            }
        }
        EXPECT_EQ(assembler.pending(), 1U);
        // The next samples are whole; the broken one ends half a round later.
        std::vector<JointReason> given_up;
        int completed = 0;
        for (int n = 1; n < 8; ++n) {
            for (int index = 0; index < 4; ++index) {
                const auto outcome = assembler.on_frame(part(n, index), ms(10 * n + index));
                given_up.insert(given_up.end(), outcome.given_up.begin(), outcome.given_up.end());
                completed += outcome.complete ? 1 : 0;
            }
        }
        EXPECT_EQ(given_up, std::vector{JointReason::incomplete});
        EXPECT_EQ(completed, 7);
        EXPECT_EQ(assembler.pending(), 0U);
    }
}

TEST(JointAssembler, never_mixes_frames_of_two_rounds) {
    // All between are lost: the second half of sample 8 has the sequence of the first half of sample 0.
    for (const int later : {8, 16, 80}) {
        JointAssembler assembler(kRate);
        EXPECT_TRUE(assembler.on_frame(part(0, 0), ms(0)).opened);
        EXPECT_FALSE(assembler.on_frame(part(0, 1), ms(0)).opened);
        const auto third = assembler.on_frame(part(later, 2), ms(10 * later));
        EXPECT_EQ(third.given_up, std::vector{JointReason::incomplete});
        EXPECT_TRUE(third.opened);
        EXPECT_FALSE(assembler.on_frame(part(later, 3), ms(10 * later)).complete.has_value());
    }
}

TEST(JointAssembler, takes_two_interleaved_samples_apart) {
    JointAssembler assembler(kRate);
    int completed = 0;
    for (int index = 0; index < 4; ++index) {
        for (const int n : {5, 6}) {
            const auto outcome = assembler.on_frame(part(n, index), ms(50 + index));
            EXPECT_TRUE(outcome.given_up.empty());
            if (outcome.complete) {
                ++completed;
                EXPECT_NEAR(outcome.complete->position_rad[0], n, 1e-12);
                EXPECT_NEAR(outcome.complete->position_rad[6], n + 0.6, 1e-12);
            }
        }
    }
    EXPECT_EQ(completed, 2);
}

TEST(JointAssembler, ignores_a_repeated_frame_before_and_after_completion) {
    JointAssembler assembler(kRate);
    EXPECT_FALSE(assembler.on_frame(part(0, 0), ms(0)).is_repeated);
    EXPECT_TRUE(assembler.on_frame(part(0, 0), ms(0)).is_repeated);
    for (int index = 1; index < 4; ++index) {
        EXPECT_FALSE(assembler.on_frame(part(0, index), ms(1)).is_repeated);
    }
    for (int index = 0; index < 4; ++index) {
        const auto outcome = assembler.on_frame(part(0, index), ms(2));
        EXPECT_TRUE(outcome.is_repeated && !outcome.opened && !outcome.complete);
    }
    EXPECT_EQ(assembler.pending(), 0U);
}

TEST(JointAssembler, gives_up_a_sample_that_contradicts_itself) {
    JointAssembler assembler(kRate);
    EXPECT_TRUE(assembler.on_frame(part(0, 0), ms(0)).opened);
    wire::JointPair other = std::get<wire::JointPair>(part(0, 0));
    other.position_urad[0] += 1;
    const auto outcome = assembler.on_frame(other, ms(1));
    EXPECT_EQ(outcome.given_up, std::vector{JointReason::contradictory});
    EXPECT_TRUE(outcome.opened);
}

TEST(JointAssembler, begins_anew_when_time_goes_back) {
    JointAssembler assembler(kRate);
    EXPECT_TRUE(assembler.on_frame(part(0, 0), ms(1000)).opened);
    const auto outcome = assembler.on_frame(part(0, 1), ms(10));
    EXPECT_EQ(outcome.given_up, std::vector{JointReason::incomplete});
    EXPECT_TRUE(outcome.opened);
}

TEST(JointAssembler, begins_a_sequence_number_anew_in_the_next_round) {
    JointAssembler assembler(kRate);
    for (int n = 0; n < 40; ++n) {
        for (int index = 0; index < 4; ++index) {
            const auto outcome = assembler.on_frame(part(n, index), ms(10 * n + index));
            EXPECT_EQ(outcome.opened, index == 0);
            EXPECT_EQ(outcome.complete.has_value(), index == 3);
            EXPECT_TRUE(outcome.given_up.empty());
        }
    }
}

}  // namespace
}  // namespace octoskin
