#include "host/lab/study/results_folder.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

using testing_support::ScratchFolder;

OpenFolder open(const ScratchFolder& folder) {
    return OpenFolder::open(folder.path(), FolderAccess::write).value();
}

/// The name in the way, in quotes, or the message of another error; empty: the folder may be used.
std::string refusal(const ScratchFolder& folder) {
    const auto checked = check_results_folder(open(folder));
    if (checked) return "";
    EXPECT_EQ(checked.error().exit, ExitCode::cannot_create);
    const Error& error = checked.error().error;
    if (error.value.empty()) return error.message();
    EXPECT_EQ(error.code, ErrorCode::already_exists);
    EXPECT_EQ(error.file, folder.path());
    return error.value;
}

constexpr const char* kNotes = ".octoskin-experiment";

/// Results of an experiment, as far as they are looked at here.
void make_results(const ScratchFolder& folder) {
    std::filesystem::create_directory(folder / "recording");
    for (const char* name : {"can.log", "rig.yaml", "robot.urdf"})
        folder.write(std::string("recording/") + name, name);
    folder.write("recording/meta.yaml", "schema: octoskin-recording/1\nsource: simulation\n");
    folder.write("metrics.json", "{}");
    folder.write("report.html", "report");
    for (const char* name : {"recording", "metrics.json", "report.html"})
        ASSERT_TRUE(note_result(open(folder), name));
    ASSERT_EQ(refusal(folder), "");
}

TEST(ResultsFolder, may_hold_nothing_or_what_octoskin_hides) {
    const ScratchFolder folder;
    EXPECT_TRUE(check_results_folder(open(folder)));
    std::filesystem::create_directory(folder / ".octoskin-part");
    EXPECT_TRUE(check_results_folder(open(folder)));
    folder.write("a", "");
    const auto refused = check_results_folder(open(folder));
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().exit, ExitCode::cannot_create);
    EXPECT_EQ(refused.error().error.file, folder.path());
    EXPECT_EQ(refused.error().error.value, "'a'");
}

TEST(ResultsFolder, is_ours_as_long_as_each_file_is_as_it_was_noted) {
    const ScratchFolder folder;
    make_results(folder);
    for (const std::string name : {"report.html", "metrics.json", "recording/can.log", "recording/rig.yaml",
                                   "recording/robot.urdf", "recording/meta.yaml"}) {
        const std::string ours = ScratchFolder::read(folder / name);
        folder.write(name, ours + "edited");
        EXPECT_EQ(refusal(folder), "'" + name + "'");
        folder.write(name, ours);
        EXPECT_EQ(refusal(folder), "") << name;
    }
    folder.write("recording/order.log", "of a daemon");
    EXPECT_EQ(refusal(folder), "'recording/order.log'");
    std::filesystem::remove(folder / "recording/order.log");
    folder.write("maps.yaml", "never noted");
    EXPECT_EQ(refusal(folder), "'maps.yaml'");
}

TEST(ResultsFolder, is_nobodys_without_its_notes_or_with_others_in_their_place) {
    const ScratchFolder folder;
    make_results(folder);
    const std::string notes = ScratchFolder::read(folder / kNotes);
    std::filesystem::remove(folder / kNotes);
    EXPECT_EQ(refusal(folder), "'metrics.json'");
    // What says of itself that octoskin made it says nothing of what became of it.
    folder.write("metrics.json", "{\"unknown_space\": {}, \"program\": \"octoskin 0.1.0\"}");
    EXPECT_EQ(refusal(folder), "'metrics.json'");
    folder.write("metrics.json", "{}");
    for (const std::string& garbage :
         {std::string("garbage"), std::string(), notes + "0x00000000 ../x\n", notes + notes,
          notes.substr(notes.find('\n') + 1), std::string(std::size_t{1} << 20U, 'x')}) {
        folder.write(kNotes, garbage);
        EXPECT_EQ(refusal(folder), "'.octoskin-experiment'") << garbage.substr(0, 80);
    }
    std::filesystem::remove(folder / kNotes);
    folder.write("notes", notes);
    std::filesystem::create_symlink("notes", folder / kNotes);
    EXPECT_EQ(refusal(folder), "'.octoskin-experiment'");
    std::filesystem::remove(folder / kNotes);
    std::filesystem::create_directory(folder / kNotes);
    EXPECT_EQ(refusal(folder), "'.octoskin-experiment'");
}

TEST(ResultsFolder, has_nothing_else_in_the_place_of_what_is_written) {
    for (const std::string place :
         {".octoskin-experiment", "metrics.json", "report.html", ".report.html.octoskin-part",
          ".metrics.json.octoskin-part", "..octoskin-experiment.octoskin-part", "maps.yaml", "fused.ot",
          "depth.ply", "recording/can.log", "recording/depth.oni", "recording/depth.epoch.yaml",
          "recording/meta.yaml", "recording/maps/fused.bt"}) {
        for (const bool is_folder : {true, false}) {
            // What was removed so that a file of another kind lies there is lost already.
            const ScratchFolder folder;
            make_results(folder);
            std::filesystem::remove_all(folder / place);
            std::filesystem::create_directories((folder / place).parent_path());
            if (is_folder) {
                std::filesystem::create_directory(folder / place);
            } else {
                ASSERT_EQ(::mkfifo((folder / place).c_str(), 0600), 0);
            }
            const bool is_cleared_away = place.ends_with("-part") && !is_folder;
            EXPECT_EQ(refusal(folder).empty(), is_cleared_away) << place << is_folder;
        }
    }
    const ScratchFolder folder;
    std::filesystem::create_directory_symlink("elsewhere", folder / "recording");
    EXPECT_NE(refusal(folder), "");
}

}  // namespace
}  // namespace octoskin
