// A rig below a folder that was named, a recording, refers to files of that folder alone; one that the user
// names to any.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <string>
#include <utility>

#include "hw/rigfile/rig.hpp"
#include "hw/rigfile/urdf_document.hpp"
#include "tests/support/errors/error_fields.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::rig {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing_support::code_is;
using testing_support::error_in;
using testing_support::file_is;
using testing_support::has_its_fields;
using testing_support::is_no_error;
using testing_support::key_is;
using testing_support::line_is;
using testing_support::value_is;
using testing_support::what_is;

/// A recording's folder with a rig and a robot, and beside it a folder that it must not reach.
class RecordedRig : public testing::Test {
  protected:
    RecordedRig() {
        const auto shipped = read_rig(fs::path(OCTOSKIN_SOURCE_DIR) / "hw/rigs/bench_one_board.yaml");
        EXPECT_TRUE(shipped);
        hash_ = rig_hash(*shipped);
        fs::create_directories(scratch_ / "rec");
        fs::create_directories(scratch_ / "outside");
        for (const char* folder : {"rec", "outside"}) {
            fs::copy_file(fs::path(OCTOSKIN_SOURCE_DIR) / "hw/robots/panda.urdf",
                          scratch_ / folder / "robot.urdf");
            scratch_.write(std::string(folder) + "/base.yaml", canonical_text(*shipped, "robot.urdf"));
        }
        fs::create_symlink("../outside/robot.urdf", scratch_ / "rec/link.urdf");
        fs::create_symlink("../outside/base.yaml", scratch_ / "rec/link.yaml");
        fs::create_directory_symlink("../outside", scratch_ / "rec/up");
        EXPECT_EQ(::mkfifo((scratch_ / "rec/pipe").c_str(), 0600), 0);
    }
    FilePlace recorded(const std::string& text) const {
        scratch_.write("rec/rig.yaml", text);
        return {OpenFolder::open(scratch_ / "rec", FolderAccess::read).value(), "rig.yaml"};
    }
    static Error error_of(const FilePlace& file) { return error_in(read_rig(file)); }

    const testing_support::ScratchFolder scratch_;
    std::uint32_t hash_ = 0;
};

TEST_F(RecordedRig, refers_to_files_of_its_recording) {
    const auto rig = read_rig(recorded("extends: base.yaml\nrobot: {urdf: ./robot.urdf}\n"));
    ASSERT_TRUE(rig) << rig.error().message();
    EXPECT_EQ(rig_hash(*rig), hash_);
}

TEST_F(RecordedRig, refers_to_nothing_outside_of_it) {
    const std::string outside = (scratch_ / "outside").string();
    const std::pair<std::string, ErrorCode> places[] = {{outside + "/", ErrorCode::outside_folder},
                                                        {"../outside/", ErrorCode::outside_folder},
                                                        {"x/../../outside/", ErrorCode::outside_folder},
                                                        {"up/", ErrorCode::link}};
    for (const auto& [place, code] : places) {
        const Error base = error_of(recorded("name: a\nextends: " + place + "base.yaml\n"));
        EXPECT_THAT(base, AllOf(code_is(code), line_is(2), key_is("extends"),
                                value_is(HasSubstr("'" + place + "base.yaml'"))));
        EXPECT_EQ(base.file, scratch_ / "rec/rig.yaml");
        EXPECT_TRUE(has_its_fields(base));
        EXPECT_THAT(error_of(recorded("extends: base.yaml\nrobot: {urdf: " + place + "robot.urdf}\n")),
                    AllOf(code_is(code), file_is("rig.yaml"), line_is(2), key_is("robot.urdf")));
        EXPECT_THAT(
            error_of(recorded("extends: base.yaml\nnodes: [{name: a, board: " + place + "base.yaml}]\n")),
            AllOf(code_is(code), file_is("rig.yaml"), line_is(2), key_is("nodes[0].board")));
    }
    EXPECT_THAT(error_of(recorded("extends: link.yaml\n")), code_is(ErrorCode::link));
    EXPECT_THAT(error_of(recorded("extends: base.yaml\nrobot: {urdf: link.urdf}\n")),
                code_is(ErrorCode::link));
    EXPECT_THAT(error_of(recorded("extends: pipe\n")),
                AllOf(code_is(ErrorCode::wrong_kind_of_file), value_is(HasSubstr("a named pipe"))));
    EXPECT_THAT(error_of(recorded("extends: none.yaml\n")),
                AllOf(code_is(ErrorCode::not_found), value_is(HasSubstr("none.yaml"))));
}

