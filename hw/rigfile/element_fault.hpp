// What is wrong with several elements of one file, in one error.
#pragma once

#include <string>
#include <vector>

#include "hw/rigfile/rig.hpp"

namespace octoskin::rig {

/// A link or joint that cannot be taken.
struct ElementFault {
    RigError error;
    std::string kind;  ///< in a word or two: "mesh", "planar"
};

/// The first element in the file with what is wrong and the remedy, and after it where the others are: the
/// first twenty of them, and how many more there are. Of at least one (asserted).
[[nodiscard]] RigError one_error_of(std::vector<ElementFault> faults);

}  // namespace octoskin::rig
