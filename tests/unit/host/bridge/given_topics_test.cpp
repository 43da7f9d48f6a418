// Topics of a bag that a person names.
#include "host/bridge/mcap/given_topics.hpp"

#include <gmock/gmock.h>

namespace octoskin::bridge {
namespace {

using testing::HasSubstr;

TEST(GivenTopics, are_those_of_the_bag) {
    const std::set<std::string> topics = {"/arm/joint_states", "/can0", "/tf"};
    EXPECT_TRUE(check_given_topics({}, topics, "--can"));
    EXPECT_TRUE(check_given_topics({"/can0", "/tf"}, topics, "--can"));
    const auto near = check_given_topics({"/can0", "/arm/joint_state"}, topics, "--joint-states");
    ASSERT_FALSE(near);
    EXPECT_EQ(near.error().code, ErrorCode::unknown_name);
    EXPECT_EQ(near.error().key, "--joint-states");
    EXPECT_THAT(near.error().remedy, HasSubstr("/arm/joint_states?"));
    const auto far = check_given_topics({"/something_else"}, topics, "--can");
    ASSERT_FALSE(far);
    EXPECT_THAT(far.error().remedy, HasSubstr("it has /arm/joint_states, /can0, /tf"));
    EXPECT_FALSE(check_given_topics({"/can0"}, {}, "--can"));
}

}  // namespace
}  // namespace octoskin::bridge
