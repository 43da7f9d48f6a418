// Depth images of ROS 2 as depth frames of the daemon: millimetres, 16 bits, 0 where there is none.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/core/rig/host_rig.hpp"
#include "ros_messages.hpp"

namespace octoskin::bridge {

enum class ImageFault : std::uint8_t {
    encoding,    ///< not 16UC1, mono16, 32FC1, or "16UC1; compressedDepth png"
    wrong_size,  ///< not the size of the rig's camera
    short_data,  ///< fewer bytes than its size and step say, or a damaged PNG
};
[[nodiscard]] const char* name(ImageFault fault) noexcept;

struct DepthPixels {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::vector<std::uint16_t> depth_mm;
};

/// 16UC1 and mono16 in millimetres, 32FC1 in metres; NaN, negative and beyond 65.5 m give 0. Either byte
/// order. O(pixels). Safe for any message. Throws std::bad_alloc.
[[nodiscard]] Result<DepthPixels, ImageFault> depth_pixels(const ros::sensor_msgs::Image& image,
                                                           std::uint32_t width, std::uint32_t height);
/// "16UC1; compressedDepth png" of the plugin compressed_depth_image_transport.
[[nodiscard]] Result<DepthPixels, ImageFault> depth_pixels(const ros::sensor_msgs::CompressedImage& image,
                                                           std::uint32_t width, std::uint32_t height);

/// Why the camera that this message describes is not the rig's: a sentence with both values and a remedy;
/// empty if it is. `topic`: of the images. If its last part contains "rect", the images are rectified, and P
/// counts; else K, and the distortion must be zero. The rig's principal point is half a pixel larger.
[[nodiscard]] std::string differs_from_rig(const ros::sensor_msgs::CameraInfo& info,
                                           const CameraIntrinsics& camera, const std::string& topic);

/// True for a topic of compressed images: ".../compressedDepth".
[[nodiscard]] bool is_compressed(const std::string& topic) noexcept;
/// The topic of the camera's description beside that of its images: ".../depth/camera_info".
[[nodiscard]] std::string info_topic(const std::string& image_topic);

}  // namespace octoskin::bridge
