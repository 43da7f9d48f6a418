// What a rig asks of its nodes about things that are too close.
#pragma once

#include <string>
#include <vector>

#include "hw/rigfile/rig.hpp"

namespace octoskin::rig {

/// Below which range each sensor of the node makes it send REFLEX, for a person: a line for each limit, in
/// the order of the first sensor that has it, and one for those that have none.
[[nodiscard]] std::vector<std::string> reflex_lines(const Node& node);

/// Limits that are hardly meant, a sentence each: farther than the distance mode measures, or closer than
/// `range_limits` lets count.
[[nodiscard]] std::vector<std::string> reflex_warnings(const Rig& rig);

}  // namespace octoskin::rig
