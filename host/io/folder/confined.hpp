// Files of a recording, however they are named.
#pragma once

#include "host/io/folder/file_place.hpp"

namespace octoskin {

/// The place of `typed` below its folder if that is a recording's, with a can.log or a meta.yaml in it: a
/// recording of somebody else then chooses no file outside of it, by a link or by a name, also where its rig,
/// robot or world is named by itself. A link that leads to such a file is followed first. Any other place as
/// it is.
[[nodiscard]] FilePlace confined_to_recording(const FilePlace& typed);

}  // namespace octoskin
