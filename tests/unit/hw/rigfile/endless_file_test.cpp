// What is no file, or has no end, is refused before it is opened.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <sstream>
#include <utility>

#include "hw/rigfile/bounded_text.hpp"
#include "hw/rigfile/file_kind.hpp"
#include "hw/rigfile/robot_description.hpp"
#include "tests/support/errors/error_fields.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::rig {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing_support::code_is;
using testing_support::remedy_is;
using testing_support::what_is;

TEST(EndlessFile, is_refused_as_a_rig_and_as_a_robot) {
    const testing_support::ScratchFolder folder;
    const auto pipe = folder / "pipe";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    const std::pair<std::filesystem::path, const char*> others[] = {
        {"/dev/zero", "a device"}, {pipe, "a named pipe"}, {folder.path(), "a directory"}};
    for (const auto& [path, kind] : others) {
        const auto rig = read_rig(path);
        ASSERT_FALSE(rig);
        EXPECT_EQ(rig.error().file, path);
        EXPECT_THAT(rig.error(), AllOf(code_is(ErrorCode::wrong_kind_of_file), what_is(HasSubstr(kind)),
                                       remedy_is(HasSubstr("an ordinary YAML file"))));
        const auto robot = read_capsules(path, {});
        ASSERT_FALSE(robot);
        EXPECT_EQ(robot.error().file, path);
        EXPECT_THAT(robot.error(), AllOf(code_is(ErrorCode::wrong_kind_of_file), what_is(HasSubstr(kind)),
                                         remedy_is(HasSubstr("an ordinary URDF file"))));
    }
    EXPECT_EQ(other_than_a_file(folder.write("file", "")), "");
    EXPECT_EQ(other_than_a_file(folder / "absent"), "");
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
