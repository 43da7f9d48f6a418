// The requested mode of a camera.
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

/// "640x480@29.97", the form in which the camera's helper takes it.
[[nodiscard]] std::string to_text(const CameraMode& mode);
/// Parses the text form; empty for anything else. Safe for any bytes.
[[nodiscard]] std::optional<CameraMode> parse_camera_mode(std::string_view text);

}  // namespace octoskin::openni2
