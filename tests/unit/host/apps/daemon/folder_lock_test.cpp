#include "host/apps/daemon/folder_lock.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "host/apps/recording/file_lock.hpp"
#include "host/apps/recording/file_set.hpp"
#include "host/io/folder/descriptor.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

TEST(FolderLock, is_held_by_one_at_a_time_whose_process_is_named) {
    const testing_support::ScratchFolder scratch;
    const auto folder = scratch / "not/yet/there";
    std::optional<FolderLock> first;
    {
        auto taken = FolderLock::take(folder);
        ASSERT_TRUE(taken) << taken.error().message();
        first.emplace(std::move(taken).value());
    }
    const auto second = FolderLock::take(folder);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().exit, ExitCode::cannot_create);
    EXPECT_EQ(second.error().error.code, ErrorCode::in_use);
    EXPECT_EQ(second.error().error.file, folder);
    EXPECT_NE(second.error().error.what.find("process " + std::to_string(::getpid())), std::string::npos)
        << second.error().message();
    EXPECT_TRUE(FolderLock::take(scratch / "another"));
    first.reset();
    EXPECT_TRUE(FolderLock::take(folder));
}

/// While its files move, the file names the process of a daemon that has ended.
TEST(FolderLock, does_not_name_a_process_that_has_ended) {
    const testing_support::ScratchFolder scratch;
    std::ofstream(scratch / FolderLock::kFile) << 4'194'305;  // above the largest process id
    const auto moving =
        FileLock::take(FilePlace(scratch.path() / FolderLock::kFile), FileLock::Kind::exclusive);
    ASSERT_TRUE(moving);
    const auto taken = FolderLock::take(scratch.path());
    ASSERT_FALSE(taken);
    EXPECT_EQ(taken.error().error.code, ErrorCode::in_use);
    EXPECT_EQ(taken.error().message().find("(process"), std::string::npos) << taken.error().message();
    EXPECT_NE(taken.error().error.what.find("octoskin replay"), std::string::npos) << taken.error().message();
}

/// A replay that began before the daemon does not replace the daemon's maps at its end.
TEST(FolderLock, is_taken_where_files_are_about_to_be_put_and_keeps_them_out) {
    const testing_support::ScratchFolder scratch;
    auto files = FileSet::begin(FilePlace(scratch.path()));
    ASSERT_TRUE(files) << files.error().message();
    ASSERT_TRUE(files->draft().create_new("fused.ot"));
    const auto taken = FolderLock::take(scratch.path());
    ASSERT_TRUE(taken) << taken.error().message();
    const auto refused = files->commit({"fused.ot"}, {});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().exit, ExitCode::cannot_create);
    EXPECT_FALSE(std::filesystem::exists(scratch / "fused.ot"));
}

/// In a folder without a lock file as well as beside that of an earlier daemon.
TEST(FolderLock, is_not_taken_while_files_are_moved_into_the_folder) {
    constexpr int kFiles = 100;
    std::vector<std::filesystem::path> names;
    for (int i = 0; i < kFiles; ++i)
        names.emplace_back("mesh_" + std::string(i < 10 ? "0" : "") + std::to_string(i) + ".stl");
    for (const bool is_lock_there : {false, true}) {
        for (int round = 0; round < 5; ++round) {
            const testing_support::ScratchFolder scratch;
            if (is_lock_there) scratch.write("lock", "");
            auto files = FileSet::begin(FilePlace(scratch.path()));
            ASSERT_TRUE(files) << files.error().message();
            for (const auto& name : names) ASSERT_TRUE(files->draft().create_new(name));
            const auto ready = scratch / FileSet::kReadyFolder;
            std::atomic<bool> is_over = false;
            bool is_taken = false;
            std::thread daemon([&] {
                while (!is_over && !is_taken) {
                    if (!std::filesystem::exists(ready)) continue;
                    const auto taken = FolderLock::take(scratch.path());
                    is_taken = taken && std::filesystem::exists(ready);
                }
            });
            const auto put = files->commit(names, {});
            is_over = true;
            daemon.join();
            EXPECT_FALSE(is_taken);
            ASSERT_TRUE(put) << put.error().message();
            EXPECT_FALSE(std::filesystem::exists(ready));
            EXPECT_TRUE(FolderLock::take(scratch.path()));
        }
    }
}

/// A replay that was killed while it moved its files: `former` of an earlier replay, in a file system without
/// hard links.
void lay_out_half_moved(const testing_support::ScratchFolder& scratch, bool has_former) {
    std::filesystem::create_directories(scratch / ".octoskin-ready/.before");
    scratch.write(".octoskin-ready/.journal", "octoskin-file-set/1\nput fused.ot\nput maps.yaml\n");
    for (const std::string& name : {std::string("fused.ot"), std::string("maps.yaml")}) {
        scratch.write(".octoskin-ready/" + name, "new");
        if (has_former) scratch.write(".octoskin-ready/.before/" + name, "former");
    }
}

TEST(FolderLock, completes_the_move_of_a_killed_run) {
    for (const bool has_former : {false, true}) {
        const testing_support::ScratchFolder scratch;
        lay_out_half_moved(scratch, has_former);
        const auto taken = FolderLock::take(scratch.path());
        ASSERT_TRUE(taken) << taken.error().message();
        for (const char* name : {"fused.ot", "maps.yaml"})
            EXPECT_EQ(testing_support::ScratchFolder::read(scratch / name), "new") << name;
        EXPECT_FALSE(std::filesystem::exists(scratch / ".octoskin-ready"));
        EXPECT_FALSE(FolderLock::take(scratch.path())) << "it is held";
    }
}

