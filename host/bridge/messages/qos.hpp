// What a topic promises to its readers, in ROS 2's terms.
#pragma once

#include <cstdint>

namespace octoskin::ros {

enum class Reliability : std::uint8_t { best_effort, reliable };
enum class Durability : std::uint8_t { volatile_, transient_local };

struct Qos {
    Reliability reliability = Reliability::reliable;
    Durability durability = Durability::volatile_;
    std::int32_t keep_last = 1;
};

}  // namespace octoskin::ros
