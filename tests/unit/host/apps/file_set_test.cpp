#include "host/apps/recording/file_set.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <random>
#include <string>
#include <vector>

#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::ScratchFolder;

const std::vector<fs::path> kFiles = {"can.log", "depth.oni", "meta.yaml"};

void write(const fs::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
}

/// What is in the folder, hidden things included: "a=new b=new".
std::string reported(const fs::path& folder) {
    std::vector<std::string> entries;
    for (const auto& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        entries.push_back(entry.is_regular_file() ? name + "=" + ScratchFolder::read(entry.path()) : name);
    }
    std::sort(entries.begin(), entries.end());
    std::string text;
    for (const std::string& entry : entries) text.append(text.empty() ? "" : " ").append(entry);
    return text;
}

constexpr const char* kOld = "can.log=old meta.yaml=old robot.urdf=old";
constexpr const char* kNew = "can.log=new depth.oni=new meta.yaml=new";

/// The old set; depth.oni is to be new, robot.urdf to go.
void fill_old(const fs::path& folder) {
    for (const char* name : {"can.log", "robot.urdf", "meta.yaml"}) write(folder / name, "old");
}

Status<AppError> replace_by_new(const fs::path& folder) {
    auto set = FileSet::begin(folder);
    if (!set) return unexpected(set.error());
    for (const fs::path& file : kFiles) write(set->draft().shown() / file, "new");
    return set->commit(kFiles, {"robot.urdf", "maps/fused.ot"});
}

Result<bool, AppError> settle(const fs::path& folder) {
    return settle_file_set(OpenFolder::open(folder, FolderAccess::write).value());
}

TEST(FileSetTest, puts_all_files_in_place_and_takes_the_retired_away) {
    const ScratchFolder folder;
    fill_old(folder.path());
    const auto committed = replace_by_new(folder.path());
    ASSERT_TRUE(committed) << committed.error().message();
    EXPECT_EQ(reported(folder.path()), kNew);
}

TEST(FileSetTest, leaves_the_folder_as_it_was_if_it_is_given_up) {
    const ScratchFolder folder;
    fill_old(folder.path());
    {
        auto set = FileSet::begin(folder.path());
        ASSERT_TRUE(set);
        write(set->draft().shown() / "can.log", "new");
        const FileSet moved = std::move(*set);
        EXPECT_EQ(moved.folder().shown(), folder.path());
    }
    EXPECT_EQ(reported(folder.path()), kOld);
    { ASSERT_TRUE(FileSet::begin(folder / "made/for/it")); }
    EXPECT_FALSE(fs::exists(folder / "made/for/it"));
}

TEST(FileSetTest, of_two_at_once_the_second_is_refused_with_the_directory_and_a_way_out) {
    const ScratchFolder folder;
    const auto first = FileSet::begin(folder.path());
    ASSERT_TRUE(first);
    write(first->draft().shown() / "can.log", "new");
    const auto second = FileSet::begin(folder.path());
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().exit, ExitCode::cannot_create);
    EXPECT_EQ(second.error().error.code, ErrorCode::in_use);
    EXPECT_EQ(second.error().error.file, folder.path());
    EXPECT_THAT(second.error().error.remedy,
                testing::AllOf(HasSubstr("wait"), HasSubstr("another directory")));
    EXPECT_EQ(ScratchFolder::read(first->draft().shown() / "can.log"), "new");
}

TEST(FileSetTest, of_a_folder_that_a_daemon_keeps_its_map_in_nothing_is_replaced) {
    const ScratchFolder scratch;
    write(scratch / "fused.ot", "the daemon's");
    write(scratch / kDaemonsLock, "");
    {
        const int lock = ::open((scratch / kDaemonsLock).c_str(), O_RDONLY | O_CLOEXEC);
        ASSERT_EQ(::flock(lock, LOCK_EX | LOCK_NB), 0);
        const auto refused = FileSet::begin(scratch.path());
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().exit, ExitCode::cannot_create);
        ::close(lock);
    }
    EXPECT_TRUE(FileSet::begin(scratch.path())) << "the daemon has ended, and left no snapshot";
    write(scratch / kDaemonsSnapshot, "");
    const auto refused = FileSet::begin(scratch.path());
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().exit, ExitCode::cannot_create);
    EXPECT_EQ(refused.error().error.code, ErrorCode::already_exists);
    EXPECT_EQ(refused.error().error.file, scratch / kDaemonsSnapshot);
    EXPECT_EQ(reported(scratch.path()), "fused.ot=the daemon's fused.snapshot= lock=");
}

