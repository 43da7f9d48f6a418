#include "host/apps/recording/recording.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <vector>

#include "common/wire/crc.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

class RecordingTest : public testing::Test {
  protected:
    RecordingTest() : recording_(std::filesystem::path(testing::TempDir()) / "octoskin_recording_test") {
        std::filesystem::remove_all(recording_.directory);
        std::filesystem::create_directories(recording_.directory);
    }
    ~RecordingTest() override { std::filesystem::remove_all(recording_.directory); }

    static void write(const FilePlace& file, const std::string& text) { std::ofstream(file.shown()) << text; }

    RecordingPaths recording_;
};

TEST_F(RecordingTest, meta_reads_back_as_written) {
    const RecordingMeta meta{.made_by = "octoskin 0.1.0",
                             .source = "simulation",
                             .world = {"/w/a b: c.sdf", 0xDEADBEEFU},
                             .scenario = {"/w/s.yaml", 7U},
                             .rig = {"rig.yaml", std::nullopt},
                             .seed = 18446744073709551615U,
                             .is_depth_noise_free = true,
                             .can_frames = 7,
                             .depth_frames = 3,
                             .duration_s = 13.25};
    ASSERT_TRUE(write_meta(recording_, meta));
    const auto read = read_meta(recording_);
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_EQ(read->made_by, "octoskin 0.1.0");
    EXPECT_EQ(read->world.file, "/w/a b: c.sdf");
    EXPECT_EQ(read->world.crc32, 0xDEADBEEFU);
    EXPECT_EQ(read->scenario.crc32, 7U);
    EXPECT_EQ(read->rig.file, "rig.yaml");
    EXPECT_EQ(read->rig.crc32, std::nullopt);
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
    EXPECT_EQ(read.error().code, ErrorCode::unknown_key);
    EXPECT_EQ(read.error().file, recording_.meta().shown());
    EXPECT_EQ(read.error().line, 3);
    EXPECT_EQ(read.error().key, "sead");
}

TEST_F(RecordingTest, foreign_or_broken_meta_is_an_error) {
    for (const char* text :
         {"", "just text\n", "schema: other/1\n", "schema: [", "schema: octoskin-recording/1\nseed: minus\n",
          "schema: octoskin-recording/1\n? [a]\n: b\n"}) {
        write(recording_.meta(), text);
        EXPECT_FALSE(read_meta(recording_)) << text;
    }
}

TEST_F(RecordingTest, meta_of_two_lines_is_enough_for_a_robot) {
    write(recording_.meta(), "schema: octoskin-recording/1\nsource: robot\n");
    const auto read = read_meta(recording_);
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_FALSE(read->is_simulated());
    EXPECT_TRUE(read->world.file.empty());
}

TEST_F(RecordingTest, a_file_in_its_place_is_said_to_be_one) {
    write(recording_.can_log(), "x");
    const auto checked = check_recording(RecordingPaths(recording_.can_log()));
    ASSERT_FALSE(checked);
    EXPECT_EQ(checked.error().code, ErrorCode::wrong_kind_of_file);
    EXPECT_EQ(checked.error().file, recording_.can_log().shown());
    EXPECT_THAT(checked.error().remedy, testing::HasSubstr(recording_.directory.string()));
}

TEST_F(RecordingTest, an_mcap_file_in_its_place_is_to_be_imported) {
    const FilePlace bag = recording_.file("out.mcap");
    write(bag, "x");
    const auto checked = check_recording(RecordingPaths(bag));
    ASSERT_FALSE(checked);
    EXPECT_EQ(checked.error().code, ErrorCode::wrong_kind_of_file);
    EXPECT_THAT(checked.error().remedy, testing::HasSubstr("octoskin bridge import"));
    EXPECT_THAT(checked.error().remedy, testing::HasSubstr("out.mcap DIR --rig RIG"));
}

TEST_F(RecordingTest, needs_no_rig_of_its_own_if_another_is_given) {
    write(recording_.can_log(), "x");
    write(recording_.meta(), "x");
    EXPECT_FALSE(check_recording(recording_));
    EXPECT_TRUE(check_recording(recording_, true));
}

TEST_F(RecordingTest, a_value_of_another_type_or_a_key_given_twice_is_refused) {
    const std::string schema = "schema: octoskin-recording/1\n";
    write(recording_.meta(), schema + "can_frames: 7\n");
    ASSERT_TRUE(read_meta(recording_));
    for (const char* line : {"can_frames: lots",
                             "can_frames: -1",
                             "depth_frames: [a]",
                             "is_depth_noise_free: perhaps",
                             "is_depth_noise_free: yes",
                             "can_frames: 07x",
                             "seed: 18446744073709551616",
                             "duration_s: .nan",
                             "duration_s: -1",
                             "world_crc32: 0x100000000",
                             "world_crc32: -1",
                             "made_by: [a]",
                             "seed: \"7\"",
                             "world: \"w\xF0\x80\"",
                             "world: \xEF\xBF\xBE",
                             "source: \xC0\xAF",
                             "made_by: &anchor x",
                             "seed: !!int 7",
                             "duration_s: long",
                             "schema: octoskin-recording/1",
                             "can_frames: 1\ncan_frames: 1"}) {
        write(recording_.meta(), schema + line + "\n");
        const auto read = read_meta(recording_);
        ASSERT_FALSE(read) << line;
        EXPECT_GE(read.error().line, 2) << line;
        EXPECT_EQ(read.error().file, recording_.meta().shown()) << line;
    }
}

