#include "host/io/folder/open_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <string>

#include "tests/support/errors/error_fields.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;
using testing_support::code_is;
using testing_support::has_its_fields;
using testing_support::ScratchFolder;
using testing_support::what_is;

int absent_call(int, const char*, const open_how&) {
    errno = ENOSYS;
    return -1;
}
int filtered_call(int, const char*, const open_how&) {
    errno = EPERM;
    return -1;
}

struct Way {
    const char* name;
    OpenAt2 openat2;
};

/// The rules hold with openat2 and without it.
class OpenFolderTest : public testing::TestWithParam<Way> {
  protected:
    OpenFolderTest() {
        fs::create_directories(scratch_ / "rec/maps/deep");
        fs::create_directories(scratch_ / "victim/keys");
        scratch_.write("rec/can.log", "log");
        scratch_.write("rec/maps/fused.ot", "map");
        scratch_.write("victim/secret", "secret");
        scratch_.write("victim/keys/key", "key");
        fs::create_directory_symlink("../victim", scratch_ / "rec/out");
        fs::create_symlink("../victim/secret", scratch_ / "rec/secret");
        fs::create_symlink("can.log", scratch_ / "rec/inner");
        fs::create_symlink("nowhere", scratch_ / "rec/dangling");
        fs::create_directory_symlink("/", scratch_ / "rec/root");
        ::mkfifo((scratch_ / "rec/pipe").c_str(), 0600);
    }

    [[nodiscard]] OpenFolder open(FolderAccess access = FolderAccess::write) const {
        auto opened = OpenFolder::open(scratch_ / "rec", access, GetParam().openat2);
        EXPECT_TRUE(opened);
        return *opened;
    }
    [[nodiscard]] static FolderFault fault_of(const Result<OpenFile, FolderError>& opened) {
        EXPECT_FALSE(opened);
        return opened ? FolderFault::system : opened.error().fault;
    }
    [[nodiscard]] std::string victim() const {
        return ScratchFolder::read(scratch_ / "victim/secret") +
               ScratchFolder::read(scratch_ / "victim/keys/key");
    }

    ScratchFolder scratch_;
};

TEST_P(OpenFolderTest, opens_what_is_in_it) {
    const OpenFolder folder = open(FolderAccess::read);
    const auto log = folder.open_file("can.log");
    ASSERT_TRUE(log);
    EXPECT_EQ(*log->read(100), "log");
    EXPECT_EQ(log->read(1)->size(), 2U);
    EXPECT_EQ(ScratchFolder::read(log->path_for_libraries()), "log");
    EXPECT_EQ(ScratchFolder::read(log->path_for_helpers()), "log");
    EXPECT_EQ(*folder.open_file("maps/../maps/./fused.ot")->read(100), "map");
    EXPECT_EQ(*folder.open_folder("maps")->open_file("fused.ot")->read(100), "map");
}

TEST_P(OpenFolderTest, follows_links_in_the_path_that_was_typed) {
    fs::create_directory_symlink("rec", scratch_ / "alias");
    const auto folder = OpenFolder::open(scratch_ / "alias", FolderAccess::write, GetParam().openat2);
    ASSERT_TRUE(folder);
    EXPECT_EQ(*folder->open_file("can.log")->read(100), "log");
    EXPECT_EQ(folder->shown("can.log"), scratch_ / "alias/can.log");
}

TEST_P(OpenFolderTest, follows_no_link_below_it_and_names_it) {
    const OpenFolder folder = open();
    const std::pair<const char*, const char*> links[] = {
        {"secret", "secret"},    {"inner", "inner"}, {"dangling", "dangling"},    {"out/secret", "out"},
        {"out/keys/key", "out"}, {"out/", "out"},    {"root/etc/passwd", "root"}, {"out", "out"}};
    for (const auto& [name, link] : links) {
        const auto opened = folder.open_file(name);
        ASSERT_EQ(fault_of(opened), FolderFault::link) << name;
        EXPECT_EQ(opened.error().path, scratch_ / "rec" / link) << name;
        const Error error = to_error(opened.error(), "cannot be read: ");
        EXPECT_THAT(error, AllOf(code_is(ErrorCode::link), what_is(StartsWith("cannot be read: ")))) << name;
        EXPECT_EQ(error.file, opened.error().path) << name;
        EXPECT_TRUE(has_its_fields(error));
        EXPECT_EQ(folder.kind_of(name), EntryKind::link) << name;
    }
    EXPECT_EQ(folder.open_folder("out").error().fault, FolderFault::link);
    EXPECT_EQ(folder.open_folder("out/keys").error().fault, FolderFault::link);
}