TEST(FileSetTest, keeps_no_daemon_from_beginning_until_its_files_come) {
    const ScratchFolder scratch;
    write(scratch / kDaemonsLock, "");
    auto set = FileSet::begin(scratch.path());
    ASSERT_TRUE(set);
    for (const fs::path& file : kFiles) write(set->draft().shown() / file, "new");
    const int lock = ::open((scratch / kDaemonsLock).c_str(), O_RDONLY | O_CLOEXEC);
    EXPECT_EQ(::flock(lock, LOCK_EX | LOCK_NB), 0) << "that of a daemon that begins meanwhile";
    const auto refused = set->commit(kFiles, {});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().exit, ExitCode::cannot_create);
    ::close(lock);
}

/// Of one that others can open they can keep the lock; one that stays is in the way of nothing.
TEST(FileSetTest, leaves_no_lock_file_of_its_own_and_keeps_one_that_is_there) {
    for (const bool is_there : {false, true}) {
        const ScratchFolder folder;
        fill_old(folder.path());
        if (is_there) write(folder / kDaemonsLock, "mine");
        ASSERT_TRUE(replace_by_new(folder.path()));
        EXPECT_EQ(reported(folder.path()),
                  is_there ? "can.log=new depth.oni=new lock=mine meta.yaml=new" : kNew);
    }
}

TEST(FileSetTest, removes_its_draft_where_a_daemon_has_begun_to_keep_its_map) {
    const ScratchFolder parent;
    const fs::path folder = parent / "new";
    {
        auto set = FileSet::begin(folder);
        ASSERT_TRUE(set);
        for (const fs::path& file : kFiles) write(set->draft().shown() / file, "new");
        write(folder / kDaemonsSnapshot, "the daemon's");
        ASSERT_FALSE(set->commit(kFiles, {}));
    }
    EXPECT_EQ(reported(folder), "fused.snapshot=the daemon's");
}

TEST(FileSetTest, the_lock_goes_with_its_process) {
    const ScratchFolder folder;
    const pid_t child = ::fork();
    if (child == 0) {
        const auto set = FileSet::begin(folder.path());
        ::kill(::getpid(), SIGKILL);
    }
    ASSERT_EQ(::waitpid(child, nullptr, 0), child);
    EXPECT_TRUE(fs::exists(folder / FileSet::kDraftFolder));
    EXPECT_TRUE(replace_by_new(folder.path()));
    EXPECT_EQ(reported(folder.path()), kNew);
}

TEST(FileSetTest, a_directory_in_the_way_is_named_and_changes_nothing) {
    for (const char* in_the_way : {"can.log", "depth.oni", "robot.urdf", "meta.yaml"}) {
        const ScratchFolder folder;
        fill_old(folder.path());
        fs::remove(folder / in_the_way);
        fs::create_directory(folder / in_the_way);
        const std::string before = reported(folder.path());
        const auto committed = replace_by_new(folder.path());
        ASSERT_FALSE(committed) << in_the_way;
        EXPECT_EQ(committed.error().error.code, ErrorCode::wrong_kind_of_file);
        EXPECT_EQ(committed.error().error.file, folder / in_the_way);
        EXPECT_EQ(reported(folder.path()), before);
    }
}

/// The ready folder as it is after the decision, with `moved` of the new files in their places already.
void lay_out_half_done(const fs::path& folder, std::size_t moved, bool is_voucher_gone) {
    fill_old(folder);
    const fs::path ready = folder / ".octoskin-ready";
    fs::create_directory(ready);
    write(ready / ".journal",
          "octoskin-file-set/1\ndrop robot.urdf\nput can.log\nput depth.oni\nput meta.yaml\n");
    if (is_voucher_gone) fs::remove(folder / "meta.yaml");
    for (std::size_t i = 0; i < kFiles.size(); ++i) write((i < moved ? folder : ready) / kFiles[i], "new");
}

