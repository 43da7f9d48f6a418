// Frames of `watch`, one after the other: each is applied within its limits or refused, and what a reader has
// afterwards can be asked.
#include <cassert>
#include <string_view>

#include "host/io/watch/watched_map.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace octoskin::watch {
namespace {

constexpr std::size_t kBytesMax = std::size_t{4} << 20U;

void take(WatchedMap& map, const FrameHeader& header, std::string_view payload) {
    if (header.kind == FrameKind::range) (void)parse_range(payload);
    if (header.kind == FrameKind::joints) (void)parse_joints(payload);
    if (header.kind == FrameKind::reload) (void)parse_reload(payload);
    if (header.kind != FrameKind::map || map.take(header, payload) != WatchedMap::Taken::all) return;
    map.log_odds().for_each([&](MortonCode brick, const BrickView&) {
        const VoxelKey key = key_of_morton(brick);
        assert(map.occupancy(key) != Occupancy::unknown || !map.confirmation(key));
        (void)map.is_stale(key);
    });
    assert(map.log_odds().bricks() * BrickTree::kBrickBytes <= kBytesMax);
}

}  // namespace
}  // namespace octoskin::watch

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace octoskin::watch;
    std::string_view bytes = octoskin::fuzz::text_of({data, size});
    WatchedMap map(kBytesMax);
    while (const auto header = parse_header(bytes)) {
        bytes.remove_prefix(kHeaderBytes);
        const std::string_view payload = bytes.substr(0, header->bytes);
        take(map, *header, payload);
        bytes.remove_prefix(payload.size());
    }
    return 0;
}
