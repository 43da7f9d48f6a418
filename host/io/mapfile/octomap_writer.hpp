// A map as the bytes of OctoMap's two file formats, the same that OctoMap 1.9 itself writes for a pruned
// tree, and a comment in the header that says that octoskin saved it. In pieces, for a file, it takes memory
// for each brick (PrunedOctree), not for each voxel.
#pragma once

#include <string>

#include "host/core/mapping/fused_map.hpp"
#include "host/io/mapfile/byte_sink.hpp"

namespace octoskin {

/// .ot: every voxel's log-odds. Equal maps give equal bytes.
void write_ot(const FusedMap& map, const ByteSink& sink);
/// The same without the comment, as octoskin wrote it before it marked its maps.
void write_unmarked_ot(const FusedMap& map, const ByteSink& sink);
[[nodiscard]] std::string encode_ot(const FusedMap& map);

/// .bt: occupied, free and unknown only. Pruned on every level; OctoMap's own writer stops pruning at the
/// first level where it finds nothing to do, so its file of the same map can be larger.
void write_bt(const FusedMap& map, const ByteSink& sink);
[[nodiscard]] std::string encode_bt(const FusedMap& map);

}  // namespace octoskin
