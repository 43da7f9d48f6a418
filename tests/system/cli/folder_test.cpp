// Folders of others: whatever lies in a recording, nothing outside of it is written, made, removed or
// touched.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <regex>
#include <set>
#include <sstream>
#include <vector>

#include "host/apps/daemon/map_saver.hpp"
#include "tests/system/cli/failure.hpp"
#include "tests/system/cli/folder_states.hpp"
#include "tests/system/cli/folder_traps.hpp"
#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

namespace fs = std::filesystem;
using testing::AnyOf;
using testing::Eq;
using testing::HasSubstr;
using testing_support::code_is;
using testing_support::remedy_is;
using testing_support::what_is;

using Names = std::vector<std::string>;

/// What an octoskin writes, whatever the folder.
const Names kFileNames = {"can.log",    "depth.oni",      "depth.epoch.yaml", "rig.yaml",
                          "robot.urdf", "meta.yaml",      "order.log",        "mapping.yaml",
                          "first.ot",   "first.snapshot", "last.ot",          "lock",
                          "fused.ot",   "fused.bt",       "fused.ply",        "maps.yaml",
                          ".journal",   "report.html",    "metrics.json",     ".fused.ot.octoskin-part"};

class FolderWalk : public ProgramTest {
  protected:
    FolderWalk() {
        fs::create_directory(directory_ / "outside");
        for (const char* within : {"victim", "victim/maps", "victim/recording"}) {
            fs::create_directories(directory_ / "outside" / within);
            for (const std::string& name : kFileNames)
                write(directory_ / "outside" / within / name, "the victim's " + name);
        }
        write(directory_ / "outside/victim/.journal", "octoskin-file-set/1\nput can.log\n");
    }

    /// A recording of ranges alone, so short that a replay takes no time.
    void make_template() {
        record_short("made");
        fs::create_directory(directory_ / "template");
        for (const char* name : {"rig.yaml", "robot.urdf", "meta.yaml"})
            fs::copy_file(directory_ / "made" / name, directory_ / "template" / name);
        std::istringstream lines(content(directory_ / "made/can.log"));
        std::string log;
        std::string line;
        for (int i = 0; i < 1500 && std::getline(lines, line); ++i) log += line + "\n";
        write(directory_ / "template/can.log", log);
        fs::remove_all(directory_ / "made");
    }

    /// A recording with a trap in one place; false: such a trap cannot be laid.
    bool lay_in_recording(Trap trap, const std::string& place) {
        fs::remove_all(directory_ / "rec");
        fs::copy(directory_ / "template", directory_ / "rec", fs::copy_options::recursive);
        const fs::path victim = directory_ / "outside/victim";
        return lay(trap, directory_ / "rec" / place, victim / name_like(place), victim);
    }

    /// The victim's file of this name, or its can.log for a place that no file has.
    static std::string name_like(const std::string& place) {
        const std::string name = fs::path(place).filename().string();
        return std::ranges::find(kFileNames, name) == kFileNames.end() ? "can.log" : name;
    }

    [[nodiscard]] std::vector<std::string> commands() const {
        const std::string rec = path("rec");
        return {"replay " + rec, "explain 0 0 1 --recording " + rec, "evaluate " + rec,
                "simulate " + rec + " --force --rig " + source("tests/data/short/rig.yaml") + " --scenario " +
                    source("tests/data/short/scenario.yaml"),
                "repair " + rec};
    }

    /// Runs it, and looks at the world outside, of which the recording's own names are no part.
    Failure expect_harmless(const std::string& command, const std::string& case_name) const {
        const auto before = states_in(directory_ / "outside");
        Failure said = failure_in(run("timeout 20 " + typed_for_error(command) + " < /dev/null"));
        EXPECT_EQ(states_in(directory_ / "outside"), before) << case_name << ": " << command << said.output;
        EXPECT_NE(said.exit_code, 124) << case_name << " hangs: " << command;
        EXPECT_THAT(said.exit_code,
                    AnyOf(Eq(0), Eq(1), Eq(2), Eq(64), Eq(65), Eq(66), Eq(73), Eq(77), Eq(78)))
            << case_name << ": " << command << ": " << said.output;
        return said;
    }

    /// That the recording contains files of a killed run, and what completes the move.
    [[nodiscard]] auto is_half_moved() const {
        return fails_with(66, code_is(ErrorCode::unfinished_move), path_is(path("rec")),
                          remedy_is(HasSubstr("octoskin repair " + path("rec"))));
    }

