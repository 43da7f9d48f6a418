// Depth images of ROS 2, and the camera that they are from.
#include "host/bridge/received/depth_image.hpp"

#include <gtest/gtest.h>
#include <png.h>

#include <bit>
#include <cmath>
#include <limits>

namespace octoskin::bridge {
namespace {

using ros::sensor_msgs::CameraInfo;
using ros::sensor_msgs::CompressedImage;
using ros::sensor_msgs::Image;

constexpr std::uint32_t kWidth = 4;
constexpr std::uint32_t kHeight = 3;

template <class T>
Image image_of(const std::string& encoding, const std::vector<T>& values, std::uint32_t spare_bytes = 0) {
    Image image{.header = {},
                .height = kHeight,
                .width = kWidth,
                .encoding = encoding,
                .is_bigendian = 0,
                .step = static_cast<std::uint32_t>(kWidth * sizeof(T)) + spare_bytes,
                .data = {}};
    image.data.assign(std::size_t{image.step} * kHeight, 0xEE);
    for (std::size_t i = 0; i < values.size(); ++i)
        std::memcpy(image.data.data() + i / kWidth * image.step + i % kWidth * sizeof(T), &values[i],
                    sizeof(T));
    return image;
}

const std::vector<std::uint16_t> kMillimetres = {0, 1, 500, 65'535, 4, 5, 6, 7, 8, 9, 10, 11};

TEST(DepthImage, is_taken_in_millimetres) {
    for (const char* const encoding : {"16UC1", "mono16"}) {
        EXPECT_EQ(depth_pixels(image_of(encoding, kMillimetres), kWidth, kHeight).value().depth_mm,
                  kMillimetres);
        EXPECT_EQ(depth_pixels(image_of(encoding, kMillimetres, 6), kWidth, kHeight).value().depth_mm,
                  kMillimetres);
    }
}

TEST(DepthImage, is_taken_in_metres) {
    constexpr float kInf = std::numeric_limits<float>::infinity();
    const std::vector<float> metres = {0.0F,  1.0F, 0.0014F, 0.0016F, 65.535F, 65.536F,
                                       -1.0F, kInf, -kInf,   NAN,     1e30F,   2.5F};
    const std::vector<std::uint16_t> expected = {0, 1000, 1, 2, 65'535, 0, 0, 0, 0, 0, 0, 2500};
    EXPECT_EQ(depth_pixels(image_of("32FC1", metres), kWidth, kHeight).value().depth_mm, expected);
}

TEST(DepthImage, is_taken_in_either_byte_order) {
    std::vector<std::uint16_t> swapped;
    for (const std::uint16_t mm : kMillimetres)
        swapped.push_back(static_cast<std::uint16_t>(mm << 8U | mm >> 8U));
    Image image = image_of("16UC1", swapped);
    image.is_bigendian = 1;
    EXPECT_EQ(depth_pixels(image, kWidth, kHeight).value().depth_mm, kMillimetres);
}

TEST(DepthImage, that_lies_about_its_size_is_refused) {
    Image image = image_of("16UC1", kMillimetres);
    EXPECT_EQ(depth_pixels(image, kWidth + 1, kHeight).error(), ImageFault::wrong_size);
    EXPECT_EQ(depth_pixels(image, kWidth, kHeight + 1).error(), ImageFault::wrong_size);
    image.data.pop_back();
    EXPECT_EQ(depth_pixels(image, kWidth, kHeight).error(), ImageFault::short_data);
    image = image_of("16UC1", kMillimetres);
    image.step = 7;
    EXPECT_EQ(depth_pixels(image, kWidth, kHeight).error(), ImageFault::short_data);
    image.step = 0xFFFF'FFFF;
    EXPECT_EQ(depth_pixels(image, kWidth, kHeight).error(), ImageFault::short_data);
    image = image_of("rgb8", kMillimetres);
    EXPECT_EQ(depth_pixels(image, kWidth, kHeight).error(), ImageFault::encoding);
    EXPECT_EQ(depth_pixels(Image{.encoding = "16UC1"}, 0, 0).error(), ImageFault::wrong_size);
}

CompressedImage compressed(const std::vector<std::uint16_t>& values) {
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    png.width = kWidth;
    png.height = kHeight;
    png.format = PNG_FORMAT_LINEAR_Y;
    png_alloc_size_t size = 0;
    EXPECT_NE(png_image_write_get_memory_size(png, size, 0, values.data(), 0, nullptr), 0);
    CompressedImage image{.header = {}, .format = "16UC1; compressedDepth png", .data = {}};
    image.data.resize(12 + size);
    EXPECT_NE(png_image_write_to_memory(&png, image.data.data() + 12, &size, 0, values.data(), 0, nullptr),
              0);
    image.data.resize(12 + size);
    return image;
}

TEST(DepthImage, is_taken_from_a_png) {
    EXPECT_EQ(depth_pixels(compressed(kMillimetres), kWidth, kHeight).value().depth_mm, kMillimetres);
}

TEST(DepthImage, as_a_png_with_a_gamma_is_refused) {
    // Between the header, of 33 bytes, and the pixels.
    constexpr std::size_t kBehindHeader = 12 + 33;
    const std::vector<std::uint8_t> gamma = {0, 0, 0,    4,    'g',  'A',  'M',  'A',
                                             0, 0, 0xB1, 0x8F, 0x0B, 0xFC, 0x61, 5};
    const std::vector<std::uint8_t> srgb = {0, 0, 0, 1, 's', 'R', 'G', 'B', 0, 0xAE, 0xCE, 0x1C, 0xE9};
    for (const auto& chunk : {gamma, srgb}) {
        CompressedImage image = compressed(kMillimetres);
        image.data.insert(image.data.begin() + kBehindHeader, chunk.begin(), chunk.end());
        EXPECT_EQ(depth_pixels(image, kWidth, kHeight).error(), ImageFault::encoding);
    }
}

TEST(DepthImage, as_a_png_that_is_cut_or_of_another_kind_is_refused) {
    const CompressedImage sound = compressed(kMillimetres);
    for (std::size_t size = 0; size < sound.data.size(); ++size) {
        CompressedImage image = sound;
        image.data.resize(size);
        const auto pixels = depth_pixels(image, kWidth, kHeight);
        // Without the last chunk, which has no content, libpng has all pixels.
        EXPECT_TRUE(!pixels || pixels->depth_mm == kMillimetres) << size;
        if (size + 12 < sound.data.size()) {
            EXPECT_FALSE(pixels) << size;
        }
    }
    EXPECT_EQ(depth_pixels(sound, kWidth, kHeight + 1).error(), ImageFault::wrong_size);
    CompressedImage image = sound;
    image.format = "32FC1; compressedDepth png";
    EXPECT_EQ(depth_pixels(image, kWidth, kHeight).error(), ImageFault::encoding);
    image.format = "16UC1; compressedDepth rvl";
    EXPECT_EQ(depth_pixels(image, kWidth, kHeight).error(), ImageFault::encoding);
}

CameraIntrinsics rig_camera() {
    CameraIntrinsics camera;
    camera.width = 640;
    camera.height = 480;
    camera.fx = 600.0;
    camera.fy = 601.0;
    camera.cx = 320.0;
    camera.cy = 240.0;
    return camera;
}

CameraInfo same_camera() {
    return {.height = 480,
            .width = 640,
            .distortion_model = "plumb_bob",
            .d = {0, 0, 0, 0, 0},
            .k = {600, 0, 319.5, 0, 601, 239.5, 0, 0, 1},
            .p = {500, 0, 300, 0, 0, 501, 200, 0, 0, 0, 1, 0}};
}

constexpr const char* kRaw = "/camera/depth/image_raw";
constexpr const char* kRect = "/camera/depth/image_rect_raw";

TEST(CameraInfoOf, the_rig_is_accepted) {
    EXPECT_EQ(differs_from_rig(same_camera(), rig_camera(), kRaw), "");
    CameraInfo near = same_camera();
    near.k[0] += 2.9;
    near.k[2] -= 0.9;
    EXPECT_EQ(differs_from_rig(near, rig_camera(), kRaw), "");
    near.k[2] -= 0.2;
    EXPECT_NE(differs_from_rig(near, rig_camera(), kRaw), "");
}

TEST(CameraInfoOf, another_camera_is_named_with_its_numbers) {
    CameraInfo other = same_camera();
    other.k[0] = 610.0;
    EXPECT_NE(differs_from_rig(other, rig_camera(), kRaw).find("610.00"), std::string::npos);
    other.k[0] = std::nan("");
    EXPECT_NE(differs_from_rig(other, rig_camera(), kRaw), "");
    other = same_camera();
    other.width = 848;
    EXPECT_NE(differs_from_rig(other, rig_camera(), kRaw).find("848 x 480"), std::string::npos);
}

TEST(CameraInfoOf, distorted_images_names_the_rectified_topic) {
    CameraInfo distorted = same_camera();
    distorted.d = {0.1, 0, 0, 0, 0};
    EXPECT_NE(differs_from_rig(distorted, rig_camera(), kRaw).find("/camera/depth/image_rect"),
              std::string::npos);
    distorted.d = {};
    distorted.distortion_model = "rational_polynomial";
    EXPECT_NE(differs_from_rig(distorted, rig_camera(), kRaw).find("rational_polynomial"), std::string::npos);
}

TEST(CameraInfoOf, rectified_images_counts_by_its_projection) {
    CameraInfo info = same_camera();
    info.distortion_model = "rational_polynomial";
    info.d = {0.1, 0.2};
    EXPECT_NE(differs_from_rig(info, rig_camera(), kRect), "") << "P has other numbers than the rig";
    info.p = {600, 0, 319.5, 0, 0, 601, 239.5, 0, 0, 0, 1, 0};
    EXPECT_EQ(differs_from_rig(info, rig_camera(), kRect), "");
    EXPECT_EQ(differs_from_rig(info, rig_camera(), std::string(kRect) + "/compressedDepth"), "");
}

TEST(CameraInfoOf, images_is_beside_them) {
    EXPECT_EQ(info_topic(kRaw), "/camera/depth/camera_info");
    EXPECT_EQ(info_topic(std::string(kRaw) + "/compressedDepth"), "/camera/depth/camera_info");
}

}  // namespace
}  // namespace octoskin::bridge
