// A ROS 2 message type: its names on the wire and its text.
#pragma once

#include <string_view>

namespace octoskin::ros {

struct TypeName {
    std::string_view dds;        ///< of the DDS topic: "std_msgs::msg::dds_::String_"
    std::string_view type_hash;  ///< "RIHS01_" and 64 hexadecimal digits (REP-2011)
    std::string_view ros;        ///< "std_msgs/msg/String"
    /// The fields as in a .msg file, followed by those of all types in it: schema encoding "ros2msg".
    std::string_view definition;
};

}  // namespace octoskin::ros
