// Restricts access to the files of a recording, independent of their names.
#pragma once

#include "host/io/folder/file_place.hpp"

namespace octoskin {

/// If the folder of `typed` is a recording (it contains can.log or meta.yaml): the place of `typed` below
/// that folder. A recording from another person can then not select a file outside of it, by a link or by a
/// name, even if its rig, robot or world is named directly. A link that leads to such a file is followed
/// first. Any other place is returned unchanged.
[[nodiscard]] FilePlace confined_to_recording(const FilePlace& typed);

}  // namespace octoskin