TEST_P(OpenFolderTest, a_name_leads_nowhere_but_into_it) {
    const OpenFolder folder = open();
    for (const char* name :
         {"..", "../victim/secret", "maps/../../victim/secret", "/etc/passwd", "", ".", "./"}) {
        EXPECT_EQ(fault_of(folder.open_file(name)), FolderFault::outside) << name;
        EXPECT_EQ(fault_of(folder.create_new(name)), FolderFault::outside) << name;
        EXPECT_FALSE(folder.remove_all(name)) << name;
        EXPECT_FALSE(folder.move("can.log", name)) << name;
    }
    EXPECT_EQ(fault_of(folder.open_file(std::string("can.log\0x", 9))), FolderFault::outside);
    EXPECT_EQ(victim(), "secretkey");
}

TEST_P(OpenFolderTest, opens_only_ordinary_files_and_waits_for_none) {
    const OpenFolder folder = open();
    EXPECT_EQ(fault_of(folder.open_file("pipe")), FolderFault::not_a_file);
    EXPECT_THAT(to_error(folder.open_file("pipe").error()),
                AllOf(code_is(ErrorCode::wrong_kind_of_file), what_is(HasSubstr("a named pipe"))));
    EXPECT_EQ(fault_of(folder.open_file("maps")), FolderFault::not_a_file);
    EXPECT_EQ(fault_of(folder.open_file("absent")), FolderFault::absent);
    EXPECT_EQ(fault_of(folder.open_file("can.log/x")), FolderFault::not_a_folder);
    EXPECT_EQ(folder.kind_of("pipe"), EntryKind::other);
    EXPECT_EQ(folder.kind_of("maps"), EntryKind::folder);
    EXPECT_EQ(folder.kind_of("absent"), EntryKind::absent);
    EXPECT_EQ(folder.kind_of("can.log/x"), EntryKind::absent);
    if (::geteuid() == 0 && ::mknod((scratch_ / "rec/device").c_str(), S_IFCHR | 0600, makedev(1, 3)) == 0) {
        EXPECT_EQ(fault_of(folder.open_file("device")), FolderFault::not_a_file);
    }
}

TEST_P(OpenFolderTest, makes_new_files_only_where_nothing_is) {
    const OpenFolder folder = open();
    ASSERT_TRUE(folder.create_new("maps/new"));
    for (const char* name : {"can.log", "secret", "dangling", "maps", "pipe", "maps/new"})
        EXPECT_EQ(fault_of(folder.create_new(name)), FolderFault::is_there) << name;
    EXPECT_EQ(fault_of(folder.create_new("out/new")), FolderFault::link);
    EXPECT_FALSE(folder.make_folder("out/new"));
    EXPECT_FALSE(folder.make_folder("out"));
    EXPECT_TRUE(folder.make_folder("maps/more"));
    EXPECT_FALSE(fs::exists(scratch_ / "victim/new"));
    EXPECT_FALSE(fs::exists(scratch_ / "rec/nowhere"));
}

TEST_P(OpenFolderTest, moves_links_and_removes_within_it_alone) {
    const OpenFolder folder = open();
    EXPECT_EQ(folder.move("can.log", "out/secret").error().fault, FolderFault::link);
    EXPECT_EQ(folder.move("out/secret", "taken").error().fault, FolderFault::link);
    EXPECT_EQ(folder.link("out/secret", "taken").error().fault, FolderFault::link);
    EXPECT_EQ(folder.remove("out/secret").error().fault, FolderFault::link);
    EXPECT_EQ(folder.remove_all("out/keys").error().fault, FolderFault::link);
    EXPECT_EQ(folder.flush("secret").error().fault, FolderFault::link);
    ASSERT_TRUE(folder.move("can.log", "secret"));  // in the link's place
    EXPECT_EQ(*folder.open_file("secret")->read(100), "log");
    ASSERT_TRUE(folder.link("secret", "maps/second"));
    EXPECT_TRUE(folder.flush("secret"));
    EXPECT_TRUE(folder.flush());
    ASSERT_TRUE(folder.remove("dangling"));
    ASSERT_TRUE(folder.remove("absent"));
    fs::create_directory_symlink("../../victim", scratch_ / "rec/maps/deep/out");
    ASSERT_TRUE(folder.remove_all("maps"));
    EXPECT_TRUE(folder.remove_all("out"));  // the link itself
    EXPECT_FALSE(folder.remove_empty("absent"));
    const auto names = folder.names();
    ASSERT_TRUE(names);
    EXPECT_THAT(*names, ElementsAre("inner", "pipe", "root", "secret"));
    EXPECT_EQ(victim(), "secretkey");
}