TEST(FileSetTest, what_was_killed_after_any_step_is_brought_to_its_end_by_the_next_one) {
    for (std::size_t moved = 0; moved <= kFiles.size(); ++moved) {
        const ScratchFolder folder;
        lay_out_half_done(folder.path(), moved, moved > 0);
        const auto settled = settle(folder.path());
        ASSERT_TRUE(settled) << moved;
        EXPECT_TRUE(*settled) << moved;
        EXPECT_EQ(reported(folder.path()), kNew) << moved;
        const auto again = settle(folder.path());
        ASSERT_TRUE(again);
        EXPECT_FALSE(*again) << "there was nothing left";
    }
}

TEST(FileSetTest, what_was_killed_is_not_brought_to_its_end_where_a_daemon_has_begun_since) {
    for (const char* const of_daemon : {kDaemonsLock, kDaemonsSnapshot}) {
        const ScratchFolder folder;
        lay_out_half_done(folder.path(), 0, false);
        write(folder / of_daemon, "");
        const int lock = ::open((folder / of_daemon).c_str(), O_RDONLY | O_CLOEXEC);
        ASSERT_EQ(::flock(lock, LOCK_EX | LOCK_NB), 0);
        const std::string before = reported(folder.path());
        const auto settled = settle(folder.path());
        ASSERT_FALSE(settled) << of_daemon;
        EXPECT_EQ(settled.error().exit, ExitCode::cannot_create);
        const bool is_locked = of_daemon == std::string_view(kDaemonsLock);
        const Error& error = settled.error().error;
        EXPECT_EQ(error.code, is_locked ? ErrorCode::in_use : ErrorCode::unfinished_move);
        EXPECT_THAT(is_locked ? error.others : error.what,
                    HasSubstr("wait in " + (folder / ".octoskin-ready").string()));
        EXPECT_EQ(reported(folder.path()), before);
        ::close(lock);
    }
}

TEST(FileSetTest, an_error_while_it_moves_takes_all_of_it_back_until_it_can_be_done) {
    const std::pair<const char*, const char*> obstacles[] = {
        {"robot.urdf", ".octoskin-ready can.log=old meta.yaml=old robot.urdf"},
        {"can.log", ".octoskin-ready can.log meta.yaml=old robot.urdf=old"},
        {"depth.oni", ".octoskin-ready can.log=old depth.oni meta.yaml=old robot.urdf=old"},
        {"meta.yaml", ".octoskin-ready can.log=old meta.yaml robot.urdf=old"}};
    for (const auto& [obstacle, expected] : obstacles) {
        const ScratchFolder folder;
        lay_out_half_done(folder.path(), 0, false);
        // It came into the way after the places were looked at.
        fs::remove(folder / obstacle);
        fs::create_directory(folder / obstacle);
        const auto settled = settle(folder.path());
        ASSERT_FALSE(settled) << obstacle;
        EXPECT_EQ(settled.error().error.code, ErrorCode::wrong_kind_of_file);
        EXPECT_EQ(settled.error().error.file, folder / obstacle);
        EXPECT_THAT(settled.error().error.remedy, HasSubstr("octoskin repair " + folder.path().string()));
        EXPECT_THAT(settled.error().error.others,
                    HasSubstr("wait in " + (folder / ".octoskin-ready").string()));
        EXPECT_EQ(reported(folder.path()), expected);
        fs::remove(folder / obstacle);
        ASSERT_TRUE(settle(folder.path())) << obstacle;
        EXPECT_EQ(reported(folder.path()), kNew) << "and no lock file";
    }
}

TEST(FileSetTest, what_cannot_be_finished_is_left_as_it_lies_and_said_once) {
    const ScratchFolder folder;
    fs::create_directories(folder / ".octoskin-ready");
    write(folder / ".octoskin-ready/.journal", "octoskin-file-set/1\nput can.log\n");
    fs::create_directory(folder / "can.log");
    const auto refused = settle(folder.path());
    ASSERT_FALSE(refused);
    const Error& error = refused.error().error;
    EXPECT_EQ(error.code, ErrorCode::wrong_kind_of_file);
    EXPECT_EQ(error.file, folder / "can.log");
    EXPECT_THAT(error.what + error.others, testing::Not(HasSubstr("can.log"))) << refused.error().message();
    EXPECT_TRUE(fs::is_directory(folder / "can.log")) << "a folder that lies in the way is not moved";
    EXPECT_EQ(reported(folder / ".octoskin-ready"), ".journal=octoskin-file-set/1\nput can.log\n");
}

