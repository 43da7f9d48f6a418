// Which cameras OpenNI2 sees, and in which modes they give depth, as text for a person.
#pragma once

#include <string>

namespace octoskin::openni2 {

/// One block of lines a camera: its URI, what it is, each depth mode with the one that it begins with marked,
/// or why it cannot be opened. Empty without a camera. OpenNI2 must be initialised; opens each camera, which
/// may hang.
[[nodiscard]] std::string camera_list();

}  // namespace octoskin::openni2
