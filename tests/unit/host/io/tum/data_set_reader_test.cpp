// Data sets on disk, in exactly the benchmark's layout.
#include "host/io/tum/data_set_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>

#include "host/io/tum/data_set_camera.hpp"
#include "host/io/tum/depth_png.hpp"
#include "tests/support/data_set/written_data_set.hpp"
#include "tests/support/errors/error_fields.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::tum {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing_support::code_is;
using testing_support::error_in;
using testing_support::file_is;
using testing_support::Grey;
using testing_support::has_its_fields;
using testing_support::key_is;
using testing_support::line_is;
using testing_support::no_error;
using testing_support::remedy_is;
using testing_support::ScratchFolder;
using testing_support::what_is;
using testing_support::WrittenDataSet;

class DataSetReaderTest : public testing::Test {
  protected:
    DataSetReader open() {
        auto reader = DataSetReader::open(written_.folder());
        EXPECT_TRUE(reader) << reader.error().message();
        return std::move(*reader);
    }
    Error error_of_next() {
        const Error error = error_in(open().next());
        EXPECT_TRUE(has_its_fields(error));
        return error;
    }
    [[nodiscard]] Error error_of_open() const { return error_in(DataSetReader::open(written_.folder())); }

    ScratchFolder scratch_;
    WrittenDataSet written_{scratch_ / "rgbd_dataset_freiburg1_xyz"};
};

TEST(DepthTable, is_the_nearest_millimetre_of_5000_a_metre_for_every_value) {
    const std::vector<std::uint16_t> table = depth_mm_table({});
    for (unsigned value = 0; value <= 0xFFFF; ++value)
        ASSERT_EQ(table.at(value), std::lround(1000.0 * value / 5000.0)) << value;
    EXPECT_EQ(table.size(), 0x10000U);
}

