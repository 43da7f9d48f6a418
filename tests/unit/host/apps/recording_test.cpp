#include "host/apps/recording/recording.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace octoskin {
namespace {

class RecordingTest : public testing::Test {
  protected:
    RecordingTest() : recording_(std::filesystem::path(testing::TempDir()) / "octoskin_recording_test") {
        std::filesystem::remove_all(recording_.directory);
        std::filesystem::create_directories(recording_.directory);
    }
    ~RecordingTest() override { std::filesystem::remove_all(recording_.directory); }

    static void write(const std::filesystem::path& file, const std::string& text) {
        std::ofstream(file) << text;
    }

    RecordingPaths recording_;
};

TEST_F(RecordingTest, meta_reads_back_as_written) {
    const RecordingMeta meta{.made_by = "octoskin 0.1.0",
                             .source = "simulation",
                             .world = "a b: c.sdf",
                             .scenario = "s.yaml",
                             .seed = 18446744073709551615U,
                             .is_depth_noise_free = true,
                             .can_frames = 7,
                             .depth_frames = 3,
                             .duration_s = 13.25};
    ASSERT_TRUE(write_meta(recording_, meta));
    const auto read = read_meta(recording_);
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_EQ(read->made_by, "octoskin 0.1.0");
    EXPECT_EQ(read->world, "a b: c.sdf");
    EXPECT_EQ(read->seed, 18446744073709551615U);
    EXPECT_TRUE(read->is_depth_noise_free);
    EXPECT_EQ(read->can_frames, 7U);
    EXPECT_EQ(read->depth_frames, 3U);
    EXPECT_DOUBLE_EQ(read->duration_s, 13.25);
}

TEST_F(RecordingTest, unknown_key_is_named_with_its_line) {
    write(recording_.meta(), "schema: octoskin-recording/1\nseed: 1\nsead: 2\n");
    const auto read = read_meta(recording_);
    ASSERT_FALSE(read);
    EXPECT_THAT(read.error().message(), testing::EndsWith("meta.yaml: line 3: unknown key 'sead'"));
}

TEST_F(RecordingTest, foreign_or_broken_meta_is_an_error) {
    for (const char* text :
         {"", "just text\n", "schema: other/1\n", "schema: [", "schema: octoskin-recording/1\nseed: minus\n",
          "schema: octoskin-recording/1\n? [a]\n: b\n"}) {
        write(recording_.meta(), text);
        EXPECT_FALSE(read_meta(recording_)) << text;
    }
}

TEST_F(RecordingTest, each_missing_file_is_named) {
    const RecordingPaths absent(recording_.directory / "absent");
    EXPECT_THAT(check_recording(absent).error().what, testing::HasSubstr("no such directory"));
    for (const auto& file : {recording_.can_log(), recording_.rig(), recording_.robot(), recording_.meta()}) {
        const auto checked = check_recording(recording_);
        ASSERT_FALSE(checked);
        EXPECT_EQ(checked.error().file, file);
        write(file, "x");
    }
    EXPECT_TRUE(check_recording(recording_));
    write(recording_.depth(), "x");
    EXPECT_THAT(check_recording(recording_).error().what, testing::HasSubstr("both"));
    write(recording_.depth_epoch(), "x");
    EXPECT_TRUE(check_recording(recording_));
}

}  // namespace
}  // namespace octoskin
