// Synthetic depth images, whose first pixel counts them.
#pragma once

#include "tests/ros/saying.hpp"

namespace octoskin::ros {

/// As the options of ros_say say: --images, --topic, --encoding, --rate, --count, --depth-m.
void say_images(const Arguments& arguments, Saying& saying);

}  // namespace octoskin::ros