    /// A recording with the journal of a killed octoskin that is none.
    void lay_journal(const std::string& line) {
        fs::remove_all(directory_ / "rec");
        fs::copy(directory_ / "template", directory_ / "rec", fs::copy_options::recursive);
        fs::create_directories(directory_ / "rec/.octoskin-ready/link");
        fs::create_directory_symlink("../outside/victim", directory_ / "rec/link");
        fs::create_directory_symlink("../outside/victim", directory_ / "rec/maps");
        for (const char* name : {"link/can.log", "can.log", "maps.yaml"})
            write(directory_ / "rec/.octoskin-ready" / name, "the attacker's");
        write(directory_ / "rec/.octoskin-ready/.journal",
              "octoskin-file-set/1\n" + line + "\nput maps.yaml\n");
    }
};

TEST_F(FolderWalk, no_journal_moves_or_removes_what_is_outside) {
    make_template();
    for (const char* line :
         {"put link/can.log", "drop link/can.log", "drop maps/fused.ot", "put maps/fused.ot",
          "put ../outside/victim/can.log", "drop ../outside/victim/can.log", "drop /etc/hostname"}) {
        for (const std::string& command : commands()) {
            lay_journal(line);
            const auto before = states_in(directory_ / "rec");
            const Failure said = expect_harmless(command, line);
            EXPECT_NE(said.exit_code, 0) << line << command << said.output;
            const bool only_reads = command.starts_with("replay") || command.starts_with("explain") ||
                                    command.starts_with("evaluate");
            if (!only_reads) continue;
            EXPECT_EQ(states_in(directory_ / "rec"), before) << command << " wrote, and was to read";
            EXPECT_THAT(said, is_half_moved()) << command;
        }
    }
}

TEST_F(FolderWalk, what_reads_writes_nothing_and_replay_only_its_maps) {
    make_template();
    fs::copy(directory_ / "template", directory_ / "rec", fs::copy_options::recursive);
    const auto before = states_in(directory_ / "rec");
    for (const std::string& command :
         {"explain 0 0 1 --recording " + path("rec"), "evaluate " + path("rec"),
          "black-box " + path("rec/can.log"), "replay " + path("rec") + " --out " + path("elsewhere")}) {
        expect_harmless(command, "whole");
        EXPECT_EQ(states_in(directory_ / "rec"), before) << command;
    }
    const Failure replayed = expect_harmless("replay " + path("rec"), "whole");
    ASSERT_EQ(replayed.exit_code, 0) << replayed.output;
    auto after = states_in(directory_ / "rec");
    EXPECT_TRUE(after.contains("maps/maps.yaml"));
    std::erase_if(after, [](const auto& entry) { return entry.first.starts_with("maps"); });
    after["."] = before.at(".");  // it has one folder more
    EXPECT_EQ(after, before);
}

TEST_F(FolderWalk, one_that_was_left_half_moved_is_repaired_on_demand_or_by_what_writes_there) {
    make_template();
    for (const std::string& remedy :
         {"repair " + path("rec"), "simulate " + path("rec") + " --force --rig " +
                                       source("tests/data/short/rig.yaml") + " --scenario " +
                                       source("tests/data/short/scenario.yaml")}) {
        fs::remove_all(directory_ / "rec");
        fs::copy(directory_ / "template", directory_ / "rec", fs::copy_options::recursive);
        fs::create_directory(directory_ / "rec/.octoskin-ready");
        fs::rename(directory_ / "rec/meta.yaml", directory_ / "rec/.octoskin-ready/meta.yaml");
        write(directory_ / "rec/.octoskin-ready/.journal",
              "octoskin-file-set/1\nput can.log\nput meta.yaml\n");
        EXPECT_THAT(expect_harmless("replay " + path("rec"), "half moved"), is_half_moved());
        EXPECT_EQ(expect_harmless(remedy, "half moved").exit_code, 0) << remedy;
        EXPECT_FALSE(fs::exists(directory_ / "rec/.octoskin-ready"));
        EXPECT_EQ(expect_harmless("replay " + path("rec"), "repaired").exit_code, 0) << remedy;
    }
    const Said again = octoskin("repair " + path("rec"));
    EXPECT_EQ(again.exit_code, 0);
    EXPECT_THAT(again.output, HasSubstr("nothing is half moved"));
    EXPECT_THAT(failure_of("repair " + path("absent")),
                fails_with(66, code_is(ErrorCode::not_found), path_is(path("absent"))));
}

