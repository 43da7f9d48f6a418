// The REFLEX limits of a rig: its nodes send REFLEX for ranges below them.
#pragma once

#include <string>
#include <vector>

#include "hw/rigfile/rig.hpp"

namespace octoskin::rig {

/// The REFLEX limit of each sensor of the node as text: a line for each limit, in the order of the first
/// sensor that has it, and a line for the sensors without a limit.
[[nodiscard]] std::vector<std::string> reflex_lines(const Node& node);

/// Warnings about limits that are probably errors, one sentence each: beyond the range of the distance mode,
/// or below `range_limits`.
[[nodiscard]] std::vector<std::string> reflex_warnings(const Rig& rig);

}  // namespace octoskin::rig