TEST(DepthTable, is_what_the_data_set_says_and_what_a_frame_does_not_hold_is_no_value) {
    const std::vector<std::uint16_t> millimetres =
        depth_mm_table({.units_per_m = 1000.0, .no_value = 65'535});
    EXPECT_EQ(millimetres.at(1234), 1234);
    EXPECT_EQ(millimetres.at(65'534), 65'534);
    EXPECT_EQ(millimetres.at(65'535), 0);
    EXPECT_EQ(millimetres.at(0), 0);
    const std::vector<std::uint16_t> coarse = depth_mm_table({.units_per_m = 256.0, .no_value = 7});
    EXPECT_EQ(coarse.at(256), 1000);
    EXPECT_EQ(coarse.at(7), 0);
    EXPECT_EQ(coarse.at(8), 31);  // 31.25 mm
    EXPECT_EQ(coarse.at(16'776), 65'531);
    EXPECT_EQ(coarse.at(16'777), 65'535);
    EXPECT_EQ(coarse.at(16'778), 0);  // 65.539 m
}

TEST_F(DataSetReaderTest, gives_every_image_with_its_time_and_where_the_camera_was) {
    written_.add_pose("100.00", "0 0 1 0 0 0 1");
    written_.add_pose("100.02", "0 0 3 0 0 0 1");
    written_.add_image("100.000000", {3, 2, {0, 5000, 10000, 2, 3, 65535}});
    written_.add_image("100.010000", {3, 2, {5, 5, 5, 5, 5, 5}});
    DataSetReader reader = open();
    EXPECT_EQ(reader.begin().ns, 100'000'000'000);
    EXPECT_EQ(reader.images_left(), 2U);
    const auto first = *reader.next();
    ASSERT_TRUE(first);
    EXPECT_EQ(first->captured.ns, 100'000'000'000);
    EXPECT_EQ(first->width, 3U);
    EXPECT_EQ(first->height, 2U);
    EXPECT_THAT(first->depth_mm, ElementsAre(0, 1000, 2000, 0, 1, 13107));
    EXPECT_EQ(first->T_map_camera->translation().z(), 1.0);
    const auto second = *reader.next();
    EXPECT_NEAR(second->T_map_camera->translation().z(), 2.0, 1e-12);
    EXPECT_FALSE(*reader.next());
    EXPECT_FALSE(*reader.next());
    EXPECT_EQ(reader.images().read, 2U);
    EXPECT_EQ(reader.images_left(), 0U);
}

TEST_F(DataSetReaderTest, takes_scale_and_missing_value_as_they_are_given) {
    written_.add_pose("100.00", "0 0 1 0 0 0 1");
    written_.add_image("100.00", {3, 1, {0, 1500, 65'535}});
    auto reader = DataSetReader::open(written_.folder(), {.units_per_m = 1000.0, .no_value = 65'535});
    ASSERT_TRUE(reader) << reader.error().message();
    EXPECT_THAT((*reader->next())->depth_mm, ElementsAre(0, 1500, 0));
}

TEST_F(DataSetReaderTest, counts_images_of_which_no_pose_is_known_and_does_not_read_them) {
    written_.add_line("depth.txt", "99.9 depth/absent.png");
    written_.add_pose("100", "0 0 0 0 0 0 1");
    written_.add_image("100", {1, 1, {7000}});
    written_.add_line("depth.txt", "100.1 depth/absent.png");
    DataSetReader reader = open();
    EXPECT_THAT((*reader.next())->depth_mm, ElementsAre(1400));
    EXPECT_FALSE(*reader.next());
    EXPECT_EQ(reader.images().read, 1U);
    EXPECT_EQ(reader.images().without_pose, 2U);
}

TEST_F(DataSetReaderTest, says_which_image_is_the_first_without_a_pose_and_how_far_poses_are_apart_there) {
    written_.add_pose("100.00", "0 0 0 0 0 0 1");
    written_.add_pose("100.066", "0 0 0 0 0 0 1");
    written_.add_image("100.00", {1, 1, {7000}});
    written_.add_image("100.01", {1, 1, {7000}});
    written_.add_image("100.2", {1, 1, {7000}});
    DataSetReader reader = open();
    while (*reader.next()) continue;
    const ImageCounts& images = reader.images();
    EXPECT_EQ(images.without_pose, 2U);
    ASSERT_TRUE(images.first_without_pose);
    EXPECT_THAT(images.first_without_pose->image, AllOf(code_is(ErrorCode::no_data), file_is("depth.txt"),
                                                        line_is(5), key_is("depth/100.01.png")));
    EXPECT_EQ(images.first_without_pose->captured.ns, 100'010'000'000);
    EXPECT_EQ(images.first_without_pose->gap, Nanoseconds{66'000'000});
    EXPECT_EQ(reader.pose_gap_max(), Nanoseconds{50'000'000});
    auto wide = DataSetReader::open(written_.folder(), {.pose_gap_max_ms = 66.0});
    while (*wide->next()) continue;
    EXPECT_EQ(wide->images().read, 2U);
    EXPECT_FALSE(wide->images().first_without_pose->gap) << "behind the last pose";
}

TEST_F(DataSetReaderTest, lines_that_name_no_image_are_counted_and_those_out_of_order_put_in_order) {
    const auto file = written_.folder() / "depth.txt";
    written_.add_pose("99", "0 0 0 0 0 0 1");
    written_.add_pose("100", "0 0 0 0 0 0 1");
    written_.add_image("100", {1, 1, {7000}});
    written_.add_line("depth.txt", "nonsense");
    written_.add_line("depth.txt", "x y");
    written_.add_image("99", {1, 1, {5000}});
    DataSetReader reader = open();
    EXPECT_EQ(reader.images().bad.count, 2U);
    EXPECT_THAT(*reader.images().bad.first,
                AllOf(code_is(ErrorCode::bad_syntax), line_is(5), what_is(HasSubstr("expected a time"))));
    EXPECT_EQ(reader.images().bad.first->file, file);
    EXPECT_TRUE(has_its_fields(*reader.images().bad.first));
    EXPECT_EQ(reader.images().unordered, 1U);
    EXPECT_THAT(*reader.images().disorder, AllOf(code_is(ErrorCode::bad_value), line_is(7)));
    EXPECT_EQ(reader.images().disorder->file, file);
    EXPECT_EQ((*reader.next())->captured.ns, 99'000'000'000);
    EXPECT_EQ((*reader.next())->captured.ns, 100'000'000'000);
}

/// Which voxel no other convention would give: a camera turned by half a turn about its axis, and moved.
TEST_F(DataSetReaderTest, reads_the_layout_of_icl_nuim) {
    const auto folder = scratch_ / "living_room_traj0_frei_png";
    std::filesystem::create_directories(folder / "depth");
    testing_support::write_grey_png(folder / "depth/0.png", {1, 1, {5000}});
    testing_support::write_grey_png(folder / "depth/1.png", {1, 1, {10'000}});
    std::ofstream(folder / "associations.txt") << "0 depth/0.png 0 rgb/0.png\n1 depth/1.png 1 rgb/1.png\n";
    std::ofstream(folder / "livingRoom0.gt.freiburg") << "1 0.5 0.25 -2 0 0 0 1\n2 0 0 0 0 0 0 1\n";
    auto reader = DataSetReader::open(folder);
    ASSERT_TRUE(reader) << reader.error().message();
    EXPECT_EQ(reader->layout().name, "ICL-NUIM");
    EXPECT_EQ(reader->layout().camera, "icl_nuim");
    const auto frame = *reader->next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->captured.ns, 1'000'000'000);
    EXPECT_THAT(frame->depth_mm, ElementsAre(2000));
    EXPECT_TRUE(frame->T_map_camera->translation().isApprox(Eigen::Vector3d(0.5, -0.25, -2)));
    EXPECT_FALSE(*reader->next());
    EXPECT_EQ(reader->images().without_pose, 1U);  // its first image has none
    std::ofstream(folder / "traj0.gt.freiburg") << "";
    EXPECT_THAT(DataSetReader::open(folder).error(),
                AllOf(code_is(ErrorCode::conflict), file_is(folder.filename()),
                      what_is(HasSubstr("livingRoom0.gt.freiburg and traj0.gt.freiburg"))));
}

TEST_F(DataSetReaderTest, reads_the_layout_of_seven_scenes) {
    const auto folder = scratch_ / "seq-01";
    std::filesystem::create_directories(folder);
    const auto pose = [&](const char* name, const char* text) { std::ofstream(folder / name) << text; };
    for (const char* name : {"frame-000000.depth.png", "frame-000001.depth.png", "frame-000002.depth.png",
                             "frame-000010.depth.png", "frame-1000000.depth.png"})
        testing_support::write_grey_png(folder / name, {3, 1, {0, 1500, 65'535}});
    testing_support::write_grey_png(folder / "frame-000000.color.png", {1, 1, {1}});
    pose("frame-000000.pose.txt", "1 0 0 0.5\t\n 0 1 0 0 \n 0 0 1 0 \n 0 0 0 1 \n");
    pose("frame-000001.pose.txt", "-inf -inf -inf -inf -inf -inf -inf -inf -inf -inf -inf -inf 0 0 0 1");
    pose("frame-000010.pose.txt", "1 2 3");
    pose("frame-1000000.pose.txt", "1 0 0 7 0 1 0 0 0 0 1 0 0 0 0 1");
    auto reader = DataSetReader::open(folder);
    ASSERT_TRUE(reader) << reader.error().message();
    EXPECT_EQ(reader->layout().name, "7-Scenes");
    const auto first = *reader->next();
    EXPECT_EQ(first->captured.ns, 0);
    EXPECT_THAT(first->depth_mm, ElementsAre(0, 1500, 0));
    EXPECT_EQ(first->T_map_camera->translation().x(), 0.5);
    const auto last = *reader->next();
    EXPECT_EQ(last->captured.ns, 33'333'333'333'333);
    EXPECT_EQ(last->T_map_camera->translation().x(), 7.0);
    EXPECT_FALSE(*reader->next());
    EXPECT_EQ(reader->images().without_pose, 3U);
    EXPECT_EQ(reader->poses().in, 5U);
    EXPECT_EQ(reader->poses().used, 2U);
    EXPECT_EQ(reader->poses().no_pose, 2U);
    EXPECT_THAT(*reader->poses().bad.first,
                AllOf(code_is(ErrorCode::bad_syntax), file_is("frame-000010.pose.txt"),
                      what_is(HasSubstr("expected the 16 numbers"))));
    EXPECT_EQ(reader->files().size(), 9U);
    auto in_fifths = DataSetReader::open(folder, {.units_per_m = 5000.0});
    EXPECT_THAT((*in_fifths->next())->depth_mm, ElementsAre(0, 300, 0));
}

TEST_F(DataSetReaderTest, a_calibration_beside_the_images_is_their_camera) {
    written_.add_pose("100", "0 0 0 0 0 0 1");
    written_.add_image("100", {8, 6, std::vector<std::uint16_t>(48, 5000)});
    EXPECT_FALSE(open().calibration());
    const auto calibration = written_.folder() / "calibration.txt";
    const auto camera = [&](const char* text) {
        std::ofstream(calibration) << text;
        return calibrated_camera(*open().calibration(), open().first_image());
    };
    // As ETH3D writes it, and as a matrix; whole numbers are pixel centres.
    for (const char* text : {"726.5 725.25 3.5 2.25\n", "726.5 0 3.5\n0 725.25 2.25\n0 0 1\n"}) {
        const auto found = camera(text);
        ASSERT_TRUE(found) << found.error().message();
        EXPECT_EQ(found->width, 8U);
        EXPECT_EQ(found->height, 6U);
        EXPECT_EQ(found->fx, 726.5);
        EXPECT_EQ(found->fy, 725.25);
        EXPECT_EQ(found->cx, 4.0);
        EXPECT_EQ(found->cy, 2.75);
    }
    struct Refused {
        const char* text;
        ErrorCode code;
        const char* reason;
    };
    for (const auto& [text, code, reason] :
         std::initializer_list<Refused>{{"1 2 3", ErrorCode::bad_syntax, "found 3 numbers"},
                                        {"cam 1 2 3", ErrorCode::bad_syntax, "found 'cam'"},
                                        {"0 500 3 3", ErrorCode::out_of_range, "focal lengths"},
                                        {"500 nan 3 3", ErrorCode::out_of_range, "focal lengths"},
                                        {"500 500 9 3", ErrorCode::out_of_range, "principal point"}}) {
        const auto refused = camera(text);
        ASSERT_FALSE(refused) << text;
        EXPECT_THAT(refused.error(), code_is(code));
        EXPECT_EQ(refused.error().file, calibration);
        EXPECT_THAT(refused.error().reason(), HasSubstr(reason));
        EXPECT_TRUE(has_its_fields(refused.error()));
    }
}

TEST_F(DataSetReaderTest, an_image_whose_name_leads_elsewhere_is_named_before_any_is_read) {
    const auto outside = scratch_.write("outside.png", "a secret");
    std::filesystem::create_symlink(outside, written_.folder() / "link.png");
    std::filesystem::create_directory_symlink(scratch_.path(), written_.folder() / "up");
    written_.add_pose("100", "0 0 0 0 0 0 1");
    const std::pair<std::string, ErrorCode> images[] = {{outside.string(), ErrorCode::outside_folder},
                                                        {"../outside.png", ErrorCode::outside_folder},
                                                        {"link.png", ErrorCode::link},
                                                        {"up/outside.png", ErrorCode::link}};
    for (const auto& [image, code] : images) {
        ScratchFolder again;
        std::filesystem::copy(
            written_.folder(), again / "set",
            std::filesystem::copy_options::recursive | std::filesystem::copy_options::copy_symlinks);
        std::ofstream(again / "set/depth.txt") << "100 " << image << '\n';
        const auto read = DataSetReader::open(again / "set");
        ASSERT_FALSE(read) << image;
        EXPECT_THAT(read.error(), AllOf(code_is(code), file_is("depth.txt"), line_is(1), key_is(image)));
    }
}

TEST_F(DataSetReaderTest, a_list_behind_a_link_is_not_read) {
    std::filesystem::rename(written_.folder() / "groundtruth.txt", scratch_ / "poses.txt");
    std::filesystem::create_symlink(scratch_ / "poses.txt", written_.folder() / "groundtruth.txt");
    EXPECT_THAT(error_of_open(), AllOf(code_is(ErrorCode::link), file_is("groundtruth.txt")));
}

TEST_F(DataSetReaderTest, a_list_that_is_not_there_is_named) {
    std::filesystem::remove(written_.folder() / "groundtruth.txt");
    EXPECT_THAT(error_of_open(), AllOf(code_is(ErrorCode::not_found), file_is("groundtruth.txt")));
}

TEST_F(DataSetReaderTest, an_image_that_cannot_be_read_is_named_with_its_line_again_and_again) {
    written_.add_pose("100", "0 0 0 0 0 0 1");
    written_.add_line("depth.txt", "100 depth/absent.png");
    DataSetReader reader = open();
    for (int i = 0; i < 3; ++i) {
        const auto frame = reader.next();
        ASSERT_FALSE(frame);
        EXPECT_EQ(frame.error().file, written_.folder() / "depth.txt");
        EXPECT_THAT(frame.error(),
                    AllOf(line_is(4), key_is("depth/absent.png"), what_is("cannot be opened")));
    }
    EXPECT_EQ(reader.images_left(), 1U);
}

TEST_F(DataSetReaderTest, a_named_pipe_is_refused_without_waiting_for_its_writer) {
    written_.add_pose("100", "0 0 0 0 0 0 1");
    written_.add_line("depth.txt", "100 pipe.png");
    ASSERT_EQ(::mkfifo((written_.folder() / "pipe.png").c_str(), 0600), 0);
    EXPECT_THAT(error_of_next(), AllOf(file_is("depth.txt"), line_is(4), key_is("pipe.png"),
                                       what_is(HasSubstr("a pipe or a device"))));
    std::filesystem::remove(written_.folder() / "groundtruth.txt");
    ASSERT_EQ(::mkfifo((written_.folder() / "groundtruth.txt").c_str(), 0600), 0);
    EXPECT_THAT(error_of_open(), AllOf(code_is(ErrorCode::wrong_kind_of_file), file_is("groundtruth.txt"),
                                       what_is(HasSubstr("a pipe or a device"))));
}

TEST_F(DataSetReaderTest, the_first_image_that_is_missing_is_named_whether_or_not_it_has_a_pose) {
    written_.add_image("100", {1, 1, {7000}});
    EXPECT_FALSE(open().missing_image());
    std::filesystem::create_directory(written_.image("101"));
    written_.add_line("depth.txt", "101 depth/101.png");
    written_.add_line("depth.txt", "102 depth/102.png");
    const auto missing_error = [this] {
        const Error missing = open().missing_image().value_or(no_error());
        EXPECT_THAT(missing, AllOf(file_is("depth.txt"), line_is(5), key_is("depth/101.png")));
        return missing;
    };
    EXPECT_THAT(missing_error(),
                AllOf(code_is(ErrorCode::wrong_kind_of_file), what_is(HasSubstr("a directory"))));
    std::filesystem::remove(written_.image("101"));
    ASSERT_EQ(::mkfifo(written_.image("101").c_str(), 0600), 0);
    EXPECT_THAT(missing_error(),
                AllOf(code_is(ErrorCode::wrong_kind_of_file), what_is(HasSubstr("a named pipe"))));
    std::filesystem::remove(written_.image("101"));
    EXPECT_THAT(missing_error(),
                AllOf(code_is(ErrorCode::not_found),
                      remedy_is(AllOf(HasSubstr("unpack the data set"), HasSubstr("remove the line")))));
}

TEST_F(DataSetReaderTest, images_of_another_kind_are_refused) {
    written_.add_pose("100", "0 0 0 0 0 0 1");
    written_.add_line("depth.txt", "100 depth/100.png");
    testing_support::write_grey_png(written_.image("100"), {2, 2, {1, 2, 3, 4}}, 8);
    EXPECT_THAT(error_of_next(), what_is(HasSubstr("expected one grey channel of 16 bits")));
    std::ofstream(written_.image("100")) << "P5 2 2 65535";
    EXPECT_THAT(error_of_next(), AllOf(code_is(ErrorCode::bad_syntax), file_is("depth.txt"), line_is(4),
                                       key_is("depth/100.png"), what_is(HasSubstr("cannot be read as PNG"))));
}

TEST(DataSetCamera, puts_the_benchmarks_pixel_centres_half_a_pixel_further) {
    for (const std::string_view name : kDataSetCameras) ASSERT_TRUE(data_set_camera(name)) << name;
    EXPECT_FALSE(data_set_camera("freiburg4"));
    EXPECT_FALSE(data_set_camera(""));
    // The benchmark: X = (u - 319.5) Z / 525. Ours: X = (u + 0.5 - cx) Z / fx.
    const CameraIntrinsics kinect = *data_set_camera("kinect");
    for (const double u : {0.0, 319.0, 639.0})
        EXPECT_DOUBLE_EQ((u + 0.5 - kinect.cx) / kinect.fx, (u - 319.5) / 525.0);
    EXPECT_EQ(kinect.cy, 240.0);
    const CameraIntrinsics third = *data_set_camera("freiburg3");
    EXPECT_EQ(third.fx, 535.4);
    EXPECT_EQ(third.fy, 539.2);
    EXPECT_EQ(third.cx, 320.6);
    EXPECT_EQ(third.cy, 248.1);
    EXPECT_EQ(third.width * third.height, 640U * 480U);
}

}  // namespace
}  // namespace octoskin::tum