TEST(SourceFileTest, checksum_is_that_of_all_bytes_in_order) {
    const testing_support::ScratchFolder folder;
    const auto digits = folder.write("digits", "123456789");
    EXPECT_EQ(crc32_of(digits), 0xCBF43926U);  // the check value of CRC-32/ISO-HDLC
    const std::vector<std::filesystem::path> parts{folder.write("a", "1234"), folder.write("b", "56789")};
    EXPECT_EQ(crc32_of(std::vector<FilePlace>(parts.begin(), parts.end())), 0xCBF43926U);
    const auto large = folder.write("large", std::string(200'001, 'x'));
    EXPECT_EQ(crc32_of(large), crc32(std::vector<std::uint8_t>(200'001, 'x')));
    std::uint64_t read = 0;
    EXPECT_TRUE(crc32_of(std::vector<FilePlace>{FilePlace(large), FilePlace(digits)},
                         [&](std::uint64_t bytes) { read = bytes; }));
    EXPECT_EQ(read, 200'010U);
    EXPECT_EQ(crc32_of(folder / "absent"), std::nullopt);
    EXPECT_EQ(crc32_of(folder.path()), std::nullopt);
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    EXPECT_EQ(crc32_of(folder / "pipe"), std::nullopt) << "and nobody waits for its writer";
    EXPECT_EQ(source_file(parts[0], std::vector<FilePlace>(parts.begin() + 1, parts.end())).crc32,
              0xCBF43926U);
    EXPECT_TRUE(source_file("x").file.is_absolute());
    EXPECT_EQ(crc_text(0xABC), "0x00000abc");
}

TEST_F(RecordingTest, each_missing_file_is_named) {
    const RecordingPaths absent(recording_.directory / "absent");
    EXPECT_EQ(check_recording(absent).error().code, ErrorCode::not_found);
    EXPECT_EQ(check_recording(absent).error().file, absent.directory);
    for (const auto& file : {recording_.can_log(), recording_.rig(), recording_.meta()}) {
        const auto checked = check_recording(recording_);
        ASSERT_FALSE(checked);
        EXPECT_EQ(checked.error().code, ErrorCode::not_found);
        EXPECT_EQ(checked.error().file, file.shown());
        write(file, "x");
    }
    EXPECT_TRUE(check_recording(recording_));
    write(recording_.depth(), "x");
    EXPECT_EQ(check_recording(recording_).error().file, recording_.depth_epoch().shown());
    write(recording_.depth_epoch(), "x");
    EXPECT_TRUE(check_recording(recording_));
}

TEST_F(RecordingTest, what_lies_in_a_files_place_and_is_none_is_refused_by_name) {
    for (const auto& file : {recording_.can_log(), recording_.rig(), recording_.meta()}) write(file, "x");
    ASSERT_TRUE(check_recording(recording_));
    std::ofstream(recording_.directory / "elsewhere") << "x";
    for (const char* name :
         {"can.log", "rig.yaml", "meta.yaml", "robot.urdf", "depth.oni", "depth.epoch.yaml", "order.log",
          "mapping.yaml", "first.ot", "first.snapshot", "last.ot"}) {
        const auto file = recording_.directory / name;
        const auto kept = recording_.directory / "kept";
        const bool is_there = std::filesystem::exists(file);
        if (is_there) std::filesystem::rename(file, kept);
        std::filesystem::create_symlink("elsewhere", file);
        const auto checked = check_recording(recording_);
        ASSERT_FALSE(checked) << name;
        EXPECT_EQ(checked.error().file, file);
        EXPECT_EQ(checked.error().code, ErrorCode::link);
        std::filesystem::remove(file);
        ASSERT_EQ(::mkfifo(file.c_str(), 0600), 0);
        EXPECT_EQ(check_recording(recording_).error().code, ErrorCode::wrong_kind_of_file);
        EXPECT_EQ(check_recording(recording_).error().file, file);
        std::filesystem::remove(file);
        if (is_there) std::filesystem::rename(kept, file);
    }
    EXPECT_TRUE(check_recording(recording_));
}

TEST_F(RecordingTest, knows_the_cameras_by_the_files_that_are_there) {
    EXPECT_TRUE(recording_.cameras().empty());
    std::filesystem::create_directory(recording_.directory / "depth");
    EXPECT_TRUE(recording_.cameras().empty());
    for (const char* name :
         {"right.oni", "left.oni", "left.epoch.yaml", ".hidden.oni", "notes.txt", "-x.oni"})
        write(recording_.file(std::string("depth/") + name), "x");
    EXPECT_EQ(recording_.cameras(), (std::vector<std::string>{"left", "right"}));
    write(recording_.depth(), "x");
    EXPECT_EQ(recording_.cameras(), (std::vector<std::string>{"", "left", "right"}));
    EXPECT_EQ(recording_.depth().name(), "depth.oni");
    EXPECT_EQ(recording_.depth("left").name(), "depth/left.oni");
    EXPECT_EQ(recording_.depth_epoch("left").name(), "depth/left.epoch.yaml");
}

TEST_F(RecordingTest, of_a_camera_without_one_of_its_files_it_is_named) {
    for (const auto& file : {recording_.can_log(), recording_.rig(), recording_.meta()}) write(file, "x");
    std::filesystem::create_directory(recording_.directory / "depth");
    EXPECT_TRUE(check_recording(recording_));
    write(recording_.depth("left"), "x");
    const auto checked = check_recording(recording_);
    ASSERT_FALSE(checked);
    EXPECT_EQ(checked.error().code, ErrorCode::not_found);
    EXPECT_EQ(checked.error().file, recording_.depth_epoch("left").shown());
    EXPECT_THAT(checked.error().what, testing::HasSubstr("depth/left.oni"));
    write(recording_.depth_epoch("left"), "x");
    EXPECT_TRUE(check_recording(recording_));
    write(recording_.depth_epoch("right"), "x");
    EXPECT_EQ(check_recording(recording_).error().file, recording_.depth("right").shown());
}

TEST_F(RecordingTest, what_lies_in_the_place_of_the_cameras_files_is_refused_by_name) {
    for (const auto& file : {recording_.can_log(), recording_.rig(), recording_.meta()}) write(file, "x");
    const auto depth = recording_.directory / "depth";
    const auto refused = [&](const std::filesystem::path& file, ErrorCode code) {
        const auto checked = check_recording(recording_);
        ASSERT_FALSE(checked) << file;
        EXPECT_EQ(checked.error().file, file);
        EXPECT_EQ(checked.error().code, code) << file;
    };
    write(recording_.file("depth"), "x");
    refused(depth, ErrorCode::wrong_kind_of_file);
    std::filesystem::remove(depth);
    std::filesystem::create_directory(recording_.directory / "elsewhere");
    std::filesystem::create_directory_symlink("elsewhere", depth);
    refused(depth, ErrorCode::link);
    std::filesystem::remove(depth);
    std::filesystem::create_directory(depth);
    std::filesystem::create_symlink("../can.log", depth / "left.oni");
    refused(depth / "left.oni", ErrorCode::link);
    std::filesystem::remove(depth / "left.oni");
    ASSERT_EQ(::mkfifo((depth / "left.epoch.yaml").c_str(), 0600), 0);
    refused(depth / "left.epoch.yaml", ErrorCode::wrong_kind_of_file);
    std::filesystem::remove(depth / "left.epoch.yaml");
    std::filesystem::create_symlink("../can.log", depth / "notes.txt");
    EXPECT_TRUE(check_recording(recording_)) << "no name of a camera";
}

TEST_F(RecordingTest, one_that_was_left_half_moved_is_refused_with_what_finishes_it) {
    for (const auto& file : {recording_.can_log(), recording_.rig(), recording_.meta()}) write(file, "x");
    std::filesystem::create_directory(recording_.directory / ".octoskin-ready");
    const auto checked = check_recording(recording_);
    ASSERT_FALSE(checked);
    EXPECT_EQ(checked.error().file, recording_.directory);
    EXPECT_EQ(checked.error().code, ErrorCode::unfinished_move);
    EXPECT_THAT(checked.error().remedy,
                testing::HasSubstr("octoskin repair " + recording_.directory.string()));
    EXPECT_TRUE(std::filesystem::exists(recording_.directory / ".octoskin-ready"));
}

TEST_F(RecordingTest, a_folder_with_a_recording_in_it_says_where_that_is) {
    const auto inner = recording_.directory / "recording";
    std::filesystem::create_directory(inner);
    std::ofstream(inner / "can.log") << "x";
    const auto checked = check_recording(recording_);
    ASSERT_FALSE(checked);
    EXPECT_EQ(checked.error().file, recording_.can_log().shown());
    EXPECT_EQ(checked.error().code, ErrorCode::not_found);
    EXPECT_THAT(checked.error().remedy, testing::HasSubstr(inner.string()));
}

}  // namespace
}  // namespace octoskin