TEST(FileSetTest, follows_no_journal_out_of_its_folder) {
    for (const char* line :
         {"put ../escaped", "drop /etc/passwd", "put can.log/../../escaped", "burn can.log", "put", "",
          "put notes", "drop .bashrc", "put depth/../can.log", "put depth/.x.oni", "drop depth/notes",
          "put maps/../can.log", "put ./can.log", "drop recording/can.log"}) {
        const ScratchFolder folder;
        fs::create_directories(folder / "in/.octoskin-ready");
        folder.write("escaped", "mine");
        folder.write("in/.octoskin-ready/.journal",
                     std::string("octoskin-file-set/1\nput can.log\n") + line + "\n");
        folder.write("in/.octoskin-ready/can.log", "new");
        const auto settled = settle(folder / "in");
        ASSERT_FALSE(settled) << line;
        EXPECT_EQ(settled.error().error.code, ErrorCode::foreign_format) << line;
        EXPECT_EQ(settled.error().error.file, folder / "in/.octoskin-ready/.journal");
        EXPECT_THAT(settled.error().error.remedy, HasSubstr((folder / "in/.octoskin-ready").string()));
        EXPECT_EQ(ScratchFolder::read(folder / "escaped"), "mine");
        EXPECT_FALSE(fs::exists(folder / "in/can.log"));
    }
}

/// Folders of others, unpacked by a program that makes the links that are in an archive.
TEST(FileSetTest, follows_no_link_out_of_its_folder) {
    struct Trap {
        const char* link;  ///< in the folder, to the victim's folder or file
        const char* target;
        const char* line;
    };
    const Trap traps[] = {{"in/maps", "../victim", "put maps/fused.ot"},
                          {"in/maps", "../victim", "drop maps/fused.ot"},
                          {"in/can.log", "../victim/fused.ot", "drop can.log"},
                          {"in/depth", "../victim", "put depth/left.oni"},
                          {"in/depth", "../victim", "drop depth/left.oni"},
                          {"in/.octoskin-ready/depth", "../../victim", "put depth/left.oni"},
                          {"in/.octoskin-ready/maps", "../../victim", "put maps/fused.ot"},
                          {"in/.octoskin-ready/.before", "../../victim", "drop robot.urdf"}};
    for (const Trap& trap : traps) {
        const ScratchFolder folder;
        for (const char* made : {"victim", "in/.octoskin-ready"}) fs::create_directories(folder / made);
        folder.write("victim/fused.ot", "mine");
        folder.write("in/robot.urdf", "old");
        folder.write("in/.octoskin-ready/meta.yaml", "new");
        fs::create_symlink(trap.target, folder / trap.link);
        folder.write("in/.octoskin-ready/.journal",
                     std::string("octoskin-file-set/1\n") + trap.line + "\nput meta.yaml\n");
        const auto settled = settle(folder / "in");
        ASSERT_FALSE(settled) << trap.line;
        EXPECT_EQ(settled.error().error.code, ErrorCode::link);
        EXPECT_EQ(settled.error().error.file, folder / trap.link);
        EXPECT_EQ(reported(folder / "victim"), "fused.ot=mine") << trap.line;
        EXPECT_EQ(ScratchFolder::read(folder / "in/robot.urdf"), "old") << trap.line;
        EXPECT_FALSE(fs::exists(folder / "in/meta.yaml")) << trap.line;
    }
}

TEST(FileSetTest, the_hidden_folders_themselves_are_no_links) {
    for (const char* name : {FileSet::kDraftFolder, FileSet::kReadyFolder}) {
        const ScratchFolder folder;
        for (const char* made : {"victim", "in"}) fs::create_directories(folder / made);
        folder.write("victim/can.log", "mine");
        folder.write("victim/.journal", "octoskin-file-set/1\nput can.log\n");
        fs::create_directory_symlink("../victim", folder / "in" / name);
        const auto begun = FileSet::begin(folder / "in");
        EXPECT_EQ(begun.has_value(), name == std::string(FileSet::kDraftFolder)) << "a draft is cleared away";
        EXPECT_EQ(reported(folder / "victim"), ".journal=octoskin-file-set/1\nput can.log\n can.log=mine");
    }
}

