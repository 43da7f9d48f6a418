// The topics of a camera's depth images in a bag.
#pragma once

#include <string>

#include "host/bridge/robot/robot_facts.hpp"

namespace octoskin::bridge {

/// The topic that the rig names (`device: ros:/TOPIC`). For a camera with another device
/// "/octoskin/camera/depth/image_rect_raw", or "/octoskin/camera/NAME/depth/image_rect_raw": an export of its
/// recording is replayed with the same rig.
[[nodiscard]] inline std::string image_topic_of(const CameraFacts& camera) {
    if (auto topic = camera.topic()) return std::move(*topic);
    return "/octoskin/camera" + (camera.name.empty() ? "" : "/" + camera.name) + "/depth/image_rect_raw";
}

}  // namespace octoskin::bridge
