#include "host/apps/recording/recording_draft.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

using testing::HasSubstr;
using testing_support::ScratchFolder;

constexpr const char* kSimulated = "schema: octoskin-recording/1\nsource: simulation\n";
constexpr const char* kRobot = "schema: octoskin-recording/1\nsource: robot\n";

void write(const FilePlace& file, const std::string& text) {
    std::ofstream(file.shown()) << text;
}

/// Writes a whole recording without a camera into the draft.
void fill(const RecordingDraft& draft, const std::string& log) {
    for (const auto& file : {draft.paths().rig(), draft.paths().robot()}) write(file, "new");
    write(draft.paths().can_log(), log);
    write(draft.paths().meta(), kSimulated);
}

TEST(RecordingDraftTest, appears_whole_when_committed) {
    const ScratchFolder folder;
    const RecordingPaths recording(folder / "a/b");
    auto draft = RecordingDraft::create(recording.directory, false);
    ASSERT_TRUE(draft) << draft.error().message();
    fill(*draft, "log");
    EXPECT_FALSE(std::filesystem::exists(recording.can_log().shown()));
    ASSERT_TRUE(draft->commit());
    EXPECT_EQ(ScratchFolder::read(recording.can_log().shown()), "log");
    EXPECT_TRUE(check_recording(recording));
    EXPECT_FALSE(std::filesystem::exists(draft->paths().directory));
}

TEST(RecordingDraftTest, leaves_nothing_if_it_is_given_up) {
    const ScratchFolder folder;
    {
        auto draft = RecordingDraft::create(folder / "rec", false);
        ASSERT_TRUE(draft);
        fill(*draft, "log");
        const RecordingDraft moved = std::move(*draft);
        EXPECT_TRUE(std::filesystem::exists(folder / "rec"));
    }
    EXPECT_EQ(folder.entries(), 0);
}

TEST(RecordingDraftTest, never_enters_an_occupied_directory_unasked) {
    const ScratchFolder folder;
    folder.write("letter.txt", "mine");
    const auto refused = RecordingDraft::create(folder.path(), false);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().exit, ExitCode::cannot_create);
    EXPECT_EQ(refused.error().error.code, ErrorCode::already_exists);
    EXPECT_EQ(refused.error().error.file, folder.path());
    EXPECT_EQ(refused.error().error.remedy, "give another directory");
    EXPECT_EQ(folder.entries(), 1);
}

TEST(RecordingDraftTest, replaces_a_simulated_recording_and_its_maps_and_nothing_else) {
    const ScratchFolder folder;
    std::filesystem::create_directory(folder / "maps");
    folder.write("meta.yaml", kSimulated);
    for (const char* old : {"can.log", "depth.oni", "depth.epoch.yaml", "maps/fused.ot", "maps/depth.ply"}) {
        folder.write(old, "old");
    }
    folder.write("letter.txt", "mine");
    folder.write("maps/mine.ot", "mine");
    auto draft = RecordingDraft::create(folder.path(), true);
    ASSERT_TRUE(draft) << draft.error().message();
    fill(*draft, "new log");
    EXPECT_EQ(ScratchFolder::read(folder / "can.log"), "old");
    ASSERT_TRUE(draft->commit());
    EXPECT_EQ(ScratchFolder::read(folder / "can.log"), "new log");
    for (const char* stale : {"depth.oni", "depth.epoch.yaml", "maps/fused.ot", "maps/depth.ply"}) {
        EXPECT_FALSE(std::filesystem::exists(folder / stale)) << stale;
    }
    EXPECT_EQ(ScratchFolder::read(folder / "letter.txt"), "mine");
    EXPECT_EQ(ScratchFolder::read(folder / "maps/mine.ot"), "mine");
}

TEST(RecordingDraftTest, keeps_the_former_recording_if_it_is_given_up) {
    const ScratchFolder folder;
    folder.write("meta.yaml", kSimulated);
    folder.write("can.log", "old");
    {
        auto draft = RecordingDraft::create(folder.path(), true);
        ASSERT_TRUE(draft);
        fill(*draft, "new");
    }
    EXPECT_EQ(ScratchFolder::read(folder / "can.log"), "old");
    EXPECT_EQ(folder.entries(), 2);
}