TEST(FileSetTest, killed_at_any_instant_it_is_the_old_set_or_the_new_one) {
    std::mt19937 random(1);
    for (int i = 0; i < 30; ++i) {
        const ScratchFolder folder;
        fill_old(folder.path());
        const pid_t child = ::fork();
        if (child == 0) {
            static_cast<void>(replace_by_new(folder.path()));
            ::_exit(0);
        }
        ::usleep(static_cast<useconds_t>(random() % 3000));
        ::kill(child, SIGKILL);
        ASSERT_EQ(::waitpid(child, nullptr, 0), child);
        { ASSERT_TRUE(FileSet::begin(folder.path())); }
        fs::remove(folder / kDaemonsLock);  // a killed one can leave it
        const std::string now = reported(folder.path());
        EXPECT_TRUE(now == kOld || now == kNew) << now;
    }
}

TEST(FileLockTest, readers_share_and_a_writer_is_alone) {
    const ScratchFolder folder;
    const auto file = folder.write("meta.yaml", "x");
    using Kind = FileLock::Kind;
    {
        const auto one = FileLock::take(file, Kind::shared);
        ASSERT_TRUE(one);
        EXPECT_TRUE(FileLock::take(file, Kind::shared));
        EXPECT_FALSE(FileLock::take(file, Kind::exclusive));
    }
    const auto writer = FileLock::take(file, Kind::exclusive);
    ASSERT_TRUE(writer);
    EXPECT_FALSE(FileLock::take(file, Kind::shared));
    // What cannot be opened is for others to complain of.
    EXPECT_TRUE(FileLock::take(folder / "absent", Kind::exclusive));
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    EXPECT_TRUE(FileLock::take(folder / "pipe", Kind::exclusive));
}

TEST(FileSetTest, leaves_nothing_unfinished_of_a_process_that_is_told_to_end) {
    const ScratchFolder parent;
    const fs::path folder = parent / "new";
    {
        auto set = FileSet::begin(folder);
        ASSERT_TRUE(set);
        write(set->draft().shown() / "can.log", "new");
        const auto within = FileSet::begin(folder / "recording");
        ASSERT_TRUE(within);
        EXPECT_TRUE(remove_unfinished().is_any);
        EXPECT_FALSE(fs::exists(folder));
    }
    fill_old(folder.parent_path());
    auto set = FileSet::begin(parent.path());
    ASSERT_TRUE(set);
    for (const fs::path& file : kFiles) write(set->draft().shown() / file, "new");
    ASSERT_TRUE(set->commit(kFiles, {"robot.urdf"}));
    EXPECT_FALSE(remove_unfinished().is_any) << "it is whole";
    EXPECT_EQ(reported(parent.path()), kNew);
}

/// Everything below the folder: "can.log=new depth/left.oni=new".
std::string all_in(const fs::path& folder) {
    std::vector<std::string> entries;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        const std::string name = entry.path().lexically_relative(folder).string();
        if (entry.is_regular_file()) entries.push_back(name + "=" + ScratchFolder::read(entry.path()));
        if (entry.is_directory() && fs::is_empty(entry.path())) entries.push_back(name);
    }
    std::sort(entries.begin(), entries.end());
    std::string text;
    for (const std::string& entry : entries) text.append(text.empty() ? "" : " ").append(entry);
    return text;
}

const std::vector<fs::path> kOfTwoCameras = {"can.log", "depth/left.oni", "depth/left.epoch.yaml",
                                             "depth/right.oni", "meta.yaml"};
constexpr const char* kNewOfTwoCameras =
    "can.log=new depth/left.epoch.yaml=new depth/left.oni=new depth/right.oni=new meta.yaml=new";

/// A recording of the cameras `left` and `front`.
void fill_old_of_cameras(const fs::path& folder) {
    fs::create_directory(folder / "depth");
    for (const char* name : {"can.log", "depth/left.oni", "depth/front.oni", "meta.yaml"})
        write(folder / name, "old");
}

