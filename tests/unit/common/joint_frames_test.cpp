// One joint sample as frames. The bytes themselves: codec_golden_test.cpp.
#include "common/wire/joint_frames.hpp"

#include <gtest/gtest.h>

#include "common/wire/codec.hpp"

namespace octoskin::wire {
namespace {

TEST(JointFrames, carry_each_joint_once_and_the_time_last) {
    const TimeResidue sampled{.value_us = 0xABCDEF, .span_us = kFdTimeSpanUs};
    const auto frames = joint_frames(0x3E, 5, {-8'388'608, 8'388'607, -1, 0, 1, 123'456, -654'321}, sampled);
    const std::array<JointState, 4> expected = {JointPair{0, 5, {-8'388'608, 8'388'607}},
                                                JointPair{1, 5, {-1, 0}}, JointPair{2, 5, {1, 123'456}},
                                                JointLast{5, -654'321, sampled}};
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const auto decoded = decode(frames.at(i));
        ASSERT_TRUE(decoded.has_value()) << i;
        EXPECT_EQ(decoded->node_id, 0x3E) << i;
        EXPECT_EQ(std::get<JointState>(decoded->message), expected.at(i)) << i;
    }
}

}  // namespace
}  // namespace octoskin::wire
