// A file without end, as a device has it, is refused after as many bytes as a real one may have.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "hw/rigfile/bounded_text.hpp"
#include "hw/rigfile/robot_description.hpp"

namespace octoskin::rig {
namespace {

using testing::HasSubstr;

TEST(EndlessFile, is_refused_as_a_rig_and_as_a_robot) {
    const auto rig = read_rig("/dev/zero");
    ASSERT_FALSE(rig);
    EXPECT_THAT(rig.error().message(), HasSubstr("at most 1048576 bytes"));
    const auto robot = read_capsules("/dev/zero", {});
    ASSERT_FALSE(robot);
    EXPECT_THAT(robot.error().message(), HasSubstr("at most 16777216 bytes"));
}

TEST(BoundedText, is_the_whole_text_up_to_the_limit_and_one_byte_more_beyond_it) {
    for (const std::size_t length : {0U, 1U, 16'383U, 16'384U, 16'385U, 40'000U}) {
        for (const std::size_t limit : {0U, 1U, 16'383U, 16'384U, 16'385U, 40'000U, 50'000U}) {
            std::string whole(length, 'x');
            for (std::size_t i = 0; i < length; ++i) whole[i] = static_cast<char>('a' + i % 23);
            std::istringstream stream(whole);
            EXPECT_EQ(read_bounded(stream, limit), whole.substr(0, limit + 1)) << length << ' ' << limit;
        }
    }
}

}  // namespace
}  // namespace octoskin::rig