TEST_F(FolderWalk, drafts_of_a_daemon_that_keeps_its_map_there_stay) {
    const fs::path maps = directory_ / "rec/maps";
    fs::create_directories(maps);
    write(maps / ".fused.ot.octoskin-part", "half saved");
    write(maps / "lock", "1");
    const int lock = ::open((maps / "lock").c_str(), O_RDONLY | O_CLOEXEC);
    ASSERT_EQ(::flock(lock, LOCK_EX | LOCK_NB), 0);
    EXPECT_EQ(octoskin("repair " + maps.string()).exit_code, 0);
    EXPECT_TRUE(fs::exists(maps / ".fused.ot.octoskin-part"));
    ::close(lock);
    EXPECT_EQ(octoskin("repair " + maps.string()).exit_code, 0);
    EXPECT_FALSE(fs::exists(maps / ".fused.ot.octoskin-part"));
}

// Killed behind the rename of fused.ot: without fused.snapshot all of the map would be stale.
TEST_F(FolderWalk, a_killed_save_of_the_map_is_finished_by_a_repair) {
    const fs::path maps = directory_ / "maps";
    const fs::path draft = maps / ".fused.snapshot.octoskin-part";
    fs::create_directories(maps);
    FusedMap map(MapConfig{});
    ASSERT_TRUE(map.set_cube({.lowest = {64, 0, 0}, .height = 5}, 1.0F));
    ASSERT_EQ(MapSaver::write_map(map, {}, NamedFolder(maps)), "");
    const std::string snapshot = content(maps / "fused.snapshot");
    fs::rename(maps / "fused.snapshot", draft);
    EXPECT_EQ(octoskin("repair " + maps.string()).exit_code, 0);
    EXPECT_FALSE(fs::exists(draft));
    EXPECT_EQ(content(maps / "fused.snapshot"), snapshot);

    fs::rename(maps / "fused.snapshot", draft);
    write(maps / "fused.ot", "another map");
    EXPECT_EQ(octoskin("repair " + maps.string()).exit_code, 0);
    EXPECT_FALSE(fs::exists(draft) || fs::exists(maps / "fused.snapshot"));
}

TEST_F(FolderWalk, drafts_of_killed_runs_go_with_a_repair) {
    make_template();
    ASSERT_TRUE(lay_in_recording(Trap::folder, ".octoskin-part"));
    const fs::path rec = directory_ / "rec";
    fs::create_directories(rec / "maps");
    for (const char* name : {".octoskin-part/can.log", ".scores.json.octoskin-part",
                             "maps/.fused.ot.octoskin-part", "mine.octoskin-part", ".mine"})
        write(rec / name, "half");
    EXPECT_EQ(expect_harmless("repair " + path("rec"), "drafts").exit_code, 0);
    for (const char* gone : {".octoskin-part", ".scores.json.octoskin-part", "maps/.fused.ot.octoskin-part"})
        EXPECT_FALSE(fs::exists(rec / gone)) << gone;
    for (const char* kept : {"can.log", "meta.yaml", "mine.octoskin-part", ".mine"})
        EXPECT_TRUE(fs::exists(rec / kept)) << kept;
}

TEST_F(FolderWalk, drafts_that_cannot_be_removed_are_an_error_that_names_them) {
    fs::path deep = directory_ / "rec/.octoskin-part";
    for (int i = 0; i < 40; ++i) deep /= "a";  // deeper than what octoskin removes
    fs::create_directories(deep);
    const Failure failure = failure_of("repair " + path("rec"));
    EXPECT_THAT(failure, fails_with(73, code_is(ErrorCode::system_error), path_is(path("rec")),
                                    remedy_is(HasSubstr("remove"))));
    EXPECT_THAT(failure.output, HasSubstr(".octoskin-part/a"));
}

TEST_F(FolderWalk, a_link_in_the_path_that_was_typed_is_followed) {
    make_template();
    fs::create_directory_symlink("template", directory_ / "rec");
    EXPECT_EQ(expect_harmless("replay " + path("rec"), "typed link").exit_code, 0);
    EXPECT_TRUE(fs::exists(directory_ / "template/maps/fused.ot"));
}

