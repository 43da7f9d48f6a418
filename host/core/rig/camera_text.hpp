// The name of a camera in texts for the user.
#pragma once

#include <string>
#include <string_view>

namespace octoskin {

/// "camera", or "camera 'left'" of a rig with several.
[[nodiscard]] inline std::string camera_text(std::string_view name) {
    std::string text = "camera";
    if (!name.empty()) text.append(" '").append(name).append("'");
    return text;
}

}  // namespace octoskin
