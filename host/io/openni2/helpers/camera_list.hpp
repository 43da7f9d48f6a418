// The cameras that OpenNI2 finds, and their depth modes, as text for people.
#pragma once

#include <string>

namespace octoskin::openni2 {

/// Some lines for each camera: its URI, its name, its depth modes with the initial one marked, or why it
/// cannot be opened. Empty without a camera. OpenNI2 must be initialised. Opens each camera, which may hang.
[[nodiscard]] std::string camera_list();

}  // namespace octoskin::openni2
