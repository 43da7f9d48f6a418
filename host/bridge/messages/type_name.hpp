// The names of a ROS 2 message type on the wire.
#pragma once

#include <string_view>

namespace octoskin::ros {

struct TypeName {
    std::string_view dds;        ///< of the DDS topic: "std_msgs::msg::dds_::String_"
    std::string_view type_hash;  ///< "RIHS01_" and 64 hexadecimal digits (REP-2011)
};

}  // namespace octoskin::ros