TEST(RecordingDraftTest, never_replaces_what_is_not_known_to_be_simulated) {
    for (const char* meta : {kRobot, "", "schema: octoskin-recording/1\n", "broken: ["}) {
        const ScratchFolder folder;
        folder.write("can.log", "a robot's");
        folder.write("meta.yaml", meta);
        EXPECT_FALSE(RecordingDraft::create(folder.path(), true)) << meta;
        std::filesystem::remove(folder / "meta.yaml");
        const auto refused = RecordingDraft::create(folder.path(), true);
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().error.code, ErrorCode::already_exists);
        EXPECT_EQ(refused.error().error.file, folder.path());
        EXPECT_THAT(refused.error().error.value, HasSubstr("can.log"));
        EXPECT_EQ(ScratchFolder::read(folder / "can.log"), "a robot's");
    }
}

TEST(RecordingDraftTest, clears_away_what_a_killed_one_left) {
    const ScratchFolder folder;
    std::filesystem::create_directory(folder / ".octoskin-part");
    folder.write(".octoskin-part/depth.oni", "half");
    folder.write("lock", "1");
    auto draft = RecordingDraft::create(folder.path(), false);
    ASSERT_TRUE(draft) << draft.error().message();
    fill(*draft, "log");
    ASSERT_TRUE(draft->commit());
    EXPECT_FALSE(std::filesystem::exists(folder / "depth.oni"));
}

TEST(RecordingDraftTest, takes_the_maps_origin_away_with_the_maps) {
    const ScratchFolder folder;
    std::filesystem::create_directory(folder / "maps");
    folder.write("meta.yaml", kSimulated);
    folder.write("maps/fused.ot", "old");
    folder.write("maps/maps.yaml", "old");
    auto draft = RecordingDraft::create(folder.path(), true);
    ASSERT_TRUE(draft) << draft.error().message();
    fill(*draft, "log");
    ASSERT_TRUE(draft->commit());
    EXPECT_FALSE(std::filesystem::exists(folder / "maps"));
}

TEST(RecordingDraftTest, two_at_once_and_one_that_is_read_are_refused) {
    const ScratchFolder folder;
    folder.write("meta.yaml", kSimulated);
    folder.write("can.log", "old");
    {
        const auto first = RecordingDraft::create(folder.path(), true);
        ASSERT_TRUE(first) << first.error().message();
        const auto second = RecordingDraft::create(folder.path(), true);
        ASSERT_FALSE(second);
        EXPECT_EQ(second.error().error.code, ErrorCode::in_use);
        const auto reader = lock_recording(RecordingPaths(folder.path()));
        ASSERT_FALSE(reader);
        EXPECT_EQ(reader.error().exit, ExitCode::bad_data);
        EXPECT_EQ(reader.error().error.code, ErrorCode::in_use);
        EXPECT_EQ(reader.error().error.file, folder.path());
        EXPECT_THAT(reader.error().error.what, HasSubstr("replacing"));
    }
    const auto one = lock_recording(RecordingPaths(folder.path()));
    const auto two = lock_recording(RecordingPaths(folder.path()));
    ASSERT_TRUE(one && two);
    const auto writer = RecordingDraft::create(folder.path(), true);
    ASSERT_FALSE(writer);
    EXPECT_EQ(writer.error().error.code, ErrorCode::in_use);
    EXPECT_EQ(writer.error().error.file, folder.path());
    EXPECT_THAT(writer.error().error.what, HasSubstr("reading"));
    EXPECT_EQ(folder.entries(), 2);
}

TEST(RecordingDraftTest, a_directory_in_the_way_leaves_the_former_recording_whole) {
    const ScratchFolder folder;
    folder.write("meta.yaml", kSimulated);
    folder.write("can.log", "old");
    auto draft = RecordingDraft::create(folder.path(), true);
    ASSERT_TRUE(draft);
    fill(*draft, "new");
    std::filesystem::create_directory(folder / "robot.urdf");
    const auto committed = draft->commit();
    ASSERT_FALSE(committed);
    EXPECT_EQ(committed.error().error.code, ErrorCode::wrong_kind_of_file);
    EXPECT_EQ(committed.error().error.file, folder / "robot.urdf");
    EXPECT_EQ(ScratchFolder::read(folder / "can.log"), "old");
    EXPECT_TRUE(std::filesystem::exists(folder / "meta.yaml"));
}

