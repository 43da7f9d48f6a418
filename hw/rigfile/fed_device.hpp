// Devices of cameras whose images another program feeds: "ros:" and the topic of the images.
#pragma once

#include <string_view>

namespace octoskin::rig {

inline constexpr std::string_view kFedDevice = "ros:";

/// The daemon does not open such a device: a program feeds its images through the control socket.
[[nodiscard]] constexpr bool is_fed_device(std::string_view device) noexcept {
    return device.starts_with(kFedDevice);
}

/// "/camera/depth/image_raw": names of letters, digits and `_`, none with a digit first, each after a `/`.
[[nodiscard]] constexpr bool is_topic(std::string_view text) noexcept {
    constexpr std::string_view kFirst = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_";
    constexpr std::string_view kOthers = "0123456789";
    if (text.empty() || text.back() == '/') return false;
    char before = 0;
    for (const char letter : text) {
        const bool is_slash = letter == '/';
        if ((before == 0 || before == '/') && is_slash != (before == 0)) return false;
        const bool is_of_name =
            kFirst.find(letter) != kFirst.npos || (before != '/' && kOthers.find(letter) != kOthers.npos);
        if (!is_slash && !is_of_name) return false;
        before = letter;
    }
    return true;
}

/// True for a device of OpenNI2, too. False: "ros:" without a topic.
[[nodiscard]] constexpr bool is_good_device(std::string_view device) noexcept {
    return !is_fed_device(device) || is_topic(device.substr(kFedDevice.size()));
}

/// What `is_good_device` expects, for an error.
inline constexpr const char* kGoodDevice =
    "expected a topic after ros:, which begins with / and has names of letters, digits and _";

}  // namespace octoskin::rig