/// Ends a daemon after a second, so that it saves its map.
TEST_F(FolderWalk, a_daemons_maps_folder_leads_nowhere_else) {
    int ends[2] = {-1, -1};
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends), 0);
    const int bus = ::fcntl(ends[1], F_DUPFD, 50);  // inherited
    for (const char* place : {"lock", "fused.ot", "fused.bt", ".fused.ot.octoskin-part"}) {
        for (const Trap trap : {Trap::link_to_file, Trap::hard_link}) {
            fs::create_directories(directory_ / "template");
            ASSERT_TRUE(lay_in_recording(trap, place));
            const auto before = states_in(directory_ / "outside");
            const Said said =
                run("timeout -s TERM 1 " OCTOSKIN_PROGRAM " run --no-camera --rig " +
                    source("tests/data/short/rig.yaml") + " --can fd:" + std::to_string(bus) + " --maps " +
                    path("rec") + " --socket " + path("s") + " --joints " + path("j"));
            EXPECT_EQ(states_in(directory_ / "outside"), before) << place << said.output;
        }
    }
    for (const int end : {ends[0], ends[1], bus}) ::close(end);
}

TEST_F(FolderWalk, writes_only_into_folders_of_the_caller_or_of_root_and_reads_any) {
    if (::geteuid() != 0) GTEST_SKIP() << "needs root, to be other users";
    make_template();
    fs::permissions(directory_, fs::perms::all);
    const std::string as_another = "setpriv --reuid 12345 --regid 12345 --clear-groups ";
    if (run(as_another + OCTOSKIN_PROGRAM " --version").exit_code != 0)
        GTEST_SKIP() << "another user may not run " << OCTOSKIN_PROGRAM;
    ASSERT_TRUE(lay_in_recording(Trap::folder, "maps"));
    for (const char* open : {"rec", "rec/maps"}) fs::permissions(directory_ / open, fs::perms::all);
    const auto own = [this](const char* name, uid_t user) {
        ASSERT_EQ(::lchown(path(name).c_str(), user, user), 0);
    };
    const auto said_of = [&](const std::string& arguments) {
        return failure_in(run(as_another + typed_for_error(arguments)));
    };
    own("rec", 12'346);
    EXPECT_THAT(said_of("replay " + path("rec")),
                fails_with(73, code_is(ErrorCode::foreign_owner), path_is(path("rec")),
                           what_is(HasSubstr("uid 12346")), remedy_is(HasSubstr("another folder"))));
    EXPECT_EQ(said_of("replay " + path("rec") + " --out " + path("own")).exit_code, 0) << "reads any";
    own("rec", 12'345);
    own("rec/maps", 12'346);
    EXPECT_THAT(said_of("replay " + path("rec")),
                fails_with(73, code_is(ErrorCode::foreign_owner), path_is(path("rec/maps"))))
        << "the maps' folder is another's";
    own("rec/maps", 0);
    EXPECT_EQ(said_of("replay " + path("rec")).exit_code, 0) << "root's, and open to all";
    own("rec", 12'346);
    own("rec/maps", 12'346);
    EXPECT_EQ(octoskin("replay " + path("rec")).exit_code, 0) << "root writes into any";
}

/// What makes, moves or removes files without host/io/folder, each for a reason that is told there.
TEST(FolderRule, nothing_else_in_the_host_makes_moves_or_removes_files_by_path) {
    const std::regex by_path(
        R"((ofstream( \w+)?\((?!created->)|create_director(y|ies)\(|(fs|filesystem)::(rename|remove|remove_all|copy|copy_file|resize_file)\(|O_CREAT|\b(fopen|mkdtemp|mkstemp|creat)\())");
    std::set<std::string> found;
    for (const char* room : {"host", "hw"}) {
        for (const auto& entry : fs::recursive_directory_iterator(source(room))) {
            const std::string name = entry.path().lexically_relative(source("")).string();
            if (entry.path().extension() != ".cpp" || name.starts_with("host/io/folder/")) continue;
            if (std::regex_search(content(entry.path()), by_path)) found.insert(name);
        }
    }
    EXPECT_THAT(found,
                testing::ElementsAre(
                    "host/apps/daemon/recording_writer.cpp",     // the folder that a user names
                    "host/apps/flashing/flashing.cpp",           // the same
                    "host/apps/octoskin/imported_bag.cpp",       // in an open folder, by its descriptor
                    "host/io/helper_limits/confinement.cpp",     // names what it refuses
                    "host/io/mapfile/atomic_file.cpp",           // in an open folder
                    "host/io/openni2/helpers/oni_recorder.cpp",  // of a file that octoskin has made
                    "host/io/openni2/helpers/oni_write.cpp",     // the same
                    "host/io/tum/depth_png.cpp",                 // to read
                    "host/lab/study/work_folder.cpp",            // in an open folder, by its descriptor
                    "host/lab/world_reader/ordinary_files.cpp",  // its fopen, which opens ordinary files
                    "hw/sim/experiment/emulated_board.cpp"));    // temporary, its own
}

}  // namespace
}  // namespace octoskin