Status<AppError> replace_by(const fs::path& folder, const std::vector<fs::path>& files,
                            const std::vector<fs::path>& retired) {
    auto set = FileSet::begin(folder);
    if (!set) return unexpected(set.error());
    for (const fs::path& file : files) {
        fs::create_directories((set->draft().shown() / file).parent_path());
        write(set->draft().shown() / file, "new");
    }
    return set->commit(files, retired);
}

TEST(FileSetOfCameras, comes_with_its_folder_and_goes_with_it) {
    const ScratchFolder folder;
    fill_old(folder.path());
    const auto made = replace_by(folder.path(), kOfTwoCameras, {"robot.urdf"});
    ASSERT_TRUE(made) << made.error().message();
    EXPECT_EQ(all_in(folder.path()), kNewOfTwoCameras);
    const auto gone = replace_by(folder.path(), {"can.log", "meta.yaml"},
                                 {"depth/left.oni", "depth/left.epoch.yaml", "depth/right.oni"});
    ASSERT_TRUE(gone) << gone.error().message();
    EXPECT_EQ(all_in(folder.path()), "can.log=new meta.yaml=new") << "without an empty folder";
}

TEST(FileSetOfCameras, leaves_what_others_have_in_their_folder) {
    const ScratchFolder folder;
    fill_old_of_cameras(folder.path());
    write(folder / "depth/notes.txt", "mine");
    ASSERT_TRUE(replace_by(folder.path(), {"can.log", "meta.yaml"}, {"depth/left.oni", "depth/front.oni"}));
    EXPECT_EQ(all_in(folder.path()), "can.log=new depth/notes.txt=mine meta.yaml=new");
}

TEST(FileSetOfCameras, what_was_killed_after_any_step_is_brought_to_its_end_by_the_next_one) {
    for (std::size_t moved = 0; moved <= kOfTwoCameras.size(); ++moved) {
        const ScratchFolder folder;
        fill_old_of_cameras(folder.path());
        const fs::path ready = folder / ".octoskin-ready";
        fs::create_directories(ready / "depth");
        std::string journal = "octoskin-file-set/1\ndrop depth/front.oni\n";
        for (std::size_t i = 0; i < kOfTwoCameras.size(); ++i) {
            journal += "put " + kOfTwoCameras[i].string() + "\n";
            write((i < moved ? folder.path() : ready) / kOfTwoCameras[i], "new");
        }
        write(ready / ".journal", journal);
        const auto settled = settle(folder.path());
        ASSERT_TRUE(settled) << moved << settled.error().message();
        EXPECT_TRUE(*settled) << moved;
        EXPECT_EQ(all_in(folder.path()), kNewOfTwoCameras) << moved;
    }
}

TEST(FileSetOfCameras, killed_at_any_instant_it_is_the_old_set_or_the_new_one) {
    std::mt19937 random(2);
    for (int i = 0; i < 30; ++i) {
        const ScratchFolder folder;
        fill_old_of_cameras(folder.path());
        const std::string old = all_in(folder.path());
        const pid_t child = ::fork();
        if (child == 0) {
            static_cast<void>(replace_by(folder.path(), kOfTwoCameras, {"depth/front.oni"}));
            ::_exit(0);
        }
        ::usleep(static_cast<useconds_t>(random() % 3000));
        ::kill(child, SIGKILL);
        ASSERT_EQ(::waitpid(child, nullptr, 0), child);
        { ASSERT_TRUE(FileSet::begin(folder.path())); }
        fs::remove(folder / kDaemonsLock);  // a killed one can leave it
        const std::string now = all_in(folder.path());
        EXPECT_TRUE(now == old || now == kNewOfTwoCameras) << now;
    }
}

TEST(FileSetOfCameras, an_error_while_it_moves_takes_the_folder_back_too) {
    const ScratchFolder folder;
    fill_old(folder.path());
    const fs::path ready = folder / ".octoskin-ready";
    fs::create_directories(ready / "depth");
    for (const char* name : {"depth/left.oni", "meta.yaml"}) write(ready / name, "new");
    // Of a set that never had its can.log: it is in the way as a folder.
    write(ready / ".journal", "octoskin-file-set/1\nput depth/left.oni\nput can.log\nput meta.yaml\n");
    fs::remove(folder / "can.log");
    fs::create_directory(folder / "can.log");
    ASSERT_FALSE(settle(folder.path()));
    EXPECT_FALSE(fs::exists(folder / "depth"));
    EXPECT_EQ(ScratchFolder::read(ready / "depth/left.oni"), "new");
}

