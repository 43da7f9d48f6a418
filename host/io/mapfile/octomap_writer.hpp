// A map in the bytes of OctoMap's two file formats: the same bytes that OctoMap 1.9 writes for a pruned tree,
// plus a comment in the header that octoskin saved it. Written piece by piece it needs memory for each brick
// (PrunedOctree), not for each voxel.
#pragma once

#include <string>

#include "host/core/mapping/fused_map.hpp"
#include "host/io/mapfile/byte_sink.hpp"

namespace octoskin {

/// .ot: every voxel's log-odds. Equal maps give equal bytes.
void write_ot(const FusedMap& map, const ByteSink& sink);
/// The same without the comment, as written by older versions of octoskin.
void write_unmarked_ot(const FusedMap& map, const ByteSink& sink);
[[nodiscard]] std::string encode_ot(const FusedMap& map);

/// .bt: occupied, free and unknown only. Pruned on every level. OctoMap's own writer stops at the first level
/// without anything to prune, so its file of the same map can be larger.
void write_bt(const FusedMap& map, const ByteSink& sink);
[[nodiscard]] std::string encode_bt(const FusedMap& map);

}  // namespace octoskin
