// In which of its modes a camera is wanted.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace octoskin::openni2 {

struct CameraMode {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    double rate_hz = 0.0;
    friend bool operator==(const CameraMode&, const CameraMode&) = default;
};

/// "640x480@29.97", as the camera's helper takes it.
[[nodiscard]] std::string to_text(const CameraMode& mode);
/// Empty for anything else. Any bytes are safe.
[[nodiscard]] std::optional<CameraMode> parse_camera_mode(std::string_view text);

}  // namespace octoskin::openni2