TEST_F(RecordedRig, is_free_to_where_the_user_names_it) {
    scratch_.write("rec/rig.yaml", "extends: ../outside/base.yaml\nrobot: {urdf: " +
                                       (scratch_ / "rec/link.urdf").string() + "}\n");
    EXPECT_THAT(error_of(scratch_ / "rec/rig.yaml"), is_no_error());
}

TEST_F(RecordedRig, is_no_freer_where_it_is_named_by_itself) {
    for (const char* mark : {"can.log", "meta.yaml"}) {
        scratch_.write(std::string("rec/") + mark, "");
        scratch_.write("rec/rig.yaml", "extends: ../outside/base.yaml\n");
        EXPECT_THAT(
            error_of(scratch_ / "rec/rig.yaml"),
            AllOf(code_is(ErrorCode::outside_folder), file_is("rig.yaml"), line_is(1), key_is("extends")));
        scratch_.write("rec/rig.yaml", "extends: base.yaml\nrobot: {urdf: link.urdf}\n");
        EXPECT_THAT(error_of(scratch_ / "rec/rig.yaml"), code_is(ErrorCode::link));
        scratch_.write("rec/rig.yaml", "extends: base.yaml\n");
        EXPECT_THAT(error_of(scratch_ / "rec/rig.yaml"), is_no_error());
        EXPECT_THAT(error_of(scratch_ / "rec/link.yaml"), code_is(ErrorCode::link));
        const auto robot = read_rig(scratch_ / "rec/rig.yaml", scratch_ / "rec/link.urdf");
        ASSERT_FALSE(robot);
        EXPECT_THAT(robot.error(), code_is(ErrorCode::link));
        fs::remove(scratch_ / "rec" / mark);
    }
}

/// A rig of somebody else may name any file: its text is not the rig's to show.
TEST_F(RecordedRig, shows_nothing_of_a_file_that_it_names_and_that_is_none) {
    const auto shown = [this](const std::string& text) {
        scratch_.write("outside/secret", text);
        scratch_.write("rig.yaml", "name: a\nextends: outside/secret\n");
        return error_of(scratch_ / "rig.yaml");
    };
    for (const std::string text :
         {"hidden:*:20228:0:99999:7:::\ndaemon:*:20228:0:99999:7:::", "hidden phrase", "a: !hidden b",
          "hidden: 1\nhidden: 2", "hidden: &hidden 1", "- hidden", "<hidden>", "hidden: [1, 2", "%hidden",
          "\thidden: a", "hidden: {a: 1}", "hidden: *hidden"}) {
        const std::string message = shown(text).message();
        EXPECT_THAT(message, HasSubstr("outside/secret")) << text;
        EXPECT_THAT(message, testing::Not(HasSubstr("hidden"))) << text;
    }
    scratch_.write("rig.yaml", "extends: outside/base.yaml\nrobot: {urdf: outside/secret}\n");
    for (const char* text : {"hidden phrase", "<hidden><hidden2></hidden>", "<a hidden=1>", "<hidden/>"}) {
        scratch_.write("outside/secret", text);
        const Error error = error_of(scratch_ / "rig.yaml");
        EXPECT_THAT(error, AllOf(code_is(ErrorCode::foreign_format), what_is(HasSubstr("a URDF"))));
        EXPECT_EQ(error.file, scratch_ / "outside/secret");
        EXPECT_THAT(error.message(), testing::Not(HasSubstr("hidden")));
    }
}

TEST_F(RecordedRig, s_robot_is_no_link_and_no_pipe) {
    const auto folder = OpenFolder::open(scratch_ / "rec", FolderAccess::read).value();
    EXPECT_THAT(UrdfDocument::read({folder, "link.urdf"}).error(), code_is(ErrorCode::link));
    EXPECT_THAT(UrdfDocument::read({folder, "pipe"}).error(),
                AllOf(code_is(ErrorCode::wrong_kind_of_file), what_is(HasSubstr("a named pipe"))));
    EXPECT_TRUE(UrdfDocument::read({folder, "robot.urdf"}));
}

}  // namespace
}  // namespace octoskin::rig