TEST(RecordingDraftTest, is_not_begun_where_it_could_not_come_into_its_place) {
    for (const std::string place :
         {"can.log", "depth.oni", "depth/left.oni", "rig.yaml", "maps/fused.ot", "maps/maps.yaml"}) {
        const ScratchFolder folder;
        folder.write("meta.yaml", kSimulated);
        std::filesystem::create_directories(folder / place);
        for (const bool is_checked_only : {true, false}) {
            const auto refused =
                is_checked_only ? RecordingDraft::check(folder.path(), true) : [&]() -> Status<AppError> {
                auto draft = RecordingDraft::create(folder.path(), true);
                if (!draft) return unexpected(draft.error());
                return Done{};
            }();
            ASSERT_FALSE(refused) << place;
            EXPECT_EQ(refused.error().exit, ExitCode::cannot_create);
            EXPECT_EQ(refused.error().error.code, ErrorCode::wrong_kind_of_file);
            EXPECT_EQ(refused.error().error.file, folder / place);
        }
        EXPECT_EQ(folder.entries(), 2) << "nothing is left of it";
    }
}

TEST(RecordingDraftTest, replaces_the_files_of_other_cameras) {
    const ScratchFolder folder;
    std::filesystem::create_directory(folder / "depth");
    folder.write("meta.yaml", kSimulated);
    for (const char* old : {"depth.oni", "depth.epoch.yaml", "depth/left.oni", "depth/left.epoch.yaml",
                            "depth/front.oni", "depth/front.epoch.yaml"})
        folder.write(old, "old");
    {
        auto draft = RecordingDraft::create(folder.path(), true);
        ASSERT_TRUE(draft) << draft.error().message();
        fill(*draft, "log");
        ASSERT_TRUE(draft->paths().file(RecordingPaths::kDepthFolder).make_folder());
        for (const char* camera : {"left", "right"}) {
            write(draft->paths().depth(camera), "new");
            write(draft->paths().depth_epoch(camera), "new");
        }
        const auto committed = draft->commit();
        ASSERT_TRUE(committed) << committed.error().message();
    }
    const RecordingPaths recording(folder.path());
    EXPECT_EQ(recording.cameras(), (std::vector<std::string>{"left", "right"}));
    EXPECT_EQ(ScratchFolder::read(folder / "depth/left.oni"), "new");
    EXPECT_TRUE(check_recording(recording));
    auto next = RecordingDraft::create(folder.path(), true);
    ASSERT_TRUE(next) << next.error().message();
    fill(*next, "log");
    ASSERT_TRUE(next->commit());
    EXPECT_FALSE(std::filesystem::exists(folder / "depth")) << "of no camera";
}

TEST(RecordingDraftTest, is_not_begun_where_a_film_of_the_user_is_among_the_cameras) {
    for (const char* const mine : {"depth/mine.oni", "depth/mine.epoch.yaml"}) {
        const ScratchFolder folder;
        std::filesystem::create_directory(folder / "depth");
        folder.write("meta.yaml", kSimulated);
        for (const char* old : {"depth/left.oni", "depth/left.epoch.yaml"}) folder.write(old, "old");
        folder.write(mine, "mine");
        const auto refused = RecordingDraft::create(folder.path(), true);
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().exit, ExitCode::cannot_create);
        EXPECT_EQ(refused.error().error.code, ErrorCode::already_exists);
        EXPECT_THAT(refused.error().error.value, HasSubstr(mine));
        EXPECT_EQ(ScratchFolder::read(folder / mine), "mine");
        EXPECT_EQ(ScratchFolder::read(folder / "depth/left.oni"), "old");
    }
}

TEST(RecordingDraftTest, is_not_begun_where_the_cameras_files_cannot_come_into_their_place) {
    const ScratchFolder folder;
    folder.write("meta.yaml", kSimulated);
    folder.write("depth", "mine");
    const auto refused = RecordingDraft::check(folder.path(), true);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().exit, ExitCode::cannot_create);
    EXPECT_EQ(refused.error().error.code, ErrorCode::wrong_kind_of_file);
    EXPECT_EQ(refused.error().error.file, folder / "depth");
    EXPECT_FALSE(RecordingDraft::create(folder.path(), true));
}

TEST(RecordingDraftTest, leaves_maps_that_belong_to_no_recording) {
    const ScratchFolder folder;
    std::filesystem::create_directories(folder / "rec/maps");
    write(folder / "rec/maps/fused.ot", "mine");
    auto draft = RecordingDraft::create(folder / "rec", true);
    ASSERT_TRUE(draft);
    fill(*draft, "log");
    ASSERT_TRUE(draft->commit());
    EXPECT_EQ(ScratchFolder::read(folder / "rec/maps/fused.ot"), "mine");
}

TEST(RecordingDraftTest, believes_no_meta_that_says_two_things) {
    const ScratchFolder folder;
    write(folder / "meta.yaml", std::string(kSimulated) + "source: robot\n");
    const auto refused = RecordingDraft::create(folder.path(), true);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().exit, ExitCode::cannot_create);
}

}  // namespace
}  // namespace octoskin