TEST(FolderLock, is_not_taken_where_files_of_a_killed_run_wait_beside_a_daemons_map_or_cannot_be_moved) {
    for (const std::string& obstacle : {std::string("fused.snapshot"), std::string("maps.yaml/")}) {
        const testing_support::ScratchFolder scratch;
        lay_out_half_moved(scratch, true);
        if (obstacle.ends_with('/')) std::filesystem::create_directory(scratch / "maps.yaml");
        if (!obstacle.ends_with('/')) scratch.write(obstacle, "the daemon's");
        const auto refused = FolderLock::take(scratch.path());
        ASSERT_FALSE(refused) << obstacle;
        EXPECT_EQ(refused.error().exit, ExitCode::cannot_create);
        for (const std::string& part :
             {"wait in " + (scratch / ".octoskin-ready").string(), std::string("octoskin repair")})
            EXPECT_NE(refused.error().message().find(part), std::string::npos) << refused.error().message();
        EXPECT_EQ(testing_support::ScratchFolder::read(scratch / ".octoskin-ready/fused.ot"), "new");
        EXPECT_EQ(testing_support::ScratchFolder::read(scratch / ".octoskin-ready/.before/fused.ot"),
                  "former");
        EXPECT_FALSE(std::filesystem::exists(scratch / "fused.ot"));
    }
}

/// What any user can take that may read the folder.
TEST(FolderLock, is_taken_where_another_process_has_a_lock_of_the_folder_itself) {
    const testing_support::ScratchFolder scratch;
    const Descriptor foreign(::open(scratch.path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    ASSERT_EQ(::flock(foreign.get(), LOCK_EX | LOCK_NB), 0);
    EXPECT_TRUE(FolderLock::take(scratch.path()));
}

/// Of what others can open they can keep the lock.
TEST(FolderLock, is_of_a_file_that_no_other_user_can_open) {
    const testing_support::ScratchFolder scratch;
    using std::filesystem::perms;
    const auto mode = [&] { return std::filesystem::status(scratch / FolderLock::kFile).permissions(); };
    EXPECT_TRUE(FolderLock::take(scratch.path()));
    EXPECT_EQ(mode(), perms{0600});
    std::filesystem::permissions(scratch / FolderLock::kFile, perms{0640});
    EXPECT_TRUE(FolderLock::take(scratch.path()));
    EXPECT_EQ(mode(), perms{0600});
}

TEST(FolderLock, that_root_makes_is_of_the_folders_owner) {
    if (::geteuid() != 0) GTEST_SKIP() << "only root makes files of others";
    constexpr uid_t kOwner = 54321;
    const testing_support::ScratchFolder scratch;
    ASSERT_EQ(::chown(scratch.path().c_str(), kOwner, kOwner), 0);
    EXPECT_TRUE(FolderLock::take(scratch.path()));
    struct stat status {};
    ASSERT_EQ(::stat((scratch / FolderLock::kFile).c_str(), &status), 0);
    EXPECT_EQ(status.st_uid, kOwner);
    EXPECT_EQ(status.st_gid, kOwner);
}

TEST(FolderLock, says_why_nothing_can_be_written_there) {
    const testing_support::ScratchFolder scratch;
    scratch.write("file", "in the way");
    const auto lock = FolderLock::take(scratch / "file");
    ASSERT_FALSE(lock);
    EXPECT_EQ(lock.error().exit, ExitCode::cannot_create);
    EXPECT_EQ(lock.error().error.file, scratch / "file");
    EXPECT_NE(lock.error().error.remedy.find("--maps"), std::string::npos) << lock.error().message();
    EXPECT_EQ(testing_support::ScratchFolder::read(scratch / "file"), "in the way");
}

TEST(FolderLock, writes_through_no_link_to_a_file_of_others) {
    const testing_support::ScratchFolder scratch;
    const auto victim = scratch.write("victim", "precious");
    std::filesystem::create_directory(scratch / "maps");
    std::filesystem::create_symlink("../victim", scratch / "maps/lock");
    const auto refused = FolderLock::take(scratch / "maps");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().error.code, ErrorCode::link);
    EXPECT_EQ(refused.error().error.file, scratch / "maps/lock");
    std::filesystem::remove(scratch / "maps/lock");
    std::filesystem::create_hard_link(victim, scratch / "maps/lock");
    {
        const auto taken = FolderLock::take(scratch / "maps");
        ASSERT_TRUE(taken) << taken.error().message();
        EXPECT_EQ(testing_support::ScratchFolder::read(scratch / "maps/lock"), std::to_string(::getpid()));
        EXPECT_FALSE(FolderLock::take(scratch / "maps"));
    }
    std::filesystem::remove(scratch / "maps/lock");
    ASSERT_EQ(::mkfifo((scratch / "maps/lock").c_str(), 0600), 0);
    EXPECT_FALSE(FolderLock::take(scratch / "maps")) << "and waits for nobody";
    EXPECT_EQ(testing_support::ScratchFolder::read(victim), "precious");
}

TEST(FolderLock, holds_the_folder_that_was_opened) {
    const testing_support::ScratchFolder scratch;
    const auto taken = FolderLock::take(scratch / "maps");
    ASSERT_TRUE(taken);
    std::filesystem::rename(scratch / "maps", scratch / "away");
    EXPECT_FALSE(taken->folder().is_still_there());
    EXPECT_TRUE(taken->folder().create_new("fused.ot"));
    EXPECT_TRUE(std::filesystem::exists(scratch / "away/fused.ot"));
}

}  // namespace
}  // namespace octoskin
