#include "host/bridge/received/depth_image.hpp"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <memory>
#include <string_view>

namespace octoskin::bridge {
namespace {

constexpr double kLargest_mm = 65'535.0;
/// ROS counts from the centre of the first pixel, a rig from its corner.
constexpr double kPixelCentre = 0.5;
constexpr std::string_view kCompressed = "/compressedDepth";

std::uint16_t millimetres(float metres) {
    const double mm = std::round(static_cast<double>(metres) * 1e3);
    return mm > 0.0 && mm <= kLargest_mm ? static_cast<std::uint16_t>(mm) : std::uint16_t{0};
}

template <class T>
T value_at(const std::uint8_t* place, bool is_swapped) {
    std::array<std::uint8_t, sizeof(T)> bytes{};
    std::memcpy(bytes.data(), place, sizeof(T));
    if (is_swapped) std::ranges::reverse(bytes);
    return std::bit_cast<T>(bytes);
}

template <class T, class Convert>
Result<DepthPixels, ImageFault> convert(const ros::sensor_msgs::Image& image, Convert to_mm) {
    const std::size_t row = std::size_t{image.width} * sizeof(T);
    if (image.step < row || image.data.size() < std::size_t{image.step} * (image.height - 1) + row)
        return unexpected(ImageFault::short_data);
    DepthPixels pixels{image.width, image.height, {}};
    pixels.depth_mm.reserve(std::size_t{image.width} * image.height);
    for (std::size_t y = 0; y < image.height; ++y)
        for (std::size_t x = 0; x < image.width; ++x)
            pixels.depth_mm.push_back(to_mm(
                value_at<T>(image.data.data() + y * image.step + x * sizeof(T), image.is_bigendian != 0)));
    return pixels;
}

std::uint32_t big_endian(std::span<const std::uint8_t> bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8U | bytes[at + i];
    return value;
}

/// True if a chunk before the pixels would make libpng's simplified interface change their values: a colour
/// space, or a gamma other than 1.
bool changes_values(std::span<const std::uint8_t> png) {
    constexpr std::size_t kSignature = 8;
    constexpr std::size_t kAroundContent = 12;  // length, type and checksum of a chunk
    constexpr std::uint32_t kLinear = 100'000;
    for (std::size_t at = kSignature; at + kAroundContent <= png.size();) {
        const std::uint32_t length = big_endian(png, at);
        const std::string_view type(reinterpret_cast<const char*>(png.data()) + at + 4, 4);
        if (type == "IDAT" || length > png.size() - at - kAroundContent) return false;
        if (type == "sRGB" || type == "iCCP") return true;
        if (type == "gAMA" && (length != 4 || big_endian(png, at + 8) != kLinear)) return true;
        at += kAroundContent + length;
    }
    return false;
}

/// Reads a PNG from memory with libpng's simplified interface, 16-bit grey only.
Result<DepthPixels, ImageFault> read_png(std::span<const std::uint8_t> bytes, std::uint32_t width,
                                         std::uint32_t height) {
    if (changes_values(bytes)) return unexpected(ImageFault::encoding);
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    const std::unique_ptr<png_image, decltype(&png_image_free)> owner(&png, &png_image_free);
    if (png_image_begin_read_from_memory(&png, bytes.data(), bytes.size()) == 0)
        return unexpected(ImageFault::short_data);
    if (png.width != width || png.height != height) return unexpected(ImageFault::wrong_size);
    if (png.format != PNG_FORMAT_LINEAR_Y) return unexpected(ImageFault::encoding);
    DepthPixels pixels{width, height, std::vector<std::uint16_t>(std::size_t{width} * height)};
    if (png_image_finish_read(&png, nullptr, pixels.depth_mm.data(), 0, nullptr) == 0)
        return unexpected(ImageFault::short_data);
    return pixels;
}

/// The topic of the images themselves: without the name that their compression adds.
std::string uncompressed(const std::string& topic) {
    return is_compressed(topic) ? topic.substr(0, topic.size() - kCompressed.size()) : topic;
}

std::string last_part(const std::string& topic) {
    return topic.substr(topic.rfind('/') + 1);
}

/// The rectified topic beside this one, for a message.
std::string rectified(const std::string& topic) {
    const std::string images = uncompressed(topic);
    return images.substr(0, images.rfind('/') + 1) + "image_rect";
}

}  // namespace

const char* name(ImageFault fault) noexcept {
    switch (fault) {
        case ImageFault::encoding:
            return "encoding";
        case ImageFault::wrong_size:
            return "wrong_size";
        case ImageFault::short_data:
            return "short_data";
    }
    return "";
}

Result<DepthPixels, ImageFault> depth_pixels(const ros::sensor_msgs::Image& image, std::uint32_t width,
                                             std::uint32_t height) {
    if (image.width != width || image.height != height || height == 0)
        return unexpected(ImageFault::wrong_size);
    if (image.encoding == "16UC1" || image.encoding == "mono16")
        return convert<std::uint16_t>(image, [](std::uint16_t mm) { return mm; });
    if (image.encoding == "32FC1") return convert<float>(image, millimetres);
    return unexpected(ImageFault::encoding);
}

Result<DepthPixels, ImageFault> depth_pixels(const ros::sensor_msgs::CompressedImage& image,
                                             std::uint32_t width, std::uint32_t height) {
    // The plugin puts its parameters before the PNG: a kind and two floats.
    constexpr std::size_t kParameters = 12;
    const bool is_depth =
        image.format.starts_with("16UC1; compressedDepth") && image.format.find("rvl") == std::string::npos;
    if (!is_depth) return unexpected(ImageFault::encoding);
    if (image.data.size() <= kParameters) return unexpected(ImageFault::short_data);
    return read_png(std::span(image.data).subspan(kParameters), width, height);
}

std::string differs_from_rig(const ros::sensor_msgs::CameraInfo& info, const CameraIntrinsics& camera,
                             const std::string& topic) {
    if (info.width != camera.width || info.height != camera.height)
        return fmt::format("its camera_info says {} x {} pixels, the rig {} x {}: correct the rig's camera",
                           info.width, info.height, camera.width, camera.height);
    const bool is_rectified = last_part(uncompressed(topic)).find("rect") != std::string::npos;
    const bool is_straight = std::ranges::all_of(info.d, [](double d) { return d == 0.0; });
    if (!is_rectified && !is_straight)
        return fmt::format(
            "its images are distorted ({}): use the rectified topic, as {}, in the rig's 'device'",
            info.distortion_model, rectified(topic));
    if (!is_rectified && info.distortion_model != "plumb_bob" && !info.distortion_model.empty())
        return fmt::format(
            "its distortion model {} is not supported: use the rectified topic, as {}, in the "
            "rig's 'device'",
            info.distortion_model, rectified(topic));
    const bool uses_p = is_rectified && info.p[0] != 0.0;
    const double fx = uses_p ? info.p[0] : info.k[0];
    const double fy = uses_p ? info.p[5] : info.k[4];
    const double cx = (uses_p ? info.p[2] : info.k[2]) + kPixelCentre;
    const double cy = (uses_p ? info.p[6] : info.k[5]) + kPixelCentre;
    const auto is_near = [](double found, double expected, double tolerance) {
        return std::abs(found - expected) <= tolerance;  // false for a NaN
    };
    constexpr double kFocalShare = 0.005;
    constexpr double kCentre_px = 1.0;
    if (is_near(fx, camera.fx, kFocalShare * camera.fx) && is_near(fy, camera.fy, kFocalShare * camera.fy) &&
        is_near(cx, camera.cx, kCentre_px) && is_near(cy, camera.cy, kCentre_px))
        return {};
    return fmt::format(
        "its camera_info gives fx_px: {:.2f}, fy_px: {:.2f}, cx_px: {:.2f}, cy_px: {:.2f}, the rig has "
        "{:.2f}, {:.2f}, "
        "{:.2f}, {:.2f}: write the former into the rig",
        fx, fy, cx, cy, camera.fx, camera.fy, camera.cx, camera.cy);
}

bool is_compressed(const std::string& topic) noexcept {
    return topic.ends_with(kCompressed);
}

std::string info_topic(const std::string& image_topic) {
    const std::string images = uncompressed(image_topic);
    return images.substr(0, images.rfind('/') + 1) + "camera_info";
}

}  // namespace octoskin::bridge
