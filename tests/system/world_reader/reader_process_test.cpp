// A world is read in a process with limits: a limit that is reached is a refusal that names it, and what the
// file refers to stays in its folder where that is asked for. The hostile files are made here.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <utility>

#include "hw/sim/world/sdf_solids.hpp"
#include "hw/sim/world/solids_bytes.hpp"
#include "tests/support/errors/error_fields.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::sim {
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
using testing_support::remedy_is;
using testing_support::value_is;
using testing_support::what_is;

const fs::path kShipped = fs::path(OCTOSKIN_SOURCE_DIR) / "hw/worlds";

class ReaderProcessTest : public testing::Test {
  protected:
    /// A program in the reader's place.
    fs::path program(const std::string& commands) const {
        const auto file = scratch_.write("reader", "#!/bin/sh\n" + commands + "\n");
        fs::permissions(file, fs::perms::owner_all);
        return file;
    }
    Error error_of(const std::string& commands, const ReadLimits& limits = {}) const {
        return error_in(read_in_process("x.sdf", limits, program(commands)));
    }
    static Error error_of_world(const FilePlace& sdf, const ReadLimits& limits = {}) {
        const Error error = error_in(read_solids(sdf, limits));
        EXPECT_TRUE(has_its_fields(error));
        return error;
    }
    /// Of the folder "in".
    FilePlace in_folder(const std::string& name) const {
        return {OpenFolder::open(in(), FolderAccess::read).value(), name};
    }
    /// So many boxes, each a model of its own.
    fs::path many_models(int count) const {
        std::string text = "<sdf version='1.9'><world name='w'>\n";
        for (int i = 0; i < count; ++i) {
            const std::string name = std::to_string(i);
            text += "<model name='m" + name +
                    "'><link name='l'><visual name='v'><geometry><box><size>1 1 "
                    "1</size></box></geometry></visual>"
                    "</link></model>\n";
        }
        return scratch_.write("many.sdf", text + "</world></sdf>\n");
    }
    /// Makes a world in the folder "in" with one visual, of this mesh.
    void make_world_with(const std::string& mesh) const {
        fs::create_directories(scratch_ / "in");
        scratch_.write("in/w.sdf",
                       "<sdf version='1.9'><model name='m'><link name='l'><visual name='v'>"
                       "<geometry><mesh><uri>" +
                           mesh + "</uri></mesh></geometry></visual></link></model></sdf>\n");
    }
    fs::path in() const { return scratch_ / "in"; }

    static constexpr const char* kTetrahedron =
        "mtllib it.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl red\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
    const testing_support::ScratchFolder scratch_;
};

TEST_F(ReaderProcessTest, that_reaches_a_limit_is_refused_by_its_name) {
    EXPECT_THAT(error_of("kill -XCPU $$", {.processor_s = 7}),
                AllOf(code_is(ErrorCode::too_large), what_is(HasSubstr("7 s of processor time")),
                      remedy_is(HasSubstr("fewer models"))));
    EXPECT_THAT(error_of("exit 70", {.memory_mib = 77}),
                AllOf(code_is(ErrorCode::too_large), what_is(HasSubstr("77 MiB of memory"))));
    EXPECT_THAT(error_of("exec yes", {.result_mib = 3}),
                AllOf(code_is(ErrorCode::too_large), what_is(HasSubstr("3 MiB for its triangles"))));
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_THAT(error_of("exec sleep 30", {.patience = std::chrono::seconds(1)}),
                AllOf(code_is(ErrorCode::too_large), what_is(HasSubstr("more than 1 s to be read"))));
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
}

TEST_F(ReaderProcessTest, tells_no_more_of_a_file_than_a_message_may_have) {
    const std::string one_line(3'000'000, ' ');
    const std::string name(3'000'000, 'n');
    for (const std::string& what :
         {"<light name='l' type='none'/>" + one_line + "<foo/>", "<model name='" + name + "'/>",
          "<model name='m'><poze>" + name + "</poze></model>"}) {
        const auto file = scratch_.write(
            "long.sdf", "<?xml version='1.0'?><sdf version='1.9'><world name='w'>" + what + "</world></sdf>");
        const std::string error = error_of_world(file).message();
        EXPECT_GT(error.size(), 20U);
        EXPECT_LT(error.size(), 2500U) << error.substr(0, 300);
    }
}

TEST_F(ReaderProcessTest, that_ends_otherwise_is_told_how) {
    EXPECT_THAT(error_of("kill -SEGV $$"),
                AllOf(code_is(ErrorCode::damaged), what_is(HasSubstr("signal 11"))));
    EXPECT_THAT(error_of("exit 3"), AllOf(code_is(ErrorCode::damaged), what_is(HasSubstr("exit code 3"))));
    EXPECT_THAT(read_in_process("x.sdf", {}, scratch_ / "none").error(),
                AllOf(code_is(ErrorCode::no_program), what_is(HasSubstr("cannot be started"))));
}

