// A TUM RGB-D data set through the program, against an .oni recording of the same images.
#include <gmock/gmock.h>

#include <chrono>
#include <random>
#include <sstream>

#include "host/io/openni2/oni_writer.hpp"
#include "tests/support/data_set/written_data_set.hpp"
#include "tests/system/cli/failure.hpp"
#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing_support::code_is;
using testing_support::Grey;
using testing_support::key_is;
using testing_support::line_is;
using testing_support::remedy_is;
using testing_support::value_is;
using testing_support::what_is;
using testing_support::WrittenDataSet;

constexpr int kFrames = 6;
constexpr unsigned kWidth = 128;  // as tests/data/short/rig.yaml
constexpr unsigned kHeight = 106;

Grey noisy_wall(unsigned seed) {
    std::mt19937 random(seed);
    Grey image{kWidth, kHeight, {}};
    for (unsigned i = 0; i < kWidth * kHeight; ++i)
        image.values.push_back(
            static_cast<std::uint16_t>(random() % 9 == 0 ? 0 : 5 * (2'000 + random() % 90)));
    return image;
}

/// An OpenNI2 camera at (0.1, 0.2, 0.8) that looks along x, as a recording with a silent bus.
void record(const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    write(folder / "can.log", "");
    write(folder / "meta.yaml", "schema: octoskin-recording/1\nsource: robot\n");
    // Beside the recording: a rig inside of it could not extend a file outside.
    write(folder.string() + ".yaml", "extends: " + source("tests/data/short/rig.yaml") +
                                         "\ncamera: {pose: {xyz_m: [0.1, 0.2, 0.8], looking_at_m: ~, "
                                         "rotation_rows: [[0, 0, 1], [-1, 0, 0], [0, -1, 0]]}}\n");
    auto writer =
        openni2::OniWriter::create(folder / "depth.oni", folder / "depth.epoch.yaml", {kWidth, kHeight});
    ASSERT_TRUE(writer) << writer.error().what;
    for (unsigned i = 0; i < kFrames; ++i) {
        std::vector<std::uint16_t> depth_mm;
        for (const std::uint16_t value : noisy_wall(i).values)
            depth_mm.push_back(static_cast<std::uint16_t>(value / 5));
        ASSERT_TRUE(writer->write(HostTime{1'000'000'000LL + 100'000'000LL * i}, depth_mm));
    }
    ASSERT_TRUE(writer->close());
}

void write_data_set(const std::filesystem::path& folder) {
    WrittenDataSet data_set(folder);
    for (unsigned i = 0; i < kFrames; ++i) {
        const std::string time = "1." + std::to_string(i) + "00000";
        data_set.add_image(time, noisy_wall(i));
        data_set.add_pose(time, "0.1 0.2 0.8 0.5 -0.5 0.5 -0.5");
    }
}

class DataSet : public ProgramTest {};

TEST_F(DataSet, gives_the_map_of_a_recording_with_the_same_images) {
    write(path("mapping.yaml"), "base: robust\nremoves_robot_from_depth: false\n");
    record(path("recording"));
    write_data_set(path("set"));
    const std::string mapping = " --configuration " + path("mapping.yaml");
    const Said recording =
        octoskin("replay " + path("recording") + mapping + " --rig " + path("recording.yaml"));
    ASSERT_EQ(recording.exit_code, 0) << recording.output;
    const Said set = octoskin("replay " + path("set") + mapping + " --rig " + path("recording.yaml"));
    ASSERT_EQ(set.exit_code, 0) << set.output;
    EXPECT_GT(content(path("set/maps/depth.ot")).size(), 1'000U);
    for (const char* map : {"depth.ot", "fused.ot", "fused.bt", "fused.ply"})
        EXPECT_EQ(content(path("set/maps/") + map), content(path("recording/maps/") + map)) << map;
    const Said again = octoskin("replay " + path("set") + " --rig " + path("recording.yaml"));
    EXPECT_EQ(again.exit_code, 0) << again.output;  // over the maps of the replay before
    EXPECT_FALSE(std::filesystem::exists(path("set/maps/proximity.ot"))) << "nothing measured proximity";
}

/// `folder`/film.oni of the images of record(), and its rig.
void film(const std::filesystem::path& folder, const std::string& recording) {
    record(recording);
    std::filesystem::create_directories(folder);
    std::filesystem::copy(recording + "/depth.oni", folder / "film.oni");
}

TEST_F(DataSet, an_oni_that_stands_alone_gives_the_same_map_from_where_its_camera_was) {
    write(path("mapping.yaml"), "base: robust\nremoves_robot_from_depth: false\n");
    film(path("film"), path("recording"));
    const std::string how = " --configuration " + path("mapping.yaml") + " --rig " + path("recording.yaml");
    ASSERT_EQ(octoskin("replay " + path("recording") + how).exit_code, 0);
    const std::string map = content(path("recording/maps/fused.ot"));
    const Said folder = octoskin("replay " + path("film") + how);
    EXPECT_EQ(folder.exit_code, 0) << folder.output;
    EXPECT_EQ(content(path("film/maps/fused.ot")), map);
    const Said file = octoskin("replay " + path("film/film.oni") + how);
    EXPECT_EQ(file.exit_code, 0) << file.output;
    EXPECT_EQ(content(path("film/film.maps/fused.ot")), map);
    // The same pose by --pose: optical z along the map's x.
    const Said posed = octoskin("replay " + path("film/film.oni") + how +
                                " --pose 0.1,0.2,0.8,-90,0,-90 --out " + path("posed"));
    EXPECT_EQ(posed.exit_code, 0) << posed.output;
    EXPECT_NEAR(static_cast<double>(content(path("posed/fused.ot")).size()), static_cast<double>(map.size()),
                0.01 * static_cast<double>(map.size()));
    const Said wall = octoskin("explain 2.145 0.21 0.81 --recording " + path("film/film.oni") + how +
                               " --pose 0.1,0.2,0.8,-90,0,-90");
    EXPECT_THAT(wall.output, HasSubstr("occupied, mainly by the camera"));
}

TEST_F(DataSet, an_oni_that_stands_alone_needs_to_know_where_its_camera_was) {
    film(path("film"), path("recording"));
    EXPECT_THAT(failure_of("replay " + path("film/film.oni")),
                fails_with(64, code_is(ErrorCode::bad_argument), path_is(path("film/film.oni")),
                           key_is("--pose"), remedy_is(HasSubstr("--pose X,Y,Z,ROLL,PITCH,YAW"))));
    for (const std::string pose : {"1,2,3", "1,2,3,4,5,6,7", "1,2,3,4,5,nan", "a", "1,2,3,4,5,6,"})
        EXPECT_THAT(failure_of("replay " + path("film/film.oni") + " --pose " + pose),
                    fails_with(64, code_is(ErrorCode::bad_argument), key_is("--pose"),
                               value_is("'" + pose + "'"), what_is(HasSubstr("X,Y,Z,ROLL,PITCH,YAW"))));
    const Said size = octoskin("replay " + path("film/film.oni") + " --pose 0,0,0,0,0,0");
    EXPECT_EQ(size.exit_code, 1) << size.output;
    EXPECT_THAT(size.output, HasSubstr("128 x 106, the camera's are 640 x 480"));
    write_data_set(path("set"));
    EXPECT_EQ(octoskin("replay " + path("set") + " --pose 0,0,0,0,0,0").exit_code, 64);
    write(path("film/film.oni"), "no film");
    EXPECT_EQ(octoskin("replay " + path("film/film.oni") + " --pose 0,0,0,0,0,0").exit_code, 65);
    std::filesystem::copy(path("recording/depth.oni"), path("film/other.oni"));
    EXPECT_EQ(octoskin("replay " + path("film") + " --pose 0,0,0,0,0,0").exit_code, 64)
        << "two of them: neither is meant";
}

TEST_F(DataSet, plays_at_the_speed_asked_for_and_step_by_step_into_the_same_map) {
    write_data_set(path("set"));
    const std::string rig = " --rig " + source("tests/data/short/rig.yaml");
    ASSERT_EQ(octoskin("replay " + path("set") + rig).exit_code, 0);
    const std::string map = content(path("set/maps/fused.ot"));
    // 0.5 s of images.
    const auto began = std::chrono::steady_clock::now();
    const Said slow = octoskin("replay " + path("set") + rig + " --out " + path("slow") + " --speed 1");
    EXPECT_GE(std::chrono::steady_clock::now() - began, std::chrono::milliseconds(499));
    EXPECT_EQ(slow.exit_code, 0) << slow.output;
    EXPECT_EQ(content(path("slow/fused.ot")), map);
    EXPECT_EQ(octoskin("replay " + path("set") + rig + " --out " + path("fast") + " --speed 50").exit_code,
              0);
    EXPECT_EQ(content(path("fast/fused.ot")), map);
    const Said stepped = run("yes '' | head -6 | " OCTOSKIN_PROGRAM " replay " + path("set") + rig +
                             " --out " + path("stepped") + " --step");
    EXPECT_EQ(stepped.exit_code, 0) << stepped.output;
    EXPECT_THAT(stepped.output, HasSubstr("depth image 5 of 1.500000000: 128 x 106"));
    EXPECT_EQ(content(path("stepped/fused.ot")), map);
}

TEST_F(DataSet, a_lens_that_no_pixel_by_pixel_inverse_is_of_is_refused_before_anything_is_read) {
    write_data_set(path("set"));
    write(path("rig.yaml"), "extends: " + source("tests/data/short/rig.yaml") +
                                "\ncamera:\n  distortion: {k1: -0.9, k2: 0.1}\n");
    EXPECT_THAT(failure_of("replay " + path("set") + " --rig " + path("rig.yaml")),
                fails_with(78, code_is(ErrorCode::bad_value), path_is(path("rig.yaml")), line_is(3),
                           key_is("camera.distortion"), value_is(HasSubstr("k1 -0.9, k2 0.1"))));
    EXPECT_FALSE(std::filesystem::exists(path("set/maps/fused.ot")));
}

TEST_F(DataSet, is_explained_voxel_by_voxel) {
    WrittenDataSet data_set(path("set"));
    for (int i = 0; i < 3; ++i) {
        const std::string time = "1305031102.1" + std::to_string(i);
        data_set.add_image(time, {640, 480, std::vector<std::uint16_t>(640 * 480, 10'000)});
        data_set.add_pose(time, "0 0 0 0 0 0 1");
    }
    const Said said = octoskin("explain 0.02 0.02 2.02 --recording " + path("set"));
    ASSERT_EQ(said.exit_code, 0) << said.output;
    EXPECT_THAT(said.output, HasSubstr("occupied, mainly by the camera between 0.000 and 0.020 s, 3 hits"));
}

TEST_F(DataSet, a_fault_is_named_with_file_and_line_and_leaves_no_map) {
    write_data_set(path("set"));
    write(path("set/groundtruth.txt"), "# no comment\n1.0 0 0 0 0 0 0\n");
    EXPECT_THAT(failure_of("replay " + path("set")),
                fails_with(65, code_is(ErrorCode::bad_syntax), path_is(path("set/groundtruth.txt")),
                           line_is(2), what_is(HasSubstr("tx ty tz qx qy qz qw"))));
    write_data_set(path("other"));
    write(path("other/depth/1.300000.png"), "not a picture");
    EXPECT_THAT(failure_of("replay " + path("other")),
                fails_with(65, code_is(ErrorCode::bad_syntax), path_is(path("other/depth.txt")), line_is(7),
                           key_is("depth/1.300000.png"), what_is(HasSubstr("PNG"))));
    EXPECT_FALSE(std::filesystem::exists(path("other/maps/fused.ot")));
}

TEST_F(DataSet, is_mapped_as_people_write_it_into_the_same_map) {
    const std::string rig = " --rig " + source("tests/data/short/rig.yaml");
    write_data_set(path("set"));
    ASSERT_EQ(octoskin("replay " + path("set") + rig).exit_code, 0);
    const std::string map = content(path("set/maps/depth.ot"));
    ASSERT_GT(map.size(), 1'000U);
    // Exponents, a mark, a pose that is not known, a broken line, no order; the list of both images.
    write_data_set(path("other"));
    std::filesystem::remove(path("other/depth.txt"));
    std::string poses = "\xEF\xBB\xBF# of evo\r\n0.9 nan nan nan nan nan nan nan\r\nlost\r\n";
    std::string images;
    for (const std::string i : {"0", "2", "1", "3", "4", "5"}) {
        const std::string time = "1." + i + "0000e+00 ";
        poses += time + "1e-1 +2.0e-01 8.0e-1 0.5 -0.5 0.5 -0.5\r\n";
        images += time + "rgb/" + i + ".png " + time + "depth/1." + i + "00000.png\n";
    }
    write(path("other/associations.txt"), images);
    write(path("other/groundtruth.txt"), poses);
    const Said said = octoskin("replay " + path("other") + rig);
    EXPECT_EQ(said.exit_code, 0) << said.output;
    EXPECT_EQ(content(path("other/maps/depth.ot")), map);
    EXPECT_THAT(said.output, HasSubstr("groundtruth.txt:3: expected a time in seconds, found 'lost'"));
    EXPECT_THAT(said.output, HasSubstr("associations.txt:3: its time is before"));
}

TEST_F(DataSet, says_below_the_account_which_size_its_images_have_and_which_is_expected) {
    write_data_set(path("set"));
    const Said said = octoskin("replay " + path("set"));
    EXPECT_EQ(said.exit_code, 1) << said.output;
    const auto size = said.output.find("6 depth images are 128 x 106, the camera's are 640 x 480");
    const auto above = said.output.find("see the warnings above");
    EXPECT_NE(size, std::string::npos) << said.output;
    EXPECT_NE(above, std::string::npos) << said.output;
    EXPECT_LT(said.output.find("wrong_size"), size) << said.output;
    EXPECT_LT(size, above) << said.output;
}

TEST_F(DataSet, without_images_is_named_by_its_list) {
    write_data_set(path("set"));
    write(path("set/depth.txt"), "# no image\n");
    EXPECT_THAT(failure_of("replay " + path("set")),
                fails_with(65, code_is(ErrorCode::no_content), path_is(path("set/depth.txt"))));
}

TEST_F(DataSet, has_no_truth_to_be_judged_by) {
    write_data_set(path("set"));
    const Said replayed = octoskin("replay " + path("set") + " --rig " + source("tests/data/short/rig.yaml"));
    ASSERT_EQ(replayed.exit_code, 0) << replayed.output;
    for (const std::string& what :
         {path("set"), path("set/maps/fused.ot") + " --rig " + source("tests/data/short/rig.yaml")}) {
        const Failure failure = failure_of("evaluate " + what);
        EXPECT_THAT(failure, fails_with(64, code_is(ErrorCode::unsupported), path_is(path("set")),
                                        remedy_is(HasSubstr("octovis"))));
        EXPECT_THAT(failure.output, testing::Not(HasSubstr("meta.yaml")));
        EXPECT_THAT(failure.output, testing::Not(HasSubstr("changed since")));
    }
}

TEST_F(DataSet, is_not_hidden_by_a_simulation_even_by_force) {
    write_data_set(path("set"));
    EXPECT_THAT(
        failure_of("simulate " + path("set") + " --force --rig " + source("tests/data/short/rig.yaml") +
                   " --scenario " + source("tests/data/short/scenario.yaml")),
        fails_with(73, code_is(ErrorCode::already_exists), path_is(path("set")),
                   what_is(HasSubstr("(depth.txt)")), remedy_is(HasSubstr("another directory"))));
    EXPECT_FALSE(std::filesystem::exists(path("set/can.log")));
}

TEST_F(DataSet, an_image_that_is_not_there_is_named_with_its_line_and_what_to_do) {
    write_data_set(path("set"));
    std::filesystem::remove(path("set/depth/1.300000.png"));
    for (const char* command : {"replay ", "explain 0 0 1 --recording "}) {
        EXPECT_THAT(failure_of(command + path("set")),
                    fails_with(66, code_is(ErrorCode::not_found), path_is(path("set/depth.txt")), line_is(7),
                               key_is("depth/1.300000.png"),
                               remedy_is(AllOf(HasSubstr("unpack"), HasSubstr("remove the line")))));
    }
    EXPECT_FALSE(std::filesystem::exists(path("set/maps")));
}

}  // namespace
}  // namespace octoskin
