// Combines the faults of several elements of one file into one error.
#pragma once

#include <string>
#include <vector>

#include "hw/rigfile/rig.hpp"

namespace octoskin::rig {

/// A link or joint that is refused.
struct ElementFault {
    Error error;
    std::string kind;  ///< in a word or two: "mesh", "planar"
};

/// The error of the first element in the file, with the remedy, then the places of the first twenty others
/// and the number of the rest. `faults` must not be empty (asserted).
[[nodiscard]] Error one_error_of(std::vector<ElementFault> faults);

}  // namespace octoskin::rig