TEST_P(OpenFolderTest, goes_on_in_the_folder_that_was_opened_whatever_takes_its_name) {
    const OpenFolder folder = open();
    EXPECT_TRUE(folder.is_still_there());
    fs::rename(scratch_ / "rec", scratch_ / "away");
    fs::create_directory_symlink("victim", scratch_ / "rec");
    EXPECT_FALSE(folder.is_still_there());
    ASSERT_TRUE(folder.create_new("new"));
    EXPECT_TRUE(fs::exists(scratch_ / "away/new"));
    EXPECT_FALSE(fs::exists(scratch_ / "victim/new"));
}

INSTANTIATE_TEST_SUITE_P(WithAndWithoutOpenat2, OpenFolderTest,
                         testing::Values(Way{"openat2", system_openat2}, Way{"absent", absent_call},
                                         Way{"filtered", filtered_call}),
                         [](const auto& instance) { return std::string(instance.param.name); });

/// As another user: a thread cannot, so a process of its own does. True: the claim holds.
template <class Claim>
bool holds_as(uid_t user, const Claim& claim) {
    const pid_t child = ::fork();
    if (child == 0) ::_exit(::seteuid(user) == 0 && claim() ? 0 : 1);
    int status = 0;
    return ::waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

constexpr uid_t kOne = 12'345;
constexpr uid_t kOther = 12'346;

TEST(FolderOwnerTest, writes_only_into_folders_of_the_caller_or_of_root) {
    if (::geteuid() != 0) GTEST_SKIP() << "needs root, to be other users";
    const ScratchFolder scratch;
    fs::permissions(scratch.path(), fs::perms::all);
    for (const char* name : {"one", "other", "root"}) {
        fs::create_directory(scratch / name);
        fs::permissions(scratch / name, fs::perms::all);
    }
    fs::create_directory(scratch / "one/within");
    fs::permissions(scratch / "one/within", fs::perms::all);
    ASSERT_EQ(::chown((scratch / "one").c_str(), kOne, kOne), 0);
    ASSERT_EQ(::chown((scratch / "other").c_str(), kOther, kOther), 0);
    ASSERT_EQ(::chown((scratch / "one/within").c_str(), kOther, kOther), 0);
    const auto may_write = [&](const char* name) {
        return OpenFolder::open(scratch / name, FolderAccess::write).has_value();
    };
    EXPECT_TRUE(holds_as(kOne, [&] {
        const auto foreign = OpenFolder::open(scratch / "other", FolderAccess::write);
        return may_write("one") && may_write("root") && !foreign &&
               foreign.error().fault == FolderFault::foreign_owner &&
               foreign.error().what.find("12346") != std::string::npos;
    }));
    EXPECT_TRUE(holds_as(kOne, [&] {
        const auto one = OpenFolder::open(scratch / "one", FolderAccess::write);
        return one && !one->open_folder("within") && !one->create_new("within/file") &&
               OpenFolder::open(scratch / "other", FolderAccess::read).has_value();
    }));
    EXPECT_TRUE(may_write("one") && may_write("other") && may_write("root"));  // root
}

TEST(MakeOpenFolderTest, makes_what_is_not_there_with_its_parents_if_that_is_asked_for) {
    const ScratchFolder scratch;
    const auto made = make_open_folder(scratch / "a/b");
    ASSERT_TRUE(made);
    EXPECT_TRUE(made->is_new);
    EXPECT_TRUE(made->folder.create_new("file"));
    EXPECT_FALSE(make_open_folder(scratch / "a/b")->is_new);
    const auto lone = make_open_folder(scratch / "c/d", Parents::must_be_there);
    ASSERT_FALSE(lone);
    EXPECT_EQ(lone.error().fault, FolderFault::absent);
    EXPECT_EQ(make_open_folder(scratch / "a/b/file").error().fault, FolderFault::not_a_folder);
    fs::create_directory_symlink("a", scratch / "link");
    EXPECT_TRUE(make_open_folder(scratch / "link"));
    EXPECT_TRUE(make_open_folder(scratch / "link/new")->is_new);
    EXPECT_TRUE(fs::is_directory(scratch / "a/new"));
}

}  // namespace
}  // namespace octoskin
