#include "host/io/robot/fit_store.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

namespace fs = std::filesystem;

class FitStoreTest : public testing::Test {
  protected:
    FitStoreTest() {
        EXPECT_TRUE(store_.keep(key_, urdf_));
        file_ = store_.folder() / (key_ + ".fit");
    }
    [[nodiscard]] ErrorCode refusal() const {
        const auto found = store_.find(key_);
        EXPECT_FALSE(found);
        return found ? ErrorCode::self_check : found.error().code;
    }

    testing_support::ScratchFolder scratch_;
    FitStore store_{scratch_ / "cache"};
    std::string key_ = std::string(64, 'a');
    std::string urdf_ = "<robot name=\"r\"/>\n";
    fs::path file_;
};

TEST_F(FitStoreTest, gives_back_what_was_kept_under_that_key_alone) {
    EXPECT_EQ(*store_.find(key_), urdf_);
    EXPECT_EQ(*store_.find(std::string(64, 'b')), std::nullopt);
    EXPECT_EQ(*FitStore(scratch_ / "none").find(key_), std::nullopt);
    EXPECT_TRUE(store_.keep(key_, "other"));
    EXPECT_EQ(*store_.find(key_), "other");
    EXPECT_EQ(scratch_.read(file_).size(), 64U + 1 + 5);
}

TEST_F(FitStoreTest, only_its_owner_may_write_what_it_makes_whatever_the_umask_is) {
    const mode_t before = ::umask(0);
    const FitStore open(scratch_ / "open");
    const auto kept = open.keep(key_, urdf_);
    ::umask(before);
    ASSERT_TRUE(kept);
    EXPECT_EQ(*open.find(key_), urdf_);
    for (const fs::path& made : {open.folder(), scratch_ / "open/octoskin", scratch_ / "open"})
        EXPECT_EQ(fs::status(made).permissions(), fs::perms(0700)) << made;
    EXPECT_EQ(fs::status(open.folder() / (key_ + ".fit")).permissions(), fs::perms(0600));
}

TEST_F(FitStoreTest, refuses_a_folder_or_file_that_others_may_write) {
    for (const fs::path& path : {file_, store_.folder(), store_.folder().parent_path()}) {
        const fs::perms own = fs::status(path).permissions();
        for (const fs::perms others : {fs::perms::group_write, fs::perms::others_write}) {
            fs::permissions(path, own | others);
            EXPECT_EQ(refusal(), ErrorCode::foreign_owner) << path;
        }
        fs::permissions(path, own);
        EXPECT_TRUE(store_.find(key_));
    }
    fs::permissions(store_.folder(), fs::perms(0777));
    const auto kept = store_.keep(key_, urdf_);
    ASSERT_FALSE(kept);
    EXPECT_EQ(kept.error().code, ErrorCode::foreign_owner);
}

TEST_F(FitStoreTest, refuses_a_folder_or_file_of_another_user) {
    if (::geteuid() != 0) GTEST_SKIP() << "only root gives files away";
    for (const fs::path& path : {file_, store_.folder(), store_.folder().parent_path()}) {
        ASSERT_EQ(::chown(path.c_str(), 4242, 4242), 0);
        EXPECT_EQ(refusal(), ErrorCode::foreign_owner) << path;
        ASSERT_EQ(::chown(path.c_str(), 0, 0), 0);
    }
    EXPECT_TRUE(store_.find(key_));
}

TEST_F(FitStoreTest, refuses_links_pipes_and_files_with_a_second_name) {
    const fs::path aside = scratch_ / "aside.fit";
    fs::create_hard_link(file_, aside);
    EXPECT_EQ(refusal(), ErrorCode::foreign_owner);
    fs::remove(file_);
    fs::create_symlink(aside, file_);
    EXPECT_EQ(refusal(), ErrorCode::link);
    fs::remove(file_);
    ASSERT_EQ(::mkfifo(file_.c_str(), 0600), 0);
    EXPECT_EQ(refusal(), ErrorCode::wrong_kind_of_file);
}

TEST_F(FitStoreTest, refuses_a_link_in_place_of_a_folder) {
    for (const fs::path& path : {store_.folder(), store_.folder().parent_path()}) {
        fs::rename(path, scratch_ / "elsewhere");
        fs::create_directory_symlink(scratch_ / "elsewhere", path);
        EXPECT_EQ(refusal(), ErrorCode::link) << path;
        EXPECT_EQ(store_.keep(key_, urdf_).error().code, ErrorCode::link) << path;
        fs::remove(path);
        fs::rename(scratch_ / "elsewhere", path);
    }
    EXPECT_TRUE(store_.find(key_));
}

TEST_F(FitStoreTest, refuses_the_fit_of_another_key) {
    const std::string other(64, 'b');
    ASSERT_TRUE(store_.keep(other, "another robot"));
    fs::rename(store_.folder() / (other + ".fit"), file_);
    EXPECT_EQ(refusal(), ErrorCode::damaged);
}

TEST_F(FitStoreTest, refuses_a_file_that_is_cut_or_changed_anywhere) {
    const std::string whole = scratch_.read(file_);
    const auto write = [this](const std::string& bytes) { std::ofstream(file_, std::ios::binary) << bytes; };
    for (std::size_t i = 0; i < whole.size(); ++i) {
        write(whole.substr(0, i));
        EXPECT_EQ(refusal(), ErrorCode::damaged) << i;
        std::string changed = whole;
        changed[i] = static_cast<char>(changed[i] ^ 1);
        write(changed);
        EXPECT_EQ(refusal(), ErrorCode::damaged) << i;
    }
    write(whole);
    EXPECT_EQ(*store_.find(key_), urdf_);
}

TEST_F(FitStoreTest, is_in_the_users_cache) {
    ::setenv("HOME", "/home/ada", 1);
    ::setenv("XDG_CACHE_HOME", "/cache", 1);
    EXPECT_EQ(FitStore::of_this_user().folder(), "/cache/octoskin/robots");
    for (const char* relative : {"", "cache"}) {
        ::setenv("XDG_CACHE_HOME", relative, 1);
        EXPECT_EQ(FitStore::of_this_user().folder(), "/home/ada/.cache/octoskin/robots");
    }
    ::unsetenv("HOME");
    ::unsetenv("XDG_CACHE_HOME");
    const FitStore nowhere = FitStore::of_this_user();
    EXPECT_EQ(*nowhere.find(key_), std::nullopt);
    EXPECT_EQ(nowhere.keep(key_, urdf_).error().code, ErrorCode::not_found);
}

}  // namespace
}  // namespace octoskin