TEST_F(ReaderProcessTest, leaves_no_process_behind) {
    (void)error_of("exec yes", {.result_mib = 1});
    (void)error_of("exec sleep 30", {.patience = std::chrono::seconds(1)});
    EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "a child is still there";
}

TEST_F(ReaderProcessTest, refuses_a_world_of_twenty_thousand_models) {
    const auto sdf = many_models(20'000);
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_THAT(error_of_world(sdf, {.processor_s = 1}),
                AllOf(code_is(ErrorCode::too_large), file_is("many.sdf"),
                      what_is(HasSubstr("1 s of processor time")), remedy_is(HasSubstr("fewer models"))));
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(60));
    EXPECT_THAT(error_of_world(many_models(20)), is_no_error());
}

#ifndef OCTOSKIN_SANITIZED  // which reserves terabytes of addresses
TEST_F(ReaderProcessTest, refuses_a_world_that_needs_too_much_memory) {
    EXPECT_THAT(
        error_of_world(many_models(2'000), {.memory_mib = 160}),
        AllOf(code_is(ErrorCode::too_large), file_is("many.sdf"), what_is(HasSubstr("160 MiB of memory"))));
}
#endif

TEST_F(ReaderProcessTest, writes_nothing_not_even_a_librarys_log) {
    const char* const before = std::getenv("HOME");
    const std::string home = before == nullptr ? "" : before;
    ::setenv("HOME", scratch_.path().c_str(), 1);
    EXPECT_THAT(error_of_world(kShipped / "experiment.sdf"), is_no_error());
    before == nullptr ? ::unsetenv("HOME") : ::setenv("HOME", home.c_str(), 1);
    EXPECT_EQ(scratch_.entries(), 0);
}

TEST_F(ReaderProcessTest, reads_in_its_folder_what_it_reads_anywhere) {
    fs::copy(kShipped, scratch_ / "in", fs::copy_options::recursive);
    const auto anywhere = read_solids(in() / "experiment.sdf");  // with a mesh
    const auto beneath = read_solids(in_folder("experiment.sdf"));
    ASSERT_TRUE(anywhere && beneath) << (beneath ? "" : beneath.error().message());
    EXPECT_EQ(to_bytes(*anywhere), to_bytes(*beneath));
    fs::create_directory(in() / "deeper");
    fs::rename(in() / "experiment.sdf", in() / "deeper/experiment.sdf");
    EXPECT_THAT(error_of_world(in_folder("deeper/experiment.sdf")),
                what_is(HasSubstr("deeper/meshes/cone.obj")));
    fs::rename(in() / "meshes", in() / "deeper/meshes");
    EXPECT_THAT(error_of_world(in_folder("deeper/experiment.sdf")), is_no_error());
}

TEST_F(ReaderProcessTest, reads_no_mesh_outside_of_its_folder) {
    const auto outside = scratch_.write("cone.obj", kTetrahedron);
    make_world_with("../cone.obj");
    EXPECT_THAT(error_of_world(in() / "w.sdf"), is_no_error()) << "the user named it";
    EXPECT_THAT(error_of_world(in_folder("w.sdf")),
                AllOf(file_is("w.sdf"), key_is("model 'm', link 'l', visual 'v'"),
                      what_is(AllOf(HasSubstr("cone.obj"), HasSubstr("leads out")))));
    fs::create_symlink(outside, in() / "link.obj");
    fs::create_directory_symlink(scratch_.path(), in() / "up");
    ASSERT_EQ(::mkfifo((in() / "pipe.obj").c_str(), 0600), 0);
    const std::pair<std::string, const char*> meshes[] = {{outside.string(), "leads out"},
                                                          {"file://" + outside.string(), "leads out"},
                                                          {"deeper/../../cone.obj", "leads out"},
                                                          {"link.obj", "is a symbolic link"},
                                                          {"up/cone.obj", "is a symbolic link"},
                                                          {"pipe.obj", "is a named pipe"},
                                                          {"none.obj", "No such file"}};
    for (const auto& [mesh, what] : meshes) {
        make_world_with(mesh);
        EXPECT_THAT(error_of_world(in_folder("w.sdf")),
                    what_is(AllOf(HasSubstr(mesh.substr(mesh.rfind('/') + 1)), HasSubstr(what))));
    }
}

TEST_F(ReaderProcessTest, opens_no_material_outside_of_its_folder) {
    make_world_with("it.obj");
    scratch_.write("in/it.obj", kTetrahedron);
    // A pipe would be waited for: whether it is opened shows.
    ASSERT_EQ(::mkfifo((scratch_ / "it.mtl").c_str(), 0600), 0);
    fs::create_symlink("../it.mtl", in() / "it.mtl");
    EXPECT_THAT(error_of_world(in_folder("w.sdf"), {.patience = std::chrono::seconds(20)}), is_no_error());
}

TEST_F(ReaderProcessTest, includes_nothing_in_a_world_of_a_folder) {
    make_world_with("");
    scratch_.write(
        "in/w.sdf",
        "<sdf version='1.9'>\n<world name='w'>\n<include><uri>/etc/passwd</uri></include></world></sdf>");
    EXPECT_THAT(error_of_world(in_folder("w.sdf")), AllOf(code_is(ErrorCode::unsupported), file_is("w.sdf"),
                                                          key_is("line 3"), what_is(HasSubstr("<include>"))));
}

TEST_F(ReaderProcessTest, waits_at_no_pipe_that_is_included) {
    fs::create_directories(scratch_ / "model");
    ASSERT_EQ(::mkfifo((scratch_ / "pipe.sdf").c_str(), 0600), 0);
    ASSERT_EQ(::mkfifo((scratch_ / "model/model.config").c_str(), 0600), 0);
    const std::string absolute = (scratch_ / "pipe.sdf").string();
    for (const std::string& uri :
         {absolute, "file://" + absolute, std::string("pipe.sdf"), std::string("model")}) {
        const auto world = scratch_.write("w.sdf", "<sdf version='1.9'>\n<world name='w'>\n<include><uri>" +
                                                       uri + "</uri></include></world></sdf>");
        EXPECT_THAT(error_of_world(world, {.patience = std::chrono::seconds(5)}),
                    AllOf(code_is(ErrorCode::wrong_kind_of_file), file_is("w.sdf"), key_is("line 3"),
                          value_is(AllOf(HasSubstr(uri), HasSubstr("a named pipe")))))
            << uri;
    }
}

TEST_F(ReaderProcessTest, waits_at_no_pipe_that_the_libraries_alone_find) {
    ASSERT_EQ(::mkfifo((scratch_ / "pipe.sdf").c_str(), 0600), 0);
    const std::string pipe = (scratch_ / "pipe.sdf").string();
    const auto including = [](const std::string& uri) {
        return "<sdf version='1.9'>\n<world name='w'>\n<include><uri>" + uri +
               "</uri></include></world></sdf>";
    };
    const auto model_of = [&](const std::string& folder, const std::string& sdf) {
        fs::create_directories(scratch_ / folder);
        scratch_.write(folder + "/model.config",
                       "<?xml version='1.0'?>\n<model><name>m</name>\n"
                       "<sdf version='1.9'>" +
                           sdf + "</sdf></model>\n");
    };
    model_of("named", "../pipe.sdf");  // as what its configuration names
    model_of("nested", "model.sdf");   // included by what is included
    scratch_.write("nested/model.sdf", "<sdf version='1.9'><model name='m'><include><uri>" + pipe +
                                           "</uri></include><link name='l'/></model></sdf>\n");
    for (const std::string& uri : {"\n  " + pipe + "\n", std::string("named"), std::string("nested")}) {
        const auto world = scratch_.write("w.sdf", including(uri));
        EXPECT_THAT(error_of_world(world, {.patience = std::chrono::seconds(5)}),
                    AllOf(code_is(ErrorCode::wrong_kind_of_file), file_is("w.sdf"),
                          value_is(AllOf(HasSubstr("pipe.sdf"), HasSubstr("a named pipe")))))
            << uri;
    }
}

TEST_F(ReaderProcessTest, goes_without_a_material_that_is_a_pipe_and_says_so) {
    make_world_with("it.obj");
    scratch_.write("in/it.obj", kTetrahedron);
    ASSERT_EQ(::mkfifo((in() / "it.mtl").c_str(), 0600), 0);
    const auto read = read_solids(in() / "w.sdf", {.patience = std::chrono::seconds(5)});
    ASSERT_TRUE(read) << read.error().message();
    ASSERT_EQ(read->warnings.size(), 1U);
    EXPECT_THAT(read->warnings[0], AllOf(HasSubstr("it.mtl"), HasSubstr("a named pipe")));
}

TEST_F(ReaderProcessTest, reads_no_world_outside_of_its_folder) {
    make_world_with("");
    const auto outside = scratch_.write("w.sdf", "<sdf version='1.9'/>");
    EXPECT_THAT(error_of_world(in_folder("../w.sdf")), what_is(HasSubstr("leads out")));
    EXPECT_THAT(error_of_world(in_folder(outside.string())), what_is(HasSubstr("leads out")));
    fs::create_symlink(outside, in() / "link.sdf");
    EXPECT_THAT(error_of_world(in_folder("link.sdf")), what_is(HasSubstr("is a symbolic link")));
    ASSERT_EQ(::mkfifo((in() / "pipe.sdf").c_str(), 0600), 0);
    EXPECT_THAT(error_of_world(in_folder("pipe.sdf")), what_is(HasSubstr("is a named pipe")));
}

}  // namespace
}  // namespace octoskin::sim
