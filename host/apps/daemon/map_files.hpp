// The files of a map that the daemon saves.
#pragma once

#include <array>

#include "host/apps/recording/file_set.hpp"

namespace octoskin {

inline constexpr const char* kMapFile = "fused.ot";
inline constexpr const char* kSmallMapFile = "fused.bt";
inline constexpr const char* kSnapshotFile = kDaemonsSnapshot;
inline constexpr std::array kMapFiles{kMapFile, kSmallMapFile, kSnapshotFile};
/// For a person.
inline constexpr const char* kMapFilesText = "fused.ot, fused.bt and fused.snapshot";

}  // namespace octoskin