TEST(FileSetOfCameras, refuses_a_file_or_a_link_in_place_of_their_folder) {
    for (const bool is_link : {false, true}) {
        const ScratchFolder parent;
        const fs::path folder = parent / "in";
        for (const char* made : {"in", "victim"}) fs::create_directory(parent / made);
        write(parent / "victim/left.oni", "mine");
        fill_old(folder);
        is_link ? fs::create_directory_symlink("../victim", folder / "depth")
                : write(folder / "depth", "mine");
        const auto refused = replace_by(folder, kOfTwoCameras, {});
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().exit, ExitCode::cannot_create);
        EXPECT_EQ(refused.error().error.file, folder / "depth");
        EXPECT_EQ(refused.error().error.code, is_link ? ErrorCode::link : ErrorCode::wrong_kind_of_file);
        EXPECT_EQ(ScratchFolder::read(parent / "victim/left.oni"), "mine");
        EXPECT_EQ(ScratchFolder::read(folder / "can.log"), "old");
    }
}

TEST(FileSetOfCameras, of_more_files_than_a_journal_names_is_refused) {
    const ScratchFolder folder;
    fill_old(folder.path());
    std::vector<fs::path> retired;
    for (int i = 0; i < 400; ++i)
        retired.emplace_back("depth/camera-with_a_long-name_" + std::to_string(i) + ".epoch.yaml");
    const auto refused = replace_by(folder.path(), kFiles, retired);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().error.code, ErrorCode::limit_exceeded);
    EXPECT_EQ(refused.error().error.file, folder.path());
    EXPECT_EQ(reported(folder.path()), kOld);
    retired.resize(50);  // of more cameras than two rigs have
    EXPECT_TRUE(replace_by(folder.path(), kFiles, retired));
}

TEST(FileSetOfCameras, knows_their_files_by_name) {
    const std::string longest(32, 'x');
    for (const std::string& camera :
         {std::string("left"), std::string("_"), std::string("A-z_0.9"), longest}) {
        EXPECT_EQ(camera_of_file(camera + ".oni"), camera);
        EXPECT_EQ(camera_of_file(camera + ".epoch.yaml"), camera);
        EXPECT_TRUE(is_file_of_set("depth/" + camera + ".oni"));
        EXPECT_TRUE(is_file_of_set("depth/" + camera + ".epoch.yaml"));
        EXPECT_FALSE(is_file_of_set("maps/" + camera + ".oni"));
        EXPECT_FALSE(is_file_of_set(camera + ".oni"));
    }
    for (const std::string& camera :
         {std::string(), std::string(".left"), std::string("-left"), std::string("a/b"), std::string("../x"),
          std::string("le ft"), std::string("l\xC3\xA4"), std::string("x..y"), std::string("x\n"),
          longest + "x"}) {
        EXPECT_EQ(camera_of_file(camera + ".oni"), "") << camera;
        EXPECT_FALSE(is_file_of_set("depth/" + camera + ".oni")) << camera;
        EXPECT_FALSE(is_file_of_set("depth/" + camera + ".epoch.yaml")) << camera;
    }
    for (const char* name :
         {"depth/left", "depth/left.ONI", "depth/left.yaml", "depth/", "depth", "/depth/left.oni",
          "depth//left.oni", "./depth/left.oni", "depth/depth/left.oni", "depth/left.oni/"})
        EXPECT_FALSE(is_file_of_set(name)) << name;
}

TEST(SceneMesh, is_known_by_its_name) {
    for (const char* name : {"mesh_01.stl", "mesh_99.obj", "mesh_00.x", "mesh_12.abcdefgh"})
        EXPECT_TRUE(is_scene_mesh(name)) << name;
    for (const char* name :
         {"", "mesh_", "mesh_01", "mesh_01.", "mesh_1.stl", "mesh_001.stl", "mesh_01.STL", "mesh_01.a/b",
          "mesh_01..", "mesh_01.abcdefghi", "xmesh_01.stl", "mesh_01.stl\n", "maps/mesh_01.stl"})
        EXPECT_FALSE(is_scene_mesh(name)) << name;
}

}  // namespace
}  // namespace octoskin
