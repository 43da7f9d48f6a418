#include "host/apps/study/results_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

using testing::HasSubstr;
using testing_support::ScratchFolder;

OpenFolder open(const ScratchFolder& folder) {
    return OpenFolder::open(folder.path(), FolderAccess::write).value();
}

constexpr const char* kMetricsWithoutNotes =
    "{\"run\": {\"unknown_space\": {}, \"provenance\": {\"program\": \"octoskin 0.1.0 (commit abc)\"}}}";

TEST(ResultsFolder, may_hold_nothing_or_what_octoskin_hides) {
    const ScratchFolder folder;
    EXPECT_TRUE(check_results_folder(open(folder)));
    std::filesystem::create_directory(folder / ".octoskin-part");
    EXPECT_TRUE(check_results_folder(open(folder)));
    folder.write("a", "");
    const auto refused = check_results_folder(open(folder));
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ExitCode::cannot_create);
    EXPECT_THAT(refused.error().message, HasSubstr(folder.path().string() + ": has a a that no"));
}

TEST(ResultsFolder, is_ours_as_long_as_its_bytes_are_those_noted) {
    const ScratchFolder folder;
    folder.write("report.html", "report");
    ASSERT_TRUE(note_result(open(folder), "report.html"));
    EXPECT_TRUE(check_results_folder(open(folder)));
    folder.write("report.html", "my report");
    EXPECT_FALSE(check_results_folder(open(folder)));
    folder.write("report.html", "report");
    folder.write("metrics.json", "never noted");
    EXPECT_FALSE(check_results_folder(open(folder)));
}

TEST(ResultsFolder,
     of_an_experiment_that_left_no_notes_is_known_by_its_figures_and_stays_known_when_interrupted) {
    const ScratchFolder folder;
    folder.write("report.html", "report");
    EXPECT_FALSE(check_results_folder(open(folder)));
    folder.write("metrics.json", kMetricsWithoutNotes);
    EXPECT_TRUE(check_results_folder(open(folder)));
    ASSERT_TRUE(note_result(open(folder), "metrics.json"));
    EXPECT_TRUE(check_results_folder(open(folder))) << "the report of before is noted with it";
}

}  // namespace
}  // namespace octoskin
