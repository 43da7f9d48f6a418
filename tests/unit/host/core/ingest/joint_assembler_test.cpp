#include "host/core/ingest/joint_assembler.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <random>

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

// Of an arm of which one joint moves, all at once: a frame of one sample is lost, and all of the seven after
// it.
TEST(JointAssembler, never_mixes_two_rounds_of_a_burst) {
    for (const int lost : {1, 2, 3}) {
        JointAssembler assembler(kRate);
        const auto moving = [lost](int n, int index) {
            wire::JointState frame = part(index == lost ? n : 0, index);
            std::visit([n](auto& of_sample) { of_sample.sequence = static_cast<std::uint8_t>(n % 8); },
                       frame);
            return frame;
        };
        for (int index = 0; index < 4; ++index) {
            if (index != lost) (void)assembler.on_frame(moving(7, index), ms(10));
        }
        std::vector<JointReason> given_up;
        for (int index = 0; index < 4; ++index) {
            const auto outcome = assembler.on_frame(moving(15, index), ms(10));
            std::ranges::copy(outcome.given_up, std::back_inserter(given_up));
            EXPECT_EQ(outcome.complete.has_value(), index == 3) << lost << ' ' << index;
        }
        EXPECT_EQ(given_up, std::vector{JointReason::incomplete}) << lost;
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

// A bus or a program that was held up: several rounds within the time of half a one.
TEST(JointAssembler, takes_a_burst_of_an_arm_at_rest_for_the_samples_that_they_are) {
    JointAssembler assembler(kRate);
    const auto at_rest = [](int n, int index) {
        wire::JointState frame = part(0, index);
        std::visit([n](auto& of_sample) { of_sample.sequence = static_cast<std::uint8_t>(n % 8); }, frame);
        if (index == 3)
            std::get<wire::JointLast>(frame).sampled.value_us = static_cast<std::uint32_t>(n) * 10'000U;
        return frame;
    };
    for (int n = 0; n < 40; ++n) {
        for (int index = 0; index < 4; ++index) {
            const auto outcome = assembler.on_frame(at_rest(n, index), ms(1'000 + n));
            EXPECT_FALSE(outcome.is_repeated) << n << ' ' << index;
            EXPECT_TRUE(outcome.given_up.empty()) << n << ' ' << index;
            ASSERT_EQ(outcome.complete.has_value(), index == 3) << n << ' ' << index;
            if (index == 3) {
                EXPECT_EQ(outcome.complete->sampled.value_us, static_cast<std::uint32_t>(n) * 10'000U);
            }
            EXPECT_TRUE(assembler.on_frame(at_rest(n, index), ms(1'000 + n)).is_repeated)
                << n << ' ' << index;
        }
    }
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

// What comes after it may be of both.
TEST(JointAssembler, completes_no_sample_that_has_contradicted_itself) {
    JointAssembler assembler(kRate);
    wire::JointPair other = std::get<wire::JointPair>(part(1, 0));
    other.position_urad[0] += 1;
    (void)assembler.on_frame(part(1, 0), ms(10));
    EXPECT_TRUE(assembler.on_frame(other, ms(10)).is_contradiction);
    for (int index = 1; index < 4; ++index) {
        const auto outcome = assembler.on_frame(part(1, index), ms(10));
        EXPECT_FALSE(outcome.complete);
        EXPECT_EQ(outcome.given_up.size(), index == 3 ? 1U : 0U);
    }
    EXPECT_EQ(assembler.pending(), 0U);
    bool is_complete = false;
    for (int index = 0; index < 4; ++index)
        is_complete = assembler.on_frame(part(2, index), ms(20)).complete.has_value();
    EXPECT_TRUE(is_complete);
}

TEST(JointAssembler, knows_two_times_of_one_round_from_those_of_two) {
    for (const auto& [apart_us, is_of_one_round] :
         {std::pair{0U, true}, std::pair{39'999U, true}, std::pair{40'000U, false}, std::pair{80'000U, false},
          std::pair{wire::kFdTimeSpanUs - 7'000U, true}}) {
        JointAssembler assembler(kRate);
        const std::uint32_t first_us = 3'000;
        (void)assembler.on_frame(wire::JointLast{1, 0, {first_us, wire::kFdTimeSpanUs}}, ms(10));
        const auto outcome = assembler.on_frame(
            wire::JointLast{1, 1, {(first_us + apart_us) % wire::kFdTimeSpanUs, wire::kFdTimeSpanUs}},
            ms(10));
        EXPECT_TRUE(outcome.is_contradiction);
        EXPECT_EQ(outcome.is_of_one_round, is_of_one_round) << apart_us;
    }
}

/// Sample 1, and in the next round sample 9, into whose frame `index` comes what no sender of both would say.
JointAssembler::Outcome contradicted(JointAssembler& assembler, int lost, int index, std::int64_t after_ms) {
    for (int i = 0; i < 4; ++i)
        if (i != lost) (void)assembler.on_frame(part(1, i), ms(10));
    for (int i = 0; i <= index; ++i) (void)assembler.on_frame(part(9, i), ms(90));
    return assembler.on_frame(part(17, index), ms(90 + after_ms));
}

TEST(JointAssembler, knows_a_frame_of_no_round_where_the_round_before_was_whole) {
    for (int index = 0; index < 4; ++index) {
        JointAssembler whole(kRate);
        const auto outcome = contradicted(whole, -1, index, 1);
        EXPECT_TRUE(outcome.is_contradiction && outcome.is_of_no_round) << index;
        for (int lost = 0; lost < 4; ++lost) {
            JointAssembler one_late(kRate);
            EXPECT_FALSE(contradicted(one_late, lost, index, 1).is_of_no_round) << index << ", lost " << lost;
        }
        JointAssembler late(kRate);
        EXPECT_FALSE(contradicted(late, -1, index, 6).is_of_no_round) << "half a period later";
    }
}

TEST(JointAssembler, takes_no_frame_of_a_burst_of_several_rounds_for_one_of_none) {
    JointAssembler assembler(kRate);
    for (int n = 0; n < 8; ++n)
        for (int i = 0; i < 4; ++i) (void)assembler.on_frame(part(n, i), ms(10 * n));
    for (int n = 8; n < 24; ++n)  // held up, and all here at once
        for (int i = 0; i < 4; ++i) {
            EXPECT_FALSE(assembler.on_frame(part(n, i), ms(150)).is_of_no_round) << n;
        }
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

struct Sent {
    int completed = 0;
    int refused = 0;
};

/// A source `times` as quick as the rig says. Each pair of joints moves in some samples only, so that frames
/// of two rounds may be equal; each frame is lost with the probability `loss`. What comes together is checked
/// against what was sent, which its time tells.
Sent send(double times, double loss, std::uint64_t seed) {
    Sent counts;
    std::mt19937_64 random(seed);
    std::bernoulli_distribution is_lost(loss);
    std::bernoulli_distribution moves(0.2);
    JointAssembler assembler(kRate);
    std::array<std::int32_t, 7> position{};
    std::vector<std::array<std::int32_t, 7>> sent;
    for (std::uint32_t n = 0; n < 2000; ++n) {
        for (std::size_t joint = 0; joint < 7; joint += 2) {
            if (moves(random)) position[joint] = static_cast<std::int32_t>(n);
        }
        sent.push_back(position);
        const auto sequence = static_cast<std::uint8_t>(n % 8);
        const auto sampled_us = static_cast<std::uint32_t>(n * 1e6 / (times * kRate));
        const HostTime now{sampled_us * 1000LL};
        for (std::uint8_t index = 0; index < 4; ++index) {
            if (is_lost(random)) continue;
            const std::size_t first = 2UL * index;
            const wire::JointState frame =
                index == 3 ? wire::JointState(
                                 wire::JointLast{sequence, position[6], {sampled_us, wire::kFdTimeSpanUs}})
                           : wire::JointPair{index, sequence, {position[first], position[first + 1]}};
            const auto outcome = assembler.on_frame(frame, now + Nanoseconds{index * 200'000});
            if (!outcome.complete) continue;
            if (!outcome.complete->has_pace) {
                ++counts.refused;
                continue;
            }
            ++counts.completed;
            const auto taken = std::lround(outcome.complete->sampled.value_us * 1e-6 * times * kRate);
            const auto& expected = sent.at(static_cast<std::size_t>(taken));
            for (std::size_t joint = 0; joint < 7; ++joint) {
                EXPECT_NEAR(outcome.complete->position_rad[joint], 1e-6 * expected[joint], 1e-12)
                    << times << " times, loss " << loss << ", seed " << seed << ", sample " << n;
            }
        }
    }
    return counts;
}

TEST(JointAssembler, never_mixes_two_samples_however_quick_the_source_is) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        for (const double times : {1.0, 1.5, 2.0, 3.0, 4.0, 7.9, 8.0, 10.0, 25.0, 40.0}) {
            for (const double loss : {0.0, 0.01, 0.1, 0.3}) {
                const Sent counts = send(times, loss, seed);
                if (times >= 2.0) {
                    EXPECT_EQ(counts.completed, 0) << times << " times, loss " << loss;
                    EXPECT_GT(counts.refused, 0) << times << " times, loss " << loss;
                } else if (loss == 0.0) {
                    EXPECT_EQ(counts.completed, 1995) << times;
                }
            }
        }
    }
}

TEST(JointPace, forgives_jitter_and_a_burst_and_not_twice_the_rate) {
    JointPace pace(kRate);
    std::mt19937 random(4);
    std::uint32_t at_us = 16'000'000;  // its time field wraps on the way
    std::uint8_t sequence = 0;
    const auto sample = [&](std::uint32_t after_us) {
        at_us = (at_us + after_us) % wire::kFdTimeSpanUs;
        sequence = static_cast<std::uint8_t>((sequence + 1U) % 8U);
        pace.observe(sequence, {at_us, wire::kFdTimeSpanUs});
        return !pace.is_kept();
    };
    for (int i = 0; i < 5; ++i) EXPECT_TRUE(sample(10'000)) << "not known yet";
    for (int i = 0; i < 1000; ++i) EXPECT_FALSE(sample(7'000 + static_cast<std::uint32_t>(random() % 6'000)));
    EXPECT_FALSE(sample(100));
    for (int i = 0; i < 10; ++i) EXPECT_FALSE(sample(10'000));
    EXPECT_FALSE(sample(5'000));
    for (int i = 0; i < 100; ++i) EXPECT_TRUE(sample(5'000));
    for (int i = 0; i < 4; ++i) EXPECT_TRUE(sample(10'000)) << i;
    EXPECT_FALSE(sample(10'000));
    for (int i = 0; i < 100; ++i) EXPECT_FALSE(sample(20'000)) << "half the rate is no danger";
}

TEST(JointPace, takes_no_late_sample_for_a_quick_one) {
    JointPace pace(kRate);
    for (std::uint32_t n = 1; n < 4000; ++n) {  // two by two in the wrong order, and some lost
        const std::uint32_t k = n ^ 1U;
        if (n % 7 == 0) continue;
        pace.observe(static_cast<std::uint8_t>(k % 8),
                     {k * 10'000 % wire::kFdTimeSpanUs, wire::kFdTimeSpanUs});
        ASSERT_TRUE(n < 10 || pace.is_kept()) << n;
    }
}

}  // namespace
}  // namespace octoskin
